"""What layers across the view axis hold; see `vtkmcvr.occlusion`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Vector
from .volume import Medium, Transfer


class Integrals(NamedTuple):
    """Integrals of a transfer function from its first table entry on, over entries.

    With labels there are the rows of all of them, one after another, as in `Transfer`.
    """

    sigma_t: NDArray[np.float32]  # (n,) extinction as light meets it, 1/world unit: at most `most`
    depth: NDArray[np.float64]  # (n,) integral of sigma_t
    whole: NDArray[np.float32]  # (n,) extinction as it is
    whole_depth: NDArray[np.float64]
    light: NDArray[np.float64]  # (n, 3) integral of sigma_t times colour
    colour: NDArray[np.float32]  # (n, 3) albedo
    clear: np.float32  # table position up to which there is no extinction in any row
    last: np.float32  # table position of the last entry of a row
    lowest: np.float32
    per_scalar: np.float32
    most: np.float32
    limited: np.bool_  # whether `most` changes anything


class Perspective(NamedTuple):
    """Rays meet in the eye: their obliqueness varies over the film."""

    eye_column: np.float32  # of the view axis
    eye_row: np.float32
    slope: np.float32  # world units sideways per world unit of depth, per pixel
    span: np.int64  # columns over which directions go evenly


class LayerBlock(NamedTuple):
    """Layers between planes across the view axis, as rays through pixels meet them.

    Index position of pixel (column, row) at depth z below the first plane:
    first + column first_x + row first_y + z (deep + column deep_x + row deep_y).
    """

    first: Vector
    first_x: Vector
    first_y: Vector
    deep: Vector
    deep_x: Vector
    deep_y: Vector
    thickness: np.float32  # of a layer, world units along the view axis
    before: np.float32  # from the eye to the first plane, world units along the view axis


class Layers(NamedTuple):
    """What a block of layers holds, [layer, row, column]."""

    depth: NDArray[np.float32]  # optical depth along the view axis, as light meets it
    whole: NDArray[np.float32]  # the same as it is; may be the array `depth` itself
    tinted: NDArray[np.float32] | None  # [colour, layer, row, column] `depth` for coloured light
    mixed: NDArray[np.float32] | None  # [colour, ...] depth times albedo, of several volumes
    seen: NDArray[np.float32]  # transmittance from the eye to the layer's front; 0: not seen
    front: NDArray[np.float32]  # table position of the scalar at front and back, where filled
    back: NDArray[np.float32]
    relief: NDArray[np.float32] | None  # optical depth that steps of the raster add to light's


class Lanes(NamedTuple):
    """Room for the look-ups of a row of a brick at all planes of a block, plane by plane.

    Arrays of several coordinates or corners hold them one after another.
    """

    values: NDArray  # (voxels,) the volume's own, flat
    t: NDArray[np.float32]  # (n,) depth behind the block's first plane, world units
    cell: NDArray[np.int32]  # (3 n,) voxel before the index position
    part: NDArray[np.float32]  # (3 n,) from there to the position
    corner: NDArray  # (8 n,) voxels around, of their own type
    entry: NDArray[np.float32]  # (n,) table position
    sigma_t: NDArray[np.float32]  # (n,)
    integral: NDArray[np.float64] | None  # (n,) None: extinction depends on more than the scalar
    depth: NDArray[np.float32]  # (n,) optical depth to the next plane


class Runs(NamedTuple):
    """Stretches of columns [start, end) of every row of every layer that hold anything."""

    flags: NDArray[np.uint8]  # [layer, row, segment] 0: nothing; 1: faint; 2
    count: NDArray[np.int32]  # type: ignore[assignment]  # [layer, row]
    start: NDArray[np.int32]  # [layer, row, run]
    end: NDArray[np.int32]
    before: NDArray[np.int64]  # [layer, rows + 1] runs before a row, of all that are listed
    listed: NDArray[np.int32]  # (n, 3) row, start and end of all runs, layer by layer
    slot: NDArray[np.int64]  # (n,) where each of them starts in compact arrays
    first: NDArray[np.int64]  # (layers + 1,) first of each layer


class Eye(NamedTuple):
    """What is left of view rays, [row, column] of the raster."""

    light: NDArray[np.float32]  # transmittance through the medium as light meets it
    whole: NDArray[np.float32]  # and as it is
    relief: NDArray[np.float32]
    reach: NDArray[np.int32]  # [row, 2] columns between which the relief may not be zero


class FilledVolume(NamedTuple):
    """One volume that fills layers on a device."""

    medium: Medium
    transfer: Transfer
    integrals: Integrals
    places: NDArray[np.float32]  # [block, 20] fields of its `LayerBlock`, one after another
