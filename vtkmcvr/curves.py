"""Functions of a scalar by nodes, as vtkPiecewiseFunction and vtkColorTransferFunction have them.

Pure NumPy, so that scenes need no VTK; the tests compare every branch with VTK itself.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# Limits that VTK itself sets on a node's midpoint
MIDPOINT_MIN, MIDPOINT_MAX = 0.00001, 0.99999
STEP_ABOVE, LINEAR_BELOW = 0.99, 0.01


def _nodes(nodes: Iterable, width: int, name: str) -> Array:
    rows = [tuple(float(v) for v in node) for node in nodes]
    if not rows:
        raise ValueError(f"{name} needs at least one node, got none")
    full = []
    for row in rows:
        if len(row) not in (width, width + 2):
            raise ValueError(
                f"a node of {name} has {width} numbers (or {width + 2}, with midpoint and "
                f"sharpness), got {row}"
            )
        full.append(row if len(row) == width + 2 else (*row, 0.5, 0.0))
    table = np.array(sorted(full, key=lambda row: row[0]), np.float64)
    if not np.isfinite(table).all():
        raise ValueError(f"the nodes of {name} must be finite, got {rows}")
    return table


def _fraction(x: Array, left: Array, right: Array) -> Array:
    """Position between two nodes, bent so that 0.5 is at the midpoint."""
    width = right[:, 0] - left[:, 0]
    s = np.divide(x - left[:, 0], width, out=np.zeros_like(x), where=width > 0)
    middle = np.clip(left[:, -2], MIDPOINT_MIN, MIDPOINT_MAX)
    return np.where(s < middle, 0.5 * s / middle, 0.5 + 0.5 * (s - middle) / (1.0 - middle))


def _hermite(s: Array, y1: Array, y2: Array, sharpness: Array) -> Array:
    """Sharpened cubic between two nodes, kept between their values."""
    power = 1.0 + 10.0 * sharpness
    s = np.clip(s, 0.0, 1.0)
    bent = np.where(s < 0.5, 0.5 * (2.0 * s) ** power, 1.0 - 0.5 * (2.0 - 2.0 * s) ** power)
    s2, s3 = bent * bent, bent * bent * bent
    slope = (1.0 - sharpness) * (y2 - y1)
    y = (2 * s3 - 3 * s2 + 1) * y1 + (3 * s2 - 2 * s3) * y2 + (2 * s3 - 3 * s2 + bent) * slope
    return np.clip(y, np.minimum(y1, y2), np.maximum(y1, y2))


def _between(x: Array, table: Array, column: int, steps: bool) -> Array:
    """Values inside the nodes. Sharp colour nodes are steps; sharp opacity nodes stay smooth."""
    last = len(table) - 1
    # VTK treats a node's own position as the end of the interval before it
    index = np.clip(np.searchsorted(table[:, 0], x, side="left") - 1, 0, max(last - 1, 0))
    left, right = table[index], table[np.minimum(index + 1, last)]
    s = _fraction(x, left, right)
    y1, y2, sharpness = left[:, column], right[:, column], left[:, -1]
    smooth = _hermite(s, y1, y2, sharpness)
    linear = (1.0 - s) * y1 + s * y2
    y = np.where(sharpness < LINEAR_BELOW, linear, smooth)
    if steps:
        y = np.where(sharpness > STEP_ABOVE, np.where(s < 0.5, y1, y2), y)
    return y


def _evaluate(x: ArrayLike, table: Array, column: int, clamp: bool, steps: bool) -> Array:
    flat = np.atleast_1d(np.asarray(x, np.float64)).ravel()
    y = _between(flat, table, column, steps)
    first, last = table[0], table[-1]
    y = np.where(flat <= first[0], first[column], y)
    y = np.where(flat >= last[0], last[column], y)
    if not clamp:
        # An unclamped opacity function has ended at its last node, a colour function just after it
        ended = flat > last[0] if steps else flat >= last[0]
        y = np.where((flat < first[0]) | ended, 0.0, y)
    return y.reshape(np.shape(x))


@dataclass(frozen=True)
class Curve:
    """Number as a function of the scalar, as a vtkPiecewiseFunction.

    Parameters
    ----------
    nodes : iterable of (x, y) or (x, y, midpoint, sharpness)
        In any order. Midpoint and sharpness (both 0 to 1) shape the way to the next node.
    clamp : bool
        Outside the nodes: the nearest node's value (True) or 0 (False).
    """

    nodes: tuple[tuple[float, ...], ...]
    clamp: bool = True
    _table: Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        table = _nodes(self.nodes, 2, "an opacity or extinction curve")
        object.__setattr__(self, "nodes", tuple(map(tuple, table.tolist())))
        object.__setattr__(self, "_table", table)

    def __call__(self, x: ArrayLike) -> Array:
        """Evaluate at x, any shape; float64 of the same shape."""
        return _evaluate(x, self._table, 1, self.clamp, steps=False)

    @property
    def finest_step(self) -> float:
        """Smallest distance between neighbouring nodes at different positions; inf for one node."""
        return _finest_step(self._table)


@dataclass(frozen=True)
class ColourCurve:
    """Linear RGB as a function of the scalar, as a vtkColorTransferFunction in RGB space.

    Parameters
    ----------
    nodes : iterable of (x, r, g, b) or (x, r, g, b, midpoint, sharpness)
        Colours from 0 to 1.
    clamp : bool
        Outside the nodes: the nearest node's colour (True) or black (False).
    """

    nodes: tuple[tuple[float, ...], ...]
    clamp: bool = True
    _table: Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        table = _nodes(self.nodes, 4, "a colour curve")
        colours = table[:, 1:4]
        if (colours < 0).any() or (colours > 1).any():
            raise ValueError(f"colours go from 0 to 1, got {table[:, :4].tolist()}")
        object.__setattr__(self, "nodes", tuple(map(tuple, table.tolist())))
        object.__setattr__(self, "_table", table)

    def __call__(self, x: ArrayLike) -> Array:
        """Evaluate at x, any shape; float64 with a last axis of 3."""
        channels = [_evaluate(x, self._table, c, self.clamp, steps=True) for c in (1, 2, 3)]
        return np.stack(channels, axis=-1)

    @property
    def finest_step(self) -> float:
        """Smallest distance between neighbouring nodes at different positions; inf for one node."""
        return _finest_step(self._table)


def _finest_step(table: Array) -> float:
    steps = np.diff(table[:, 0])
    steps = steps[steps > 0]
    return float(steps.min()) if len(steps) else float("inf")
