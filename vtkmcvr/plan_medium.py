"""The volume's part of the plan: majorants of its transfer function over the macrocells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import packed
from .kernels.majorant import cell_majorants, mark_empty_cubes, range_maxima
from .pack import f32, matrix, vector64
from .scene import Scene
from .tables import Tables
from .voxels import Voxels

NOWHERE = -1e9


def pack_medium(scene: Scene, voxels: Voxels, tables: Tables) -> packed.Medium:
    """Voxels with the majorants of this transfer function; no voxel is read."""
    majorant = np.empty(voxels.cell_lowest.shape, f32)
    cell_majorants(
        voxels.cell_lowest, voxels.cell_highest, range_maxima(tables.sigma_t),
        f32(voxels.lowest), f32(tables.per_scalar), majorant,
    )  # fmt: skip
    mark_empty_cubes(majorant)
    lo, hi = _active_box(majorant, voxels.cell, np.array(scene.volume.shape) - 1)
    index_from_world = np.linalg.inv(scene.volume.index_to_world[:3, :3])
    return packed.Medium(
        voxels.values, majorant, f32(voxels.cell), f32(1.0 / voxels.cell),
        vector64(lo), vector64(hi), matrix(index_from_world),
    )  # fmt: skip


def _active_box(majorant: NDArray, cell: int, last: NDArray) -> tuple[NDArray, NDArray]:
    """Index box around all cells with extinction; a far point where there are none."""
    occupied = np.argwhere(majorant > 0)[:, ::-1]
    if not len(occupied):
        return np.full(3, NOWHERE), np.full(3, NOWHERE)
    return occupied.min(0) * cell, np.minimum((occupied.max(0) + 1) * cell, last)
