"""Scenes that do not fit into a device's memory: voxels in a smaller type, or fewer of them."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from .bricks import bricked
from .errors import OutOfDeviceMemory

logger = logging.getLogger("vtkmcvr")

SMALLER_TYPES = (np.uint8, np.int16, np.uint16)


def uploaded(device: Any, *parts: Any) -> tuple[Any, ...]:
    """Copy packed tuples to a device; where they do not fit, with less of the voxels.

    First in a smaller type of the same values; then without those that no path reads.

    Raises
    ------
    OutOfDeviceMemory
        Where they do not fit then either.
    """
    failure = None
    for words, version in _versions(parts):
        if words:
            logger.info(words)
        try:
            return _copied(device, version)
        except OutOfDeviceMemory as error:
            # Its traceback would keep what was copied so far
            failure = error.with_traceback(None)
    assert failure is not None
    raise failure


def _versions(parts: tuple[Any, ...]) -> Iterator[tuple[str, tuple[Any, ...]]]:
    """What may be copied, and what to say of it: each smaller than the one before."""
    yield "", parts
    for words, smaller in STEPS:
        less = tuple(map(smaller, parts))
        if any(a is not b for a, b in zip(less, parts, strict=True)):
            yield words, less
            parts = less


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


STEPS = (
    ("voxels go to the device in a smaller type, which holds the same values", shrunk),
    ("voxels go to the device in bricks, without those that no path reads", bricked),
)
