"""vtkPiecewiseFunction and vtkColorTransferFunction -> curves."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

from .curves import STEP_ABOVE, ColourCurve, Curve

# Samples of a function that nodes alone do not describe: in all, and at least between two nodes
SAMPLES, FEWEST = 4096, 16
SHARPNESS = -1
RGB, LOGARITHMIC = 0, 1


def opacity_curve(function: vtkPiecewiseFunction) -> Curve:
    """Curve of a piecewise function: its nodes, or close samples where its scale is logarithmic.

    Raises
    ------
    ValueError
        Where it has no node.
    """
    nodes = _nodes(function, 4)
    clamp = bool(function.GetClamping())
    if _is_logarithmic(function):
        positions = _positions(nodes, logarithmic=True)
        nodes = np.array([(x, function.GetValue(x)) for x in positions])
    return Curve(_tuples(nodes), clamp)


def colour_curve(function: vtkColorTransferFunction) -> ColourCurve:
    """Colour curve of a colour function; its numbers are linear RGB, as VTK shades with them.

    The nodes themselves for RGB on a linear scale. Another colour space, a logarithmic scale and
    colours below and above the range are sampled at `SAMPLES` places or more.

    Raises
    ------
    ValueError
        Where it has no node, or looks colours up by annotation.
    """
    if function.GetIndexedLookup():
        raise ValueError(
            "an indexed (categorical) colour function is not supported yet; call IndexedLookupOff()"
        )
    nodes = _nodes(function, 6)
    logarithmic = function.GetScale() == LOGARITHMIC
    ends = bool(function.GetUseBelowRangeColor() or function.GetUseAboveRangeColor())
    if function.GetColorSpace() == RGB and not logarithmic and not ends:
        return ColourCurve(_tuples(nodes), clamp=bool(function.GetClamping()))
    positions = _positions(nodes, logarithmic, ends)
    colours = np.clip([_colour(function, x) for x in positions], 0.0, 1.0)
    table = np.column_stack([positions, colours])
    return ColourCurve(_tuples(table), clamp=ends or bool(function.GetClamping()))


def grey_curve(function: vtkPiecewiseFunction) -> ColourCurve:
    """Grey colour curve of a piecewise function.

    Raises
    ------
    ValueError
        Where it has no node.
    """
    nodes = _nodes(function, 4)
    logarithmic = _is_logarithmic(function)
    # A sharp node of a piecewise function is smooth, of a colour function a step
    if logarithmic or (nodes[:, SHARPNESS] > STEP_ABOVE).any():
        positions = _positions(nodes, logarithmic)
        nodes = np.array([(x, function.GetValue(x), 0.5, 0.0) for x in positions])
    table = nodes[:, [0, 1, 1, 1, 2, 3]]
    if function.GetClamping():
        return ColourCurve(_tuples(table))
    # An unclamped piecewise function has ended at its last node, a colour function just after it
    end = (table[-1, 0], 0.0, 0.0, 0.0, 0.5, 0.0)
    return ColourCurve((*_tuples(table), end), clamp=False)


def _nodes(function: Any, width: int) -> NDArray[np.float64]:
    """Node values as VTK gives them, (n, width)."""
    count = function.GetSize()
    if not count:
        raise ValueError(f"the {function.GetClassName()} has no nodes; add points to it")
    rows = np.empty((count, width))
    for index, row in enumerate(rows):
        function.GetNodeValue(index, row)
    return rows


def _is_logarithmic(function: vtkPiecewiseFunction) -> bool:
    # Missing in old versions of VTK
    return bool(getattr(function, "GetUseLogScale", int)())


def _positions(
    nodes: NDArray[np.float64], logarithmic: bool, ends: bool = False
) -> NDArray[np.float64]:
    """Sorted places to sample: nodes, between them, and just outside where `ends` is set."""
    x = np.unique(nodes[:, 0])
    count = max(FEWEST, SAMPLES // max(1, len(x) - 1)) + 1
    between = [_between(low, high, count, logarithmic) for low, high in itertools.pairwise(x)]
    margin = ((x[-1] - x[0]) or max(abs(x[0]), 1.0)) / SAMPLES
    outside = [x[0] - margin, x[-1] + margin] if ends else []
    return np.unique(np.concatenate([x, *between, outside]))


def _between(low: float, high: float, count: int, logarithmic: bool) -> NDArray[np.float64]:
    spread = np.geomspace if logarithmic and low > 0 else np.linspace
    return spread(low, high, count)[1:-1]


def _colour(function: vtkColorTransferFunction, x: float) -> list[float]:
    """Colour as volume mappers look it up."""
    rgb = [0.0, 0.0, 0.0]
    function.GetTable(x, x, 1, rgb)
    return rgb


def _tuples(table: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, table.tolist()))
