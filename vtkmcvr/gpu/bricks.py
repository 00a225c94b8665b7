"""Volumes without the voxels that no path reads, for devices that have no room for all."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed

EDGE = int(packed.BRICK)
# Voxels around a cell with extinction that are read: by interpolation in it, and by gradients there
# one voxel farther on
APRON = 2


def bricked(part: Any) -> Any:
    """Packed scene whose volumes are bricks, where that is less; anything else as it is.

    Walks through the medium look up its scalar in cells with extinction alone, and gradients where
    they collided. Marching and the layers of directional occlusion look up what is around too:
    their volumes stay whole.
    """
    if not isinstance(part, packed.Scene) or part.marching is not None:
        return part
    media = [part.medium, *(layer.medium for layer in part.more or ())]
    less = list(map(in_bricks, media))
    if all(a is b for a, b in zip(less, media, strict=True)):
        return part
    more = part.more
    if more is not None:
        more = tuple(a._replace(medium=b) for a, b in zip(more, less[1:], strict=True))
    return part._replace(medium=less[0], more=more)


def in_bricks(medium: packed.Medium) -> packed.Medium:
    """Medium with those bricks that are read; itself where they are no less."""
    needed = needed_bricks(medium)
    count = int(np.count_nonzero(needed))
    if count * EDGE**3 + needed.size >= medium.values.size:
        return medium
    slot = np.zeros(needed.shape, np.uint32)
    slot[needed] = np.arange(count)
    voxels = np.zeros((max(count, 1), EDGE, EDGE, EDGE), medium.values.dtype)
    for number, place in enumerate(np.argwhere(needed)):
        part = medium.values[tuple(slice(n * EDGE, (n + 1) * EDGE) for n in place)]
        depth, rows, columns = part.shape
        voxels[number, :depth, :rows, :columns] = part
    nz, ny, nx = map(np.int64, medium.values.shape)
    bricks: Any = packed.Bricks((nz, ny, nx), slot, voxels)
    return medium._replace(values=bricks)


def needed_bricks(medium: packed.Medium) -> NDArray[np.bool_]:
    """Which bricks hold voxels that are read, [k, j, i]."""
    needed = medium.majorant > 0
    for axis, points in enumerate(medium.values.shape):
        needed = _along(needed, axis, points, float(medium.cell_size))
    return needed


def _along(cells: NDArray[np.bool_], axis: int, points: int, size: float) -> NDArray[np.bool_]:
    """Cells that are read -> bricks that are read, along an axis of so many points."""
    lines = np.moveaxis(cells, axis, 0)
    found = []
    for start in range(0, points, EDGE):
        first = max(math.ceil((start - APRON) / size) - 1, 0)
        last = math.floor((start + EDGE - 1 + APRON) / size)
        found.append(lines[first : last + 1].any(axis=0))
    return np.moveaxis(np.array(found), 0, axis)
