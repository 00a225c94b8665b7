"""vtkPiecewiseFunction and vtkColorTransferFunction -> curves."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

from ..curves import STEP_ABOVE, ColourCurve, Curve
from ..material import TransferTable

# Samples of a function that nodes alone do not describe: in all, and at least between two nodes
SAMPLES, FEWEST = 4096, 16
SHARPNESS = -1
# Largest gradient magnitude of a 2-D function over the range of the scalars
GRADIENT_SHARE = 0.25
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
        nodes = _sampled(function, nodes, 1, logarithmic=True)
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
    table = _sampled(function, nodes, 3, logarithmic)
    if ends:
        margin = ((table[-1, 0] - table[0, 0]) or max(abs(table[0, 0]), 1.0)) / SAMPLES
        outside = [table[0, 0] - margin, table[-1, 0] + margin]
        table = np.vstack([table, *(_table(function, x, x, 1, 3) for x in outside)])
    table[:, 1:] = np.clip(table[:, 1:], 0.0, 1.0)
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
        samples = _sampled(function, nodes, 1, logarithmic)
        nodes = np.column_stack([samples, np.full(len(samples), 0.5), np.zeros(len(samples))])
    table = nodes[:, [0, 1, 1, 1, 2, 3]]
    if function.GetClamping():
        return ColourCurve(_tuples(table))
    # An unclamped piecewise function has ended at its last node, a colour function just after it
    end = (table[-1, 0], 0.0, 0.0, 0.0, 0.5, 0.0)
    return ColourCurve((*_tuples(table), end), clamp=False)


def transfer_table(
    image: vtkImageData | None, scalar_range: tuple[float, float] | None
) -> TransferTable:
    """Table of scalar and gradient magnitude of a property's 2-D function.

    Raises
    ------
    ValueError
        Where there is no function, it is not RGBA, or the volume's range is not given.
    """
    if image is None or image.GetNumberOfScalarComponents() != 4:
        raise ValueError(
            "a 2-D transfer function is a vtkImageData with four components; call "
            "SetTransferFunction2D(image)"
        )
    if scalar_range is None:
        raise ValueError("a 2-D transfer function spans the scalars of a volume: give scalar_range")
    columns, rows, _ = image.GetDimensions()
    rgba = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, 4)
    low, high = scalar_range
    width = high - low if high > low else 1.0
    return TransferTable(np.clip(rgba, 0.0, 1.0), (low, low + width), (0.0, GRADIENT_SHARE * width))


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


def _sampled(
    function: Any, nodes: NDArray[np.float64], channels: int, logarithmic: bool
) -> NDArray[np.float64]:
    """Close samples over the range of the nodes, (n, 1 + channels)."""
    edges = np.unique(nodes[:, 0])
    # VTK falls back to a linear scale
    logarithmic = logarithmic and edges[0] > 0
    count = max(FEWEST, SAMPLES // max(1, len(edges) - 1)) + 1
    tables = [_table(function, edges[0], edges[0], 1, channels)]
    for low, high in itertools.pairwise(edges):
        tables.append(_table(function, low, high, count, channels, logarithmic)[1:])
    # At the end of its last interval, a function that is not clamped may be over
    tables[-1][-1, 1:] = nodes[-1, 1 : 1 + channels]
    return np.concatenate(tables)


def _table(
    function: Any, low: float, high: float, count: int, channels: int, logarithmic: bool = False
) -> NDArray[np.float64]:
    """Rows of position and value as volume mappers look them up, (count, 1 + channels)."""
    values = np.empty(count * channels)
    if logarithmic and channels == 1:
        function.GetTable(low, high, count, values, 1, 1)
    else:
        # A colour function spaces its entries by its own scale
        function.GetTable(low, high, count, values)
    positions = (np.geomspace if logarithmic else np.linspace)(low, high, count)
    return np.column_stack([positions, values.reshape(count, channels)])


def _tuples(table: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, table.tolist()))
