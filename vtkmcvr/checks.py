"""Validation with one voice: what was given, what is allowed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


def number(
    name: str,
    value: Any,
    *,
    above: float = -np.inf,
    least: float = -np.inf,
    most: float = np.inf,
    finite: bool = True,
) -> float:
    """Return `value` as a float, or say what is wrong with it."""
    try:
        x = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a number, got {value!r}") from None
    if np.isnan(x) or (finite and np.isinf(x)):
        raise ValueError(f"{name} must be finite, got {value!r}")
    if x <= above:
        raise ValueError(f"{name} must be above {above:g}, got {x:g}")
    if x < least or x > most:
        limits = f"at least {least:g}" if np.isinf(most) else f"from {least:g} to {most:g}"
        raise ValueError(f"{name} must be {limits}, got {x:g}")
    return x


def whole(name: str, value: Any, *, least: int) -> int:
    """Return `value` as an int of at least `least`, or say what is wrong with it."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)):
        raise ValueError(f"{name} must be a whole number of at least {least}, got {value!r}")
    if value < least:
        raise ValueError(f"{name} must be at least {least}, got {value}")
    return int(value)


def choice(name: str, value: Any, allowed: Sequence[str]) -> str:
    """Return `value` where it is one of the words allowed, or say which there are."""
    if value not in allowed:
        raise ValueError(f"{name} is one of {', '.join(allowed)}; got {value!r}")
    return value


def vector(name: str, value: Any, *, nonzero: bool = False) -> tuple[float, float, float]:
    """Return three finite floats, or say what is wrong with them."""
    try:
        v = tuple(float(x) for x in value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be three numbers, got {value!r}") from None
    if len(v) != 3 or not np.isfinite(v).all():
        raise ValueError(f"{name} must be three finite numbers, got {value!r}")
    if nonzero and not any(v):
        raise ValueError(f"{name} must not be (0, 0, 0)")
    return v  # type: ignore[return-value]


def colour(name: str, value: Any) -> tuple[float, float, float]:
    """Return linear RGB >= 0; one number means grey."""
    if np.ndim(value) == 0:
        value = (value, value, value)
    v = vector(name, value)
    if min(v) < 0:
        raise ValueError(f"{name} must not be negative, got {v}")
    return v


def direction(name: str, value: Any) -> tuple[float, float, float]:
    """Return a unit vector."""
    v = np.array(vector(name, value, nonzero=True))
    # Scaled first: the square of a tiny or huge component must not leave the range of floats
    v /= np.abs(v).max()
    return tuple((v / np.linalg.norm(v)).tolist())


def affine(name: str, value: Any) -> np.ndarray:
    """Return a finite, invertible 4x4 matrix with last row (0, 0, 0, 1)."""
    m = np.asarray(value, np.float64)
    if m.shape != (4, 4) or not np.isfinite(m).all():
        raise ValueError(f"{name} must be a finite 4x4 matrix, got {value!r}")
    columns = np.linalg.norm(m[:3, :3], axis=0)
    if not (columns > 0).all() or abs(np.linalg.det(m[:3, :3] / columns)) < 1e-9:
        raise ValueError(f"{name} must be invertible: its axes are {m[:3, :3].T.tolist()}")
    if not np.array_equal(m[3], (0.0, 0.0, 0.0, 1.0)):
        raise ValueError(f"{name} must be affine, its last row is {m[3].tolist()}")
    return m
