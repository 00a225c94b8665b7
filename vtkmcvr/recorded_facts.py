"""What a reader noticed about a volume, kept in the image's field data."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vtkmodules.vtkCommonDataModel import vtkImageData

NOTES_FIELD = "vtkmcvr.notes"
MODALITY_FIELD = "vtkmcvr.modality"
UNITS_FIELD = "vtkmcvr.units"
SEGMENTS_FIELD = "vtkmcvr.segments"


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
