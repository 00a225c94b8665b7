"""Voxels as kernels want them, with what is computed from them once."""

from __future__ import annotations

import functools
import math
import weakref
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .kernels.gradient_range import fill_gradient_ranges
from .kernels.majorant import fill_cell_ranges, largest_gradient
from .pack import matrix
from .scene import Volume
from .slabs import in_slabs

# Edge of a macrocell in voxels: small cells waste fewer tentative collisions at surfaces, large
# ones take less memory and fewer steps. Measured best at 2 (tests/bench/bench_looks.py); larger
# where the grid would pass MOST_CELLS.
SMALLEST_CELL, MOST_CELLS = 2, 2**21
# Types that kernels read as they are; everything else is converted once
NATIVE = ("uint8", "int16", "uint16", "float32")
EXACT_IN_FLOAT32 = 2**24
# Scalars of larger or of smaller magnitude than 2^24 and 2^-24 are kept in another unit: squares of
# gradients, and table entries per scalar, would leave the range of float32
LARGEST_MAGNITUDE = 2.0**24


@dataclass(frozen=True, eq=False)
class Voxels:
    """Values in a type that kernels read, and their ranges.

    Attributes
    ----------
    values : array (k, j, i), C order, writeable, of a type in `NATIVE`
    offset : float
        scalar = stored value x unit + offset; 0 unless float32 could not hold the scalars.
    unit : float
        A power of two; 1 unless the scalars are huge or tiny.
    lowest, highest : float
        Range of the stored finite values.
    integer : bool
        Whether stored values are whole numbers by type.
    cell : int
        Edge of a macrocell, index units.
    cell_lowest, cell_highest : arrays (k, j, i) of macrocells
    colours : three arrays (k, j, i), optional
        Red, green and blue of the points, of bytes or float32.
    not_finite : int
        Number of NaN or infinite voxels; they are NaN in `values`, that is transparent.
    """

    values: NDArray
    offset: float
    unit: float
    lowest: float
    highest: float
    integer: bool
    cell: int
    cell_lowest: NDArray[np.float32]
    cell_highest: NDArray[np.float32]
    colours: tuple[NDArray, NDArray, NDArray] | None
    not_finite: int

    @functools.cached_property
    def _gradients(self) -> dict[bytes, float]:
        return {}

    @functools.cached_property
    def _gradient_ranges(self) -> dict[bytes, tuple[NDArray, NDArray]]:
        return {}

    def largest_gradient(self, world_from_index_gradient: NDArray) -> float:
        """Largest gradient magnitude over the voxels, stored per world unit; computed once."""
        key = world_from_index_gradient.tobytes()
        if key not in self._gradients:
            rows = matrix(world_from_index_gradient)
            self._gradients[key] = float(largest_gradient(self.values, rows))
        return self._gradients[key]

    def gradient_ranges(self, world_from_index_gradient: NDArray) -> tuple[NDArray, NDArray]:
        """Lowest and highest gradient magnitude in the macrocells; computed once."""
        key = world_from_index_gradient.tobytes()
        if key not in self._gradient_ranges:
            found = np.empty_like(self.cell_lowest), np.empty_like(self.cell_lowest)
            fill_gradient_ranges(self.values, matrix(world_from_index_gradient), self.cell, *found)
            self._gradient_ranges[key] = found
        return self._gradient_ranges[key]


_cache: weakref.WeakKeyDictionary[Volume, Voxels] = weakref.WeakKeyDictionary()


def voxels_of(volume: Volume) -> Voxels:
    """Voxels of a volume; computed once for each Volume object."""
    if volume not in _cache:
        _cache[volume] = _prepare(volume.values, volume.colours)
    return _cache[volume]


