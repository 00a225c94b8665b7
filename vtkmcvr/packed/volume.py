"""Voxels, their majorants and their transfer functions."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Matrix, Vector64
from .geometry import Clip, Holes, Regions

# Voxels along each axis of a brick; unsigned, as indices of voxels are
BRICK = np.uintp(32)


class Bricks(NamedTuple):
    """Voxels in bricks, [k, j, i] like an array of the volume, without those that nobody reads.

    For devices without room for the volume: kernels of the CPU know arrays alone.
    """

    shape: tuple[np.int64, np.int64, np.int64]  # of the volume
    slot: NDArray[np.uint32]  # [k, j, i] of bricks: which one in `voxels`
    voxels: NDArray  # (n, BRICK, BRICK, BRICK)

    def __getitem__(self, place: Any) -> Any:
        """Voxel at (k, j, i), as kernels have it; a field by its number."""
        return voxel(self, place) if isinstance(place, tuple) else tuple.__getitem__(self, place)


def voxel(bricks: Any, place: Any) -> Any:
    """Voxel at (k, j, i); kernels compile it."""
    k, j, i = place
    slot = bricks.slot[k // BRICK, j // BRICK, i // BRICK]
    return bricks.voxels[slot, k % BRICK, j % BRICK, i % BRICK]


class Medium(NamedTuple):
    """The scalar field with its majorant grid."""

    values: NDArray  # [k, j, i], at least two points an axis; on a device perhaps Bricks
    majorant: NDArray[
        np.float32
    ]  # [k, j, i] of cells: bound of sigma_t; <= 0: empty, minus cells around
    cell_size: np.float32  # edge of a cell in index units
    cells_per_index: np.float32
    active_lo: Vector64  # index box outside of which the majorant is zero
    active_hi: Vector64
    index_from_world: Matrix  # directions: index units per world unit
    clip: Clip | None
    holes: Holes | None
    regions: Regions | None
    labels: NDArray | None  # [k, j, i] uint8 or uint16: row of the transfer tables


class GradientOpacity(NamedTuple):
    """Factor on the extinction by gradient magnitude, linear between entries."""

    factor: NDArray[np.float32]  # (n,), from gradient magnitude 0 on
    per_gradient: np.float32  # table entries per unit of the gradient magnitude
    world_from_index_gradient: Matrix


class Table2D(NamedTuple):
    """Extinction and colour by scalar and gradient magnitude, bilinear, clamped at the edges."""

    sigma_t: NDArray[np.float32]  # (gradients, scalars), 1/world unit
    colour: NDArray[np.float32]  # (gradients, scalars, 3)
    lowest: np.float32  # scalar of the first column
    per_scalar: np.float32
    lowest_gradient: np.float32
    per_gradient: np.float32
    world_from_index_gradient: Matrix


class ColourGrid(NamedTuple):
    """Colour of every point, which replaces that of the transfer function."""

    red: NDArray  # [k, j, i] like the values
    green: NDArray
    blue: NDArray
    scale: np.float32  # 1, or 1/255 for bytes


class Transfer(NamedTuple):
    """Transfer function tables over [lowest, highest scalar], linear between entries.

    The optional ones are there where their channel varies. With labels, each table holds the rows
    of all labels, one after another, and `first` is where that of a point starts.
    """

    sigma_t: NDArray[np.float32]  # (n,) extinction, 1/world unit; its maximum over all gradients
    colour: NDArray[np.float32]  # (n, 3) albedo and diffuse colour
    lowest: np.float32
    per_scalar: np.float32  # table entries per unit of the scalar
    gradient_opacity: GradientOpacity | None
    table_2d: Table2D | None
    colour_grid: ColourGrid | None
    emission: NDArray[np.float32] | None  # (n, 3) radiance of the absorbing part
    specular: NDArray[np.float32] | None  # (n, 3) instead of Gloss.specular
    exponent: NDArray[np.float32] | None  # (n,) instead of Gloss.exponent
    phase: NDArray[np.float32] | None  # (n,) instead of Phase.shape
    first: np.int32
    entries: np.int32  # of one row
