"""What there is to measure about a volume."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from .recorded_facts import modality, notes, segments, units

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from vtkmodules.vtkCommonDataModel import vtkImageData

HISTOGRAM_BINS = 32
PERCENTILES = (1, 50, 99)
CHUNK = 1 << 22


def count_nonfinite(values: NDArray[Any]) -> tuple[int, int]:
    """Return how many of `values` are NaN and how many are infinite."""
    if values.dtype.kind != "f":
        return 0, 0
    return (
        sum(int(np.isnan(part).sum()) for part in _chunks(values)),
        sum(int(np.isinf(part).sum()) for part in _chunks(values)),
    )


def volume_info(image: vtkImageData) -> dict[str, Any]:
    """Measure what there is to know about a volume.

    Looks at the active point scalars, else the first point array, else the cell scalars.
    Above 4 M values that are not 8- or 16-bit integers, percentiles come from an even sample.

    Parameters
    ----------
    image : vtkImageData
        Any image, also one from PyVista or without values.

    Returns
    -------
    dict
        Ready for JSON. `dimensions`, `spacing`, `origin`, `bounds` (world, as VTK gives them),
        `direction` (3 x 3 rows whose columns are the axes), `array`, `association` ("points",
        "cells" or ""), `dtype`, `components`, `memory_mb` (10**6 bytes), `range` (lowest and
        highest finite value, or None), `component_ranges`, `nan` and `inf` (counts),
        `percentiles`, `histogram` (`counts` and `edges` of 32 bins over all components),
        `notes`, `modality`, `units` and `segments` (value, name and colour of each label).
    """
    direction = image.GetDirectionMatrix()
    return {
        "dimensions": list(image.GetDimensions()),
        "spacing": list(image.GetSpacing()),
        "origin": list(image.GetOrigin()),
        "direction": [[direction.GetElement(i, j) for j in range(3)] for i in range(3)],
        "bounds": list(image.GetBounds()),
        **_array_facts(image),
        "notes": notes(image),
        "modality": modality(image),
        "units": units(image),
        "segments": [asdict(segment) for segment in segments(image)],
    }


def _array_facts(image: vtkImageData) -> dict[str, Any]:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    array, association = _shown_array(image)
    values = np.zeros(0, np.float32) if array is None else vtk_to_numpy(array)
    nan, infinite = count_nonfinite(values)
    columns = values.reshape(len(values), -1).T if values.size else values[None]
    return {
        "array": "" if array is None else array.GetName() or "",
        "association": association,
        "dtype": "" if array is None else str(values.dtype),
        "components": 0 if array is None else len(columns),
        "memory_mb": values.nbytes / 1e6,
        "range": _finite_range(values),
        "component_ranges": [_finite_range(column) for column in columns] if values.size else [],
        "nan": nan,
        "inf": infinite,
        **_distribution(values),
    }


def _shown_array(image: vtkImageData) -> tuple[Any, str]:
    for data, association in ((image.GetPointData(), "points"), (image.GetCellData(), "cells")):
        array = data.GetScalars() or (data.GetArray(0) if data.GetNumberOfArrays() else None)
        if array is not None:
            return array, association
    return None, ""


def _chunks(values: NDArray[Any]) -> Iterator[NDArray[Any]]:
    flat = values.reshape(-1) if values.flags.c_contiguous else np.ravel(values)
    for start in range(0, flat.size, CHUNK):
        yield flat[start : start + CHUNK]


def _finite_chunks(values: NDArray[Any]) -> Iterator[NDArray[Any]]:
    for part in _chunks(values):
        finite = part[np.isfinite(part)] if part.dtype.kind == "f" else part
        if finite.size:
            yield finite


def _finite_range(values: NDArray[Any]) -> list[float] | None:
    extremes = [(part.min(), part.max()) for part in _finite_chunks(values)]
    if not extremes:
        return None
    return [min(low for low, _ in extremes).item(), max(high for _, high in extremes).item()]


def _distribution(values: NDArray[Any]) -> dict[str, Any]:
    bounds = _finite_range(values)
    if bounds is None:
        unknown = dict.fromkeys(map(str, PERCENTILES))
        return {"percentiles": unknown, "histogram": {"counts": [], "edges": []}}
    edges = np.histogram_bin_edges(np.array(bounds, dtype=np.float64), HISTOGRAM_BINS)
    if values.dtype.kind in "iu" and values.dtype.itemsize <= 2:
        counts, percentiles = _count_levels(values, edges)
    else:
        parts = [np.histogram(part, edges)[0] for part in _finite_chunks(values)]
        counts = np.sum(parts, axis=0)
        percentiles = np.percentile(_sample(values), PERCENTILES).tolist()
    return {
        "percentiles": {
            str(p): float(value) for p, value in zip(PERCENTILES, percentiles, strict=True)
        },
        "histogram": {"counts": [int(n) for n in counts], "edges": [float(e) for e in edges]},
    }


def _count_levels(
    values: NDArray[Any], edges: NDArray[np.float64]
) -> tuple[NDArray[np.int64], list[float]]:
    """Return the histogram and exact percentiles of small integers from one count per level."""
    lowest = int(np.iinfo(values.dtype).min)
    levels = np.arange(lowest, int(np.iinfo(values.dtype).max) + 1)
    occurrences = np.zeros(len(levels), np.int64)
    for part in _chunks(values):
        shifted = part.astype(np.int32) - lowest
        occurrences += np.bincount(shifted, minlength=len(levels))
    counts = np.histogram(levels, edges, weights=occurrences)[0].astype(np.int64)
    reached = np.cumsum(occurrences)
    ranks = (math.ceil(p / 100 * reached[-1]) for p in PERCENTILES)
    return counts, [float(levels[np.searchsorted(reached, rank)]) for rank in ranks]


def _sample(values: NDArray[Any]) -> NDArray[Any]:
    # An odd stride does not fall into step with even row lengths or component counts.
    stride = 2 * (values.size // (2 * CHUNK)) + 1
    sampled = values.reshape(-1)[::stride]
    finite = sampled[np.isfinite(sampled)]
    return finite if finite.size else np.concatenate(list(_finite_chunks(values)))
