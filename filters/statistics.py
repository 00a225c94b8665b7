"""Picture -> table of what is known of it."""

from __future__ import annotations

from typing import Any

from vtkmodules.vtkCommonCore import (
    vtkAbstractArray,
    vtkDoubleArray,
    vtkIdTypeArray,
    vtkStringArray,
)
from vtkmodules.vtkCommonDataModel import vtkTable

from vtkmcvr.pictures.noiseless import NoiselessPicture
from vtkmcvr.pictures.picture import Picture


def table_of_picture(picture: Picture | NoiselessPicture) -> vtkTable:
    """Table of one row.

    Columns: "samples", "seconds", "nrms" (NaN where unknown), "paths_per_second", "stopped_by",
    "rejected_samples", "threads" and "plan", which is what was simulated, with reasons. Numbers of
    a technique without samples are 0.
    """
    facts = picture.facts()
    nrms = facts["nrms"]
    columns = {
        "samples": int(picture.samples),
        "seconds": float(picture.seconds),
        "nrms": float("nan") if nrms is None else float(nrms),
        "paths_per_second": float(facts.get("paths_per_second", 0.0)),
        "stopped_by": picture.stopped_by,
        "rejected_samples": int(picture.rejected_samples),
        "threads": int(picture.threads),
        "plan": picture.plan.explain(),
    }
    table = vtkTable()
    for name, value in columns.items():
        table.AddColumn(_column(name, value))
    return table


def _column(name: str, value: Any) -> vtkAbstractArray:
    kinds: dict[type, Any] = {int: vtkIdTypeArray, float: vtkDoubleArray, str: vtkStringArray}
    array = kinds[type(value)]()
    array.SetName(name)
    array.InsertNextValue(value)
    return array
