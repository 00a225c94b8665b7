"""The camera's part of the plan: film to rays, pixel filter, lens."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from . import packed
from .camera import Camera, PixelFilter
from .pack import f32, matrix64, vector, vector64
from .scene import Scene

FILTER_ENTRIES = 257


def pack_camera(scene: Scene) -> packed.Camera:
    """Affine map from film positions in pixels to rays."""
    camera, (width, height) = scene.camera, scene.size
    right, up, forward = camera.frame
    x_shift, y_shift = camera.window_centre
    # Film (x, y) in pixels -> view coordinates a = -1 + x_shift + 2 x / width, b = 1 + y_shift - 2
    # y / height
    if camera.parallel_scale is None:
        extent = math.tan(math.radians(camera.view_angle) / 2)
    else:
        extent = camera.parallel_scale
    across, along = right * extent * width / height, up * extent
    corner = (x_shift - 1) * across + (y_shift + 1) * along
    steps = (2 / width * across, -2 / height * along)
    position = np.subtract(camera.position, scene.volume.centre)
    still = np.zeros(3)
    if camera.parallel_scale is None:
        vectors = (position, still, still, forward + corner, *steps)
    else:
        vectors = (position + corner, *steps, forward, still, still)
    origin, origin_x, origin_y, direction, direction_x, direction_y = map(vector64, vectors)
    return packed.Camera(
        origin, origin_x, origin_y, direction, direction_x, direction_y,
        matrix64(np.linalg.inv(scene.volume.index_to_world[:3, :3])),
        vector64((np.array(scene.volume.shape) - 1) / 2),
        _filter_table(scene.pixel_filter),
    )  # fmt: skip


def _filter_table(pixel_filter: PixelFilter) -> NDArray[np.float32]:
    """Inverse distribution of the filter at evenly spaced probabilities, in pixels."""
    reach = 3.0 if pixel_filter.kind == "gaussian" else 1.0
    x = np.linspace(-reach, reach, 4097)
    density = {
        "gaussian": np.exp(-x * x / 2),
        "box": np.ones_like(x),
        "tent": 1 - np.abs(x),
    }[pixel_filter.kind]
    cdf = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2)])
    quantiles = np.interp(np.linspace(0, 1, FILTER_ENTRIES), cdf / cdf[-1], x)
    return np.ascontiguousarray(quantiles * pixel_filter.width, f32)


def pack_lens(camera: Camera) -> tuple[packed.Lens | None, str]:
    """Thin lens, or None for a pinhole; and why."""
    if camera.lens is None:
        return None, "the camera has no lens: a pinhole"
    if camera.lens.radius == 0:
        return None, "aperture radius is 0: a pinhole"
    if camera.parallel_scale is not None:
        return None, "a parallel projection has no lens"
    right, up, forward = camera.frame
    focus = camera.lens.focus_distance or camera.distance
    lens = packed.Lens(
        f32(camera.lens.radius), f32(focus), vector(right), vector(up), vector(forward)
    )
    return lens, f"aperture radius {camera.lens.radius:g}, sharp at distance {focus:g}"
