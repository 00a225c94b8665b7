"""Autofocus: where the camera has to be sharp for a picked pixel to be sharp."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import checks
from .film.moments import new_film
from .plan import plan
from .scene import Isotropic, PixelFilter, Scene
from .tiles import render_tile

SAMPLES = 256


def autofocus(scene: Scene, pixel: tuple[int, int], *, radius: float = 1.0, seed: int = 0) -> float:
    """Focus distance at which a picked pixel is sharp.

    The mean depth, along the view axis, of the points around the pixel at which camera rays are
    scattered: what is half transparent counts as much as it is seen.

    Parameters
    ----------
    scene : Scene
        Its lens, lights and surfaces do not matter.
    pixel : (column, row)
        From (0, 0), top left.
    radius : float
        Half the edge, in pixels, of the square around the pixel's centre that is looked at, > 0.
    seed : int
        >= 0.

    Returns
    -------
    float
        Distance for `Lens.focus_distance`, world units; of 256 rays, so that a cloud of depth
        spread s is met to within s / 16.

    Raises
    ------
    ValueError
        Where nothing is seen, or the camera is a panorama.
    """
    column, row = _checked(scene, pixel)
    checks.number("radius", radius, above=0.0, most=64.0)
    checks.whole("seed", seed, least=0)
    # The fewest effects, so that the least is compiled; a pinhole, or focus would depend on itself
    bare = replace(
        scene, camera=replace(scene.camera, lens=None), lights=(), surface=None,
        phase=Isotropic(), scattering="single", max_scatterings=None, environment_visible=False,
        pixel_filter=PixelFilter("box", radius), aovs=(),
    )  # fmt: skip
    packed = plan(bare).packed
    film = new_film(*scene.size, packed.sobol)
    goal = np.full(film.count.shape, SAMPLES, np.int64)
    render_tile(film, packed, row, row + 1, column, column + 1, goal, np.int64(seed))
    if not film.hits[row, column]:
        raise ValueError(f"nothing to focus on: pixel ({column}, {row}) shows no volume")
    return float(film.depth[row, column]) * _cosine(bare, column, row)


def _checked(scene: Scene, pixel: tuple[int, int]) -> tuple[int, int]:
    if scene.camera.panorama:
        raise ValueError("a panorama has no lens to focus")
    column, row = (checks.whole("pixel", x, least=0) for x in pixel)
    width, height = scene.size
    if column >= width or row >= height:
        raise ValueError(f"pixel ({column}, {row}) is not on the film of {width} x {height}")
    return column, row


def _cosine(scene: Scene, column: int, row: int) -> float:
    """Cosine between the view axis and the ray of a pixel's centre."""
    camera = plan(scene).packed.camera
    corner = np.array(camera.direction)
    other = camera.side_by_side
    if other is not None and column >= other.columns:
        column, corner = column - int(other.columns), corner + np.array(other.direction)
    heading = (
        corner
        + (column + 0.5) * np.array(camera.direction_x)
        + (row + 0.5) * np.array(camera.direction_y)
    )
    return float(heading @ scene.camera.frame[2] / np.linalg.norm(heading))
