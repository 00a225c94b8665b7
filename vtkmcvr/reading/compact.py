"""Keep voxels in the smallest type that holds them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def compact_values(values: NDArray[Any], noted: list[str]) -> NDArray[Any]:
    """Copy `values` to the smallest type that holds them, noting a change of type.

    Wide integers become int16, uint16 or int32; float64 becomes int16 if all values are whole
    and fit, else float32 if none overflows.
    """
    compact = _narrow_values(values)
    if compact.dtype != values.dtype:
        noted.append(f"stored as {values.dtype}, kept as {compact.dtype}")
    return compact


def _narrow_values(values: NDArray[Any]) -> NDArray[Any]:
    wide_integer = values.dtype.kind in "iu" and values.dtype.itemsize > 2
    if not wide_integer and values.dtype != np.float64:
        return np.array(values, order="C")
    low, high = values.min(), values.max()
    for target in (np.int16, np.uint16, np.int32) if wide_integer else (np.int16,):
        if np.iinfo(target).min <= low and high <= np.iinfo(target).max:
            narrow = values.astype(target, order="C")
            if wide_integer or np.array_equal(narrow, values):
                return narrow
    return np.array(values, order="C") if wide_integer else _narrow_float(values)


def _narrow_float(values: NDArray[Any]) -> NDArray[Any]:
    with np.errstate(over="ignore"):
        narrow = values.astype(np.float32, order="C")
    overflows = np.isinf(narrow).sum() != np.isinf(values).sum()
    return np.array(values, order="C") if overflows else narrow
