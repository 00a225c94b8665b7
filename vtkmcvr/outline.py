"""Which pixels of a picture can see the volume: the others are black without a path.

The macrocells that are not empty, in blocks, cover a rectangle of the film each; what none of them
covers is dark. That is a bound: a pixel that is taken to see something may see nothing.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import packed
from .sight import dark_around

# Blocks along an axis at most
BLOCKS = 32
# What may be missed by rounding: pixels, and of the focal length, which float32 directions have
MARGIN, ROUNDING = 0.05, 1e-6
# Film positions beyond are all outside of any picture
FAR = 1e9

Blocks = NDArray[np.bool_]
# Blocks of majorants that are there, and the last picture's pixels: it is refined many times
_known: dict[int, _Known] = {}


@dataclass
class _Known:
    majorant: weakref.ref
    blocks: Blocks
    last: tuple[tuple, NDArray[np.bool_]] | None = None


def dark_pixels(scene: packed.Scene, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Pixels of a film, (H, W), whose paths are all black; it belongs to all who ask.

    No pixel is where something can be seen around the volume, in a panorama, or with two eyes.
    """
    if scene.more is not None or not dark_around(scene) or not one_eye(scene.camera):
        return np.zeros(shape, np.bool_)
    camera, medium = scene.camera, scene.medium
    size, known = occupied(medium.majorant)
    box = medium.active_lo, medium.active_hi
    lens = scene.lens and scene.lens[:2]
    view = *camera[:8], reach(camera), lens, box, float(medium.cell_size), shape
    last = known.last
    if last is None or last[0] != view:
        x, y, along = film_positions(camera, corners(medium, size, known.blocks.shape))
        around = reach(camera) + blur(camera, scene.lens, along)
        last = known.last = view, ~covered(known.blocks, x, y, around, shape)
    return last[1]


def one_eye(camera: packed.Camera) -> bool:
    """Whether all rays come from one place, or all in one direction."""
    other = (camera.panorama, camera.side_by_side)
    return all(part is None for part in other) and (is_parallel(camera) or is_central(camera))


def is_parallel(camera: packed.Camera) -> bool:
    """Whether all rays have one direction."""
    return not np.any((camera.direction_x, camera.direction_y))


def is_central(camera: packed.Camera) -> bool:
    """Whether all rays come from one place."""
    return not np.any((camera.origin_x, camera.origin_y))


def occupied(majorant: NDArray[np.float32]) -> tuple[int, _Known]:
    """Cells of a block's edge; and which blocks, [k, j, i], have a cell that is not empty."""
    size = -(-max(majorant.shape) // BLOCKS)
    key = id(majorant)
    if key not in _known:
        blocks = ~(majorant <= 0)
        for axis, n in enumerate(majorant.shape):
            blocks = np.logical_or.reduceat(blocks, np.arange(0, n, size), axis)
        _known[key] = _Known(weakref.ref(majorant, lambda _: _known.pop(key, None)), blocks)
    return size, _known[key]


def corners(medium: packed.Medium, size: int, blocks: tuple[int, ...]) -> NDArray[np.float64]:
    """Index positions (3, k + 1, j + 1, i + 1) of the corners of all blocks, in the active box."""
    edge = size * float(medium.cell_size)
    x, y, z = (
        np.clip(edge * np.arange(n + 1), low, high)
        for n, low, high in zip(blocks[::-1], medium.active_lo, medium.active_hi, strict=True)
    )
    z, y, x = np.meshgrid(z, y, x, indexing="ij")
    return np.stack((x, y, z))


def film_positions(camera: packed.Camera, points: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Where index positions (3, ...) are on the film, x and y, and how many headings away.

    NaN where no ray leads there.
    """
    turn = np.array(camera.index_from_world)
    origin, origin_x, origin_y, heading, heading_x, heading_y = (
        turn @ np.array(v) for v in camera[:6]
    )
    apart = points - (np.array(camera.index_of_centre) + origin).reshape(3, 1, 1, 1)
    parallel = is_parallel(camera)
    along_film = (origin_x, origin_y) if parallel else (heading_x, heading_y)
    inverse = np.linalg.inv(np.stack((*along_film, heading), axis=1))
    x, y, along = np.tensordot(inverse, apart, axes=1)
    if not parallel:
        # Not behind the eye, nor so far aside that it says nothing
        ahead = along > np.maximum(abs(x), abs(y)) / FAR
        along = np.where(ahead, along, np.nan)
        x, y = x / along, y / along
    return x, y, along


def blur(camera: packed.Camera, lens: packed.Lens | None, along: NDArray) -> NDArray | float:
    """Pixels by which rays through the edge of the lens miss where that through its middle leads.

    They all meet at one distance; `along` is how many headings away they are to lead.
    """
    if lens is None:
        return 0.0
    depth = np.dot(camera.direction, lens.axis)
    away, focus = along * depth, float(lens.focus_distance)
    if is_parallel(camera):
        step = min(np.linalg.norm(camera.origin_x), np.linalg.norm(camera.origin_y))
        return lens.radius / step * abs(1 - away / focus)
    step = min(np.linalg.norm(camera.direction_x), np.linalg.norm(camera.direction_y))
    return lens.radius * depth / step * abs(1 / away - 1 / focus)


def reach(camera: packed.Camera) -> float:
    """Pixels from its middle within which a pixel's rays are."""
    step = min(np.linalg.norm(camera.direction_x), np.linalg.norm(camera.direction_y))
    focal = np.linalg.norm(camera.direction) / step if step > 0 else 0.0
    return float(abs(camera.filter).max() + MARGIN + ROUNDING * focal)


def covered(
    blocks: Blocks, x: NDArray, y: NDArray, around: NDArray | float, shape: tuple[int, int]
) -> NDArray[np.bool_]:
    """Pixels (H, W) that rays may lead from to blocks that are occupied, whose corners are at x, y.

    `around` is how many pixels around a corner.
    """
    places = (
        bounds(at - around, at + around, n)[:, blocks] for at, n in ((y, shape[0]), (x, shape[1]))
    )
    (top, bottom), (left, right) = places
    # A rectangle is four steps of a sum over rows and columns
    steps = np.zeros((shape[0] + 1, shape[1] + 1), np.int32)
    for rows, columns, step in (
        (top, left, 1),
        (bottom, right, 1),
        (top, right, -1),
        (bottom, left, -1),
    ):
        np.add.at(steps, (rows, columns), step)
    return steps.cumsum(0, np.int32).cumsum(1, np.int32)[:-1, :-1] > 0


def bounds(low: NDArray, high: NDArray, n: int) -> NDArray[np.int64]:
    """First pixel of n that each block, (k, j, i), may cover, and the one after the last: (2, ...).

    From the lowest and highest film positions of its corners; all pixels where one is not known.
    """
    for axis in range(3):
        before, after = (
            tuple(part if axis == a else slice(None) for a in range(3))
            for part in (slice(None, -1), slice(1, None))
        )
        # NaN wins
        low = np.minimum(low[before], low[after])
        high = np.maximum(high[before], high[after])
    first = np.clip(np.where(np.isnan(low), 0, np.ceil(low - 0.5)), 0, n)
    last = np.where(np.isnan(high), n, np.floor(high - 0.5) + 1)
    return np.stack((first, np.clip(last, first, n))).astype(np.int64)
