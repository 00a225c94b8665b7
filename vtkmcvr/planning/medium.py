"""The volume's part of the plan: majorants of its transfer function over the macrocells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..kernels.gradient_range import scale_majorants, table_majorants
from ..kernels.labels import label_majorants
from ..kernels.majorant import cell_majorants, mark_empty_cubes, range_maxima
from ..pack import f32, matrix, vector64
from ..scene import Scene
from ..tables import Tables
from ..voxels import Voxels
from .cutting import PackedCuts
from .surface import world_from_index_gradient

NOWHERE = -1e9


def pack_medium(
    scene: Scene,
    voxels: Voxels,
    tables: Tables,
    transfer: packed.Transfer,
    cuts: PackedCuts,
    labels: NDArray | None,
) -> packed.Medium:
    """Voxels with the majorants of this transfer function; labels are read, no voxel is again."""
    majorant = _majorants(voxels, tables, transfer, labels)
    _bound_by_gradient(scene, voxels, transfer, majorant)
    cell = float(voxels.cell)
    last = np.array(scene.volume.shape) - 1
    cuts.empty_cells(majorant, voxels.cell, last)
    lo, hi = _active_box(majorant, voxels.cell, last)
    if scene.estimator == "woodcock":
        majorant, cell = np.full((1, 1, 1), majorant.max(), f32), float(last.max())
    mark_empty_cubes(majorant)
    index_from_world = np.linalg.inv(scene.volume.index_to_world[:3, :3])
    return packed.Medium(
        voxels.values, majorant, f32(cell), f32(1.0 / cell),
        vector64(lo), vector64(hi), matrix(index_from_world),
        cuts.clip, cuts.holes, cuts.regions, labels,
    )  # fmt: skip


def _majorants(
    voxels: Voxels, tables: Tables, transfer: packed.Transfer, labels: NDArray | None
) -> NDArray[np.float32]:
    majorant = np.empty(voxels.cell_lowest.shape, f32)
    scalars = voxels.cell_lowest, voxels.cell_highest
    maxima = range_maxima(tables.sigma_t)
    if labels is None:
        cell_majorants(*scalars, maxima, transfer.lowest, transfer.per_scalar, majorant)
    else:
        label_majorants(
            *scalars, labels, voxels.cell, maxima, tables.entries, transfer.lowest,
            transfer.per_scalar, majorant, 0, len(majorant),
        )  # fmt: skip
    return majorant


def _bound_by_gradient(
    scene: Scene, voxels: Voxels, transfer: packed.Transfer, majorant: NDArray
) -> None:
    """Lower the majorants where the transfer function depends on the gradient."""
    by_gradient, table = transfer.gradient_opacity, transfer.table_2d
    if by_gradient is None and table is None:
        return
    ranges = voxels.gradient_ranges(world_from_index_gradient(scene))
    if by_gradient is not None:
        scale_majorants(majorant, *ranges, by_gradient.factor, by_gradient.per_gradient)
    if table is not None:
        maxima = np.stack([range_maxima(row) for row in table.sigma_t])
        scalars = voxels.cell_lowest, voxels.cell_highest
        table_majorants(majorant, scalars, ranges, table, maxima)


def _active_box(majorant: NDArray, cell: int, last: NDArray) -> tuple[NDArray, NDArray]:
    """Index box around all cells with extinction; a far point where there are none."""
    occupied = majorant > 0
    planes = [np.flatnonzero(occupied.any(axis)) for axis in ((0, 1), (0, 2), (1, 2))]
    if not len(planes[0]):
        return np.full(3, NOWHERE), np.full(3, NOWHERE)
    first, final = (np.array([found[end] for found in planes]) for end in (0, -1))
    return first * cell, np.minimum((final + 1) * cell, last)
