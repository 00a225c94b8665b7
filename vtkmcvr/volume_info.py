"""Facts about a volume: what the reader noticed, and what `vtkmcvr info` prints."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray
    from vtkmodules.vtkCommonDataModel import vtkImageData

__all__ = [
    "Segment",
    "count_nonfinite",
    "format_info",
    "modality",
    "notes",
    "record_facts",
    "segments",
    "units",
    "volume_info",
]

NOTES_FIELD = "vtkmcvr.notes"
MODALITY_FIELD = "vtkmcvr.modality"
UNITS_FIELD = "vtkmcvr.units"
SEGMENTS_FIELD = "vtkmcvr.segments"

HISTOGRAM_BINS = 32
PERCENTILES = (1, 50, 99)
CHUNK = 1 << 22
BAR_WIDTH = 40


@dataclass(frozen=True)
class Segment:
    """What one value of a label map means.

    Attributes
    ----------
    value : int
        The label.
    name : str
        Such as "liver".
    colour : tuple of 3 floats
        sRGB, 0 to 1.
    """

    value: int
    name: str
    colour: tuple[float, float, float]


# Facts stored on the image


def record_facts(
    image: vtkImageData, noted: list[str], modality: str, units: str,
    segments: Sequence[Segment] = (),
) -> None:  # fmt: skip
    """Store notes, modality and units as field data of `image`, replacing earlier ones.

    Parameters
    ----------
    image : vtkImageData
        The image to annotate.
    noted : list of str
        Notes, stored as JSON.
    modality, units : str
        DICOM modality ("CT", "MR" ...) and unit of the values ("HU"), empty where unknown.
    segments : sequence of Segment, optional
        For a label map, stored as JSON.
    """
    from vtkmodules.vtkCommonCore import vtkStringArray

    facts = {NOTES_FIELD: json.dumps(noted), MODALITY_FIELD: modality, UNITS_FIELD: units}
    if segments:
        facts[SEGMENTS_FIELD] = json.dumps([[s.value, s.name, s.colour] for s in segments])
    for name, text in facts.items():
        array = vtkStringArray()
        array.SetName(name)
        array.InsertNextValue(text)
        image.GetFieldData().AddArray(array)


def notes(image: vtkImageData) -> list[str]:
    """Return what the reader noticed about `image`; empty if nothing was recorded."""
    return list(json.loads(_recorded(image, NOTES_FIELD) or "[]"))


def modality(image: vtkImageData) -> str:
    """Return the DICOM modality of `image`, such as "CT"; empty if unknown."""
    return _recorded(image, MODALITY_FIELD)


def units(image: vtkImageData) -> str:
    """Return the unit of the values of `image`, such as "HU"; empty if unknown."""
    return _recorded(image, UNITS_FIELD)


def segments(image: vtkImageData) -> list[Segment]:
    """Return what the labels of `image` mean; empty if it is no label map."""
    stored = json.loads(_recorded(image, SEGMENTS_FIELD) or "[]")
    return [Segment(int(value), str(name), tuple(colour)) for value, name, colour in stored]


def _recorded(image: vtkImageData, name: str) -> str:
    array = image.GetFieldData().GetAbstractArray(name)
    return "" if array is None or array.GetNumberOfValues() == 0 else str(array.GetValue(0))


# Measured facts


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


# The page that `vtkmcvr info` prints


def format_info(info: dict[str, Any]) -> str:
    """Format the facts from `volume_info` as a plain-text page.

    Parameters
    ----------
    info : dict
        What `volume_info` returned.

    Returns
    -------
    str
        Lines of text, ending with a histogram whose bars are logarithmic in the count.
    """
    lines = [f"{label:<12} {text}" for label, text in _rows(info) if text]
    lines += [f"{'note':<12} {note}" for note in info["notes"]]
    lines += [f"{'label':<12} {s['value']} {s['name']}" for s in info.get("segments", [])]
    return "\n".join(lines + _histogram_lines(info)) + "\n"


def _rows(info: dict[str, Any]) -> list[tuple[str, str]]:
    unit = f" {info['units']}" if info["units"] else ""
    percentiles = [
        f"{p} %: {_numbers([value])}"
        for p, value in info["percentiles"].items()
        if value is not None
    ]
    return [
        ("dimensions", " x ".join(str(n) for n in info["dimensions"])),
        ("spacing", _numbers(info["spacing"])),
        ("origin", _numbers(info["origin"])),
        ("direction", "   ".join(_numbers(axis) for axis in zip(*info["direction"], strict=True))),
        ("bounds", _numbers(info["bounds"])),
        ("values", _describe_values(info)),
        ("modality", info["modality"]),
        ("range", f"{_numbers(info['range'])}{unit}" if info["range"] else "no finite value"),
        ("percentiles", ", ".join(percentiles)),
        ("not finite", _describe_nonfinite(info)),
    ]


def _describe_nonfinite(info: dict[str, Any]) -> str:
    nan, infinite = info["nan"], info["inf"]
    return f"{nan} NaN, {infinite} infinite" if nan or infinite else ""


def _describe_values(info: dict[str, Any]) -> str:
    if not info["association"]:
        return "none: the image has no point or cell array"
    count = info["components"]
    parts = f", {count} components" if count > 1 else ""
    name = f"'{info['array']}' " if info["array"] else ""
    return f"{name}on {info['association']}, {info['dtype']}{parts}, {info['memory_mb']:.1f} MB"


def _numbers(values: Any) -> str:
    return " ".join(f"{value + 0.0:.6g}" for value in values)


def _histogram_lines(info: dict[str, Any]) -> list[str]:
    counts, edges = info["histogram"]["counts"], info["histogram"]["edges"]
    if not counts:
        return []
    longest = math.log1p(max(counts))
    lines = ["", "from .. to (bars are logarithmic)"]
    for count, low, high in zip(counts, edges[:-1], edges[1:], strict=True):
        bar = "#" * math.ceil(BAR_WIDTH * math.log1p(count) / longest)
        lines.append(f"{low:>12.5g} .. {high:<12.5g} {bar:<{BAR_WIDTH}} {count}".rstrip())
    return lines