def _prepare(raw: NDArray, rgb: NDArray | None) -> Voxels:
    values, offset, unit, not_finite = _kernel_values(raw)
    cell = cell_edge(values.shape)
    lowest, highest = _cell_ranges(values, cell)
    low, high = float(lowest.min()), float(highest.max())
    if not np.isfinite(low) or not np.isfinite(high):
        finite = values[np.isfinite(values)]
        low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    integer = values.dtype.kind in "iu"
    colours = None
    if rgb is not None:
        colours = (rgb[..., 0].copy(), rgb[..., 1].copy(), rgb[..., 2].copy())
    return Voxels(
        values, offset, unit, low, high, integer, cell, lowest, highest, colours, not_finite
    )


def cell_edge(shape: tuple[int, ...]) -> int:
    """Edge of the macrocells for a grid of this many points, index units."""
    return max(SMALLEST_CELL, int(np.ceil(np.cbrt(np.prod(shape, dtype=float) / MOST_CELLS))))


def _cell_ranges(values: NDArray, cell: int) -> tuple[NDArray, NDArray]:
    shape = tuple(max(1, -(-(n - 1) // cell)) for n in values.shape)
    lowest, highest = np.empty(shape, np.float32), np.empty(shape, np.float32)
    in_slabs(
        lambda first, end: fill_cell_ranges(values, cell, lowest, highest, first, end),
        shape[0], values.size,
    )  # fmt: skip
    return lowest, highest


def _kernel_values(raw: NDArray) -> tuple[NDArray, float, float, int]:
    """Values in a native type, their offset and unit, and how many were not finite."""
    if raw.dtype.kind == "b":
        raw = raw.astype(np.uint8)
    offset, unit, not_finite = 0.0, 1.0, 0
    if raw.dtype.kind == "f":
        finite = np.isfinite(raw)
        not_finite = int(raw.size - np.count_nonzero(finite))
        raw = np.where(finite, raw, raw.dtype.type(np.nan)) if not_finite else raw
        if raw.dtype != np.float32 or _unit(raw) != 1.0:
            raw, offset, unit = _as_float32(raw.astype(np.float64))
    elif raw.dtype.name not in NATIVE:
        raw, offset, unit = _narrow_integers(raw)
    values = np.ascontiguousarray(raw, raw.dtype.newbyteorder("="))
    if not values.flags.writeable:
        values = values.copy()
    return values, offset, unit, not_finite


def _narrow_integers(raw: NDArray) -> tuple[NDArray, float, float]:
    """Small integer type that holds the values, else float32."""
    low, high = int(raw.min()), int(raw.max())
    for name in ("uint8", "int16", "uint16"):
        limits = np.iinfo(name)
        if limits.min <= low and high <= limits.max:
            return raw.astype(name), 0.0, 1.0
    if max(abs(low), abs(high)) <= EXACT_IN_FLOAT32:
        return raw.astype(np.float32), 0.0, 1.0
    return _as_float32(raw.astype(np.float64))


def _unit(raw: NDArray) -> float:
    """Power of two that brings the largest magnitude to 1; 1 where that is not far off."""
    ends = np.fmin.reduce(raw, axis=None), np.fmax.reduce(raw, axis=None)
    largest = float(np.abs(ends).max())
    if not largest or np.isnan(largest) or 1 / LARGEST_MAGNITUDE <= largest <= LARGEST_MAGNITUDE:
        return 1.0
    return math.ldexp(1.0, math.frexp(largest)[1])


def _as_float32(raw: NDArray) -> tuple[NDArray, float, float]:
    """float32 values; around an offset where the range is narrow against the magnitude."""
    if np.isnan(raw).all():
        return np.full(raw.shape, np.nan, np.float32), 0.0, 1.0
    low, high = float(np.nanmin(raw)), float(np.nanmax(raw))
    largest = max(abs(low), abs(high))
    if largest > float(np.finfo(np.float32).max) / 4:
        raise ValueError(
            f"the volume's values reach {largest:g}; rescale them to below 8e37, the range of "
            "float32"
        )
    offset = low if 0 < high - low < 1e-3 * largest else 0.0
    raw = raw - offset
    unit = _unit(raw)
    return (raw / unit).astype(np.float32), offset, unit
