"""The camera's part of the plan: film to rays, pixel filter, lens."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..backdrop import Backdrop
from ..camera import Camera, Lens, PixelFilter
from ..effects import Effect
from ..pack import f32, matrix64, vector, vector64
from ..scene import Scene

FILTER_ENTRIES = 257


def pack_camera(scene: Scene) -> packed.Camera:
    """Affine map from film positions in pixels to rays."""
    vectors = _panorama_map(scene) if scene.camera.panorama else _window_map(scene)
    origin, origin_x, origin_y, direction, direction_x, direction_y = map(vector64, vectors)
    return packed.Camera(
        origin, origin_x, origin_y, direction, direction_x, direction_y,
        matrix64(np.linalg.inv(scene.volume.index_to_world[:3, :3])),
        vector64((np.array(scene.volume.shape) - 1) / 2),
        _filter_table(scene.pixel_filter),
        _pack_panorama(scene.camera),
        _pack_side_by_side(scene),
    )  # fmt: skip


def _window_map(scene: Scene) -> tuple[NDArray, ...]:
    """Origin, its steps in x and y, direction, its steps; perspective or parallel."""
    camera, (width, height) = scene.camera, scene.size
    if camera.stereo is not None and camera.stereo.eyes == "both":
        width //= 2
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
    aside, inward = _eye_shift(camera, "right" if _only_right(camera) else "left")
    position = np.subtract(camera.position, scene.volume.centre) + aside
    axis = forward + inward
    still = np.zeros(3)
    if camera.parallel_scale is None:
        return position, still, still, axis + corner, *steps
    return position + corner, *steps, axis, still, still


def _panorama_map(scene: Scene) -> tuple[NDArray, ...]:
    """As `_window_map`, with (longitude, latitude, 0) as directions."""
    width, height = scene.size
    still = np.zeros(3)
    return (
        np.subtract(scene.camera.position, scene.volume.centre), still, still,
        np.array((-math.pi, math.pi / 2, 0.0)),
        np.array((2 * math.pi / width, 0.0, 0.0)),
        np.array((0.0, -math.pi / height, 0.0)),
    )  # fmt: skip


def _pack_panorama(camera: Camera) -> packed.Panorama | None:
    return packed.Panorama(*map(vector64, camera.frame)) if camera.panorama else None


def _only_right(camera: Camera) -> bool:
    return camera.stereo is not None and camera.stereo.eyes == "right"


def _eye_shift(camera: Camera, eye: str) -> tuple[NDArray, NDArray]:
    """What an eye adds to origin and direction: a shear that keeps the plane of convergence."""
    right, _, _ = camera.frame
    if camera.stereo is None:
        return np.zeros(3), np.zeros(3)
    convergence = camera.stereo.convergence or camera.distance
    slope = math.tan(math.radians(camera.stereo.angle) / 2) * (1 if eye == "right" else -1)
    return slope * convergence * right, -slope * right


def _pack_side_by_side(scene: Scene) -> packed.SideBySide | None:
    camera = scene.camera
    if camera.stereo is None or camera.stereo.eyes != "both":
        return None
    if scene.size[0] % 2:
        raise ValueError(f"two eyes side by side need an even film width, got {scene.size[0]}")
    left, right = _eye_shift(camera, "left"), _eye_shift(camera, "right")
    return packed.SideBySide(
        np.int64(scene.size[0] // 2), vector64(right[0] - left[0]), vector64(right[1] - left[1])
    )


def pack_backdrop(scene: Scene) -> tuple[packed.Backdrop | None, Effect]:
    """Where camera rays end, and why."""
    name, backdrop = "backdrop", scene.backdrop
    if backdrop is None:
        return None, Effect(name, False, "no other renderer draws anything around the volume")
    if scene.camera.panorama or scene.camera.stereo is not None:
        raise ValueError("a backdrop is of one view: neither a panorama nor stereo can have one")
    places = len(backdrop.depth)
    why = f"camera rays end at what another renderer drew, {places} places in a pixel"
    if backdrop.veils is not None:
        why += ", and are covered by translucent surfaces on their way"
    result = packed.Backdrop(
        backdrop.depth, backdrop.colour, backdrop.offsets, vector64(scene.camera.frame[2]),
        _pack_veils(backdrop),
    )  # fmt: skip
    return result, Effect(name, True, why)


def _pack_veils(backdrop: Backdrop) -> packed.Veils | None:
    veils = backdrop.veils
    return None if veils is None else packed.Veils(veils.first, veils.depth, veils.colour)


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
    if camera.panorama:
        return None, "a panorama has no lens"
    right, up, forward = camera.frame
    focus = camera.lens.focus_distance or camera.distance
    lens = packed.Lens(
        f32(camera.lens.radius), f32(focus), vector(right), vector(up), vector(forward),
        _corners(camera.lens),
    )  # fmt: skip
    shape = f", {camera.lens.blades} blades" if camera.lens.blades else ""
    return lens, f"aperture radius {camera.lens.radius:g}{shape}, sharp at distance {focus:g}"


def _corners(lens: Lens) -> NDArray[np.float32] | None:
    """Corners of a regular polygon, the first one again at the end; None: circular."""
    if lens.blades == 0:
        return None
    angles = math.radians(90 + lens.rotation) + np.linspace(0, 2 * math.pi, lens.blades + 1)
    return np.ascontiguousarray(np.stack([np.cos(angles), np.sin(angles)], axis=1), f32)
