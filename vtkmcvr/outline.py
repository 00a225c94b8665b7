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

    None in scenes with something around the volume, and where rays are not straight from the film.
    """
    if scene.more is not None or not dark_around(scene) or not pinhole(scene):
        return np.zeros(shape, np.bool_)
    camera, medium = scene.camera, scene.medium
    size, known = occupied(medium.majorant)
    box = medium.active_lo, medium.active_hi
    view = *camera[:8], reach(camera), box, float(medium.cell_size), shape
    last = known.last
    if last is None or last[0] != view:
        x, y = film_positions(camera, corners(medium, size, known.blocks.shape))
        last = known.last = view, ~covered(known.blocks, x, y, reach(camera), shape)
    return last[1]


def pinhole(scene: packed.Scene) -> bool:
    """Whether the camera is a pinhole or parallel, with one eye."""
    camera = scene.camera
    both = (np.any(camera.origin_x) or np.any(camera.origin_y)) and (
        np.any(camera.direction_x) or np.any(camera.direction_y)
    )
    bent = (camera.panorama, camera.side_by_side, scene.lens)
    return not both and all(part is None for part in bent)


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


def film_positions(camera: packed.Camera, points: NDArray) -> tuple[NDArray, NDArray]:
    """Where index positions (3, ...) are on the film, x and y; NaN where no ray leads there."""
    turn = np.array(camera.index_from_world)
    origin, origin_x, origin_y, heading, heading_x, heading_y = (
        turn @ np.array(v) for v in camera[:6]
    )
    apart = points - (np.array(camera.index_of_centre) + origin).reshape(3, 1, 1, 1)
    parallel = not (heading_x.any() or heading_y.any())
    along_film = (origin_x, origin_y) if parallel else (heading_x, heading_y)
    inverse = np.linalg.inv(np.stack((*along_film, heading), axis=1))
    x, y, along = np.tensordot(inverse, apart, axes=1)
    if parallel:
        return x, y
    with np.errstate(divide="ignore", invalid="ignore"):
        # Not behind the eye, nor so far aside that it says nothing
        ahead = along > np.maximum(abs(x), abs(y)) / FAR
        return np.where(ahead, x / along, np.nan), np.where(ahead, y / along, np.nan)


def reach(camera: packed.Camera) -> float:
    """Pixels from its middle within which a pixel's rays are."""
    step = min(np.linalg.norm(camera.direction_x), np.linalg.norm(camera.direction_y))
    focal = np.linalg.norm(camera.direction) / step if step > 0 else 0.0
    return float(abs(camera.filter).max() + MARGIN + ROUNDING * focal)


def covered(
    blocks: Blocks, x: NDArray, y: NDArray, reach: float, shape: tuple[int, int]
) -> NDArray[np.bool_]:
    """Pixels (H, W) within reach of the film positions of blocks that are occupied."""
    places = (bounds(at, reach, n)[:, blocks] for at, n in ((y, shape[0]), (x, shape[1])))
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


def bounds(at: NDArray, reach: float, n: int) -> NDArray[np.int64]:
    """First pixel of n that each block, (k, j, i), may cover, and the one after the last: (2, ...).

    `at` is where corners are along an axis of the film; all pixels where that is not known.
    """
    low, high = at, at
    for axis in range(3):
        before, after = (
            tuple(part if axis == a else slice(None) for a in range(3))
            for part in (slice(None, -1), slice(1, None))
        )
        # NaN wins
        low = np.minimum(low[before], low[after])
        high = np.maximum(high[before], high[after])
    first = np.where(np.isnan(low), 0, np.ceil(low - reach - 0.5))
    last = np.where(np.isnan(high), n, np.floor(high + reach - 0.5) + 1)
    first = np.clip(first, 0, n)
    return np.stack((first, np.clip(last, first, n))).astype(np.int64)
