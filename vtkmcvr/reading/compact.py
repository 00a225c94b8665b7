"""Keep voxels in the smallest type that holds them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def compact_values(values: NDArray[Any], noted: list[str]) -> NDArray[Any]:
    """Return `values` in the smallest type that holds them, noting a change of type.

    Wide integers become int16, uint16 or int32; float64 becomes int16 if all values are whole
    and fit, else float32 if none overflows. Truth values become uint8, half floats float32. The
    result is contiguous and in this machine's byte order; it may be `values` itself.
    """
    compact = _narrow_values(values)
    if compact.dtype != values.dtype.newbyteorder("="):
        noted.append(f"stored as {values.dtype.newbyteorder('=')}, kept as {compact.dtype}")
    return compact


def _narrow_values(values: NDArray[Any]) -> NDArray[Any]:
    native = values.dtype.newbyteorder("=")
    if native == np.bool_ or native == np.float16:
        return np.ascontiguousarray(values, np.uint8 if native == np.bool_ else np.float32)
    wide_integer = native.kind in "iu" and native.itemsize > 2
    if not wide_integer and native != np.float64:
        return np.ascontiguousarray(values, native)
    low, high = values.min(), values.max()
    for target in (np.int16, np.uint16, np.int32) if wide_integer else (np.int16,):
        if np.iinfo(target).min <= low and high <= np.iinfo(target).max:
            narrow = values.astype(target, order="C")
            if wide_integer or np.array_equal(narrow, values):
                return narrow
    return _narrow_integer(values) if wide_integer else _narrow_float(values)


def _narrow_integer(values: NDArray[Any]) -> NDArray[Any]:
    # VTK has no use for 64-bit integers in pictures; float64 holds them to 2^53.
    if values.dtype.itemsize == 8:
        return values.astype(np.float64, order="C")
    return np.ascontiguousarray(values, values.dtype.newbyteorder("="))


def _narrow_float(values: NDArray[Any]) -> NDArray[Any]:
    with np.errstate(over="ignore"):
        narrow = values.astype(np.float32, order="C")
    overflows = np.isinf(narrow).sum() != np.isinf(values).sum()
    if overflows:
        return np.ascontiguousarray(values, values.dtype.newbyteorder("="))
    return narrow
