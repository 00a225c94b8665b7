"""NumPy arrays as the tuples of float32 and float64 that kernels take."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import packed

f32, f64 = np.float32, np.float64


def vector(v: NDArray) -> packed.Vector:
    """Three float32."""
    return f32(v[0]), f32(v[1]), f32(v[2])


def vector64(v: NDArray) -> packed.Vector64:
    """Three float64."""
    return f64(v[0]), f64(v[1]), f64(v[2])


def matrix(m: NDArray) -> packed.Matrix:
    """3 x 3, row by row, float32."""
    return vector(m[0]), vector(m[1]), vector(m[2])


def matrix64(m: NDArray) -> packed.Matrix64:
    """3 x 3, row by row, float64."""
    return vector64(m[0]), vector64(m[1]), vector64(m[2])


def structure(part: Any) -> Any:
    """What kernels are compiled for: which parts are there, and their types."""
    if isinstance(part, tuple):
        return type(part).__name__, tuple(map(structure, part))
    if isinstance(part, np.ndarray):
        return part.dtype.str, part.ndim
    return type(part)
