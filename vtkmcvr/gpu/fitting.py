"""Scenes that do not fit into a device's memory: voxels in a smaller type of the same values."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from .errors import OutOfDeviceMemory

logger = logging.getLogger("vtkmcvr")

SMALLER_TYPES = (np.uint8, np.int16, np.uint16)


def uploaded(device: Any, *parts: Any) -> tuple[Any, ...]:
    """Copy packed tuples to a device; where they do not fit, with voxels in a smaller type.

    Raises
    ------
    OutOfDeviceMemory
        Where they do not fit then either, or no smaller type holds the voxels' values.
    """
    try:
        return _copied(device, parts)
    except OutOfDeviceMemory:
        smaller = tuple(map(shrunk, parts))
        if all(a is b for a, b in zip(smaller, parts, strict=True)):
            raise
    # No longer inside the handler, whose traceback keeps what was copied so far
    logger.info("voxels go to the device in a smaller type, which holds the same values")
    return _copied(device, smaller)


def _copied(device: Any, parts: tuple[Any, ...]) -> tuple[Any, ...]:
    device.room_for(*parts)
    return tuple(map(device.upload, parts))


def shrunk(part: Any) -> Any:
    """The same packed tuple with all voxels in the smallest type of the same values, or itself."""
    if isinstance(part, packed.Medium):
        values = smaller_type(part.values)
        return part if values is part.values else part._replace(values=values)
    if not isinstance(part, tuple):
        return part
    inner = [shrunk(field) for field in part]
    if all(a is b for a, b in zip(inner, part, strict=True)):
        return part
    return type(part)(*inner) if hasattr(part, "_fields") else tuple(inner)


def smaller_type(values: NDArray[Any]) -> NDArray[Any]:
    """The same values in the smallest type that holds them all; itself where there is none."""
    low, high = values.min(), values.max()
    # NaN and infinity have no integer
    if not (np.isfinite(low) and np.isfinite(high)):
        return values
    for kind in SMALLER_TYPES:
        limits = np.iinfo(kind)
        if np.dtype(kind).itemsize >= values.itemsize or low < limits.min or high > limits.max:
            continue
        as_whole = values.astype(kind)
        if np.array_equal(as_whole, values):
            return as_whole
    return values
