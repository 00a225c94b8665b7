"""Take attributes out of a DICOM dataset, whatever nonsense they hold."""

from __future__ import annotations

import math
import struct
from typing import Any

from .dicom_geometry import Plane

# Attributes that are not stored as text: the letter of their type in `struct`.
BINARY = {
    "Rows": "H",
    "Columns": "H",
    "BitsAllocated": "H",
    "BitsStored": "H",
    "PixelRepresentation": "H",
    "SamplesPerPixel": "H",
    "PlanarConfiguration": "H",
    "PixelPaddingValue": "H",
    "PixelPaddingRangeLimit": "H",
    "DiffusionBValue": "d",
}


class RawHeader:
    """The top level of a dataset, decoded without pydicom's checks, which take most of its time.

    Only for attributes of text and those in `BINARY`.

    Parameters
    ----------
    dataset : pydicom.Dataset
        As read, before any attribute was looked at.
    """

    def __init__(self, dataset: Any):
        from pydicom.datadict import keyword_for_tag

        self.values: dict[str, Any] = {}
        self.order = "<"
        for element in dataset.values():
            self.values[keyword_for_tag(element.tag)] = element.value
            if not getattr(element, "is_little_endian", True):
                self.order = ">"

    def get(self, tag: str) -> Any:
        """Return an attribute as text or number, None if it is absent or of another length."""
        value = self.values.get(tag)
        if not isinstance(value, bytes):
            return value
        kind = BINARY.get(tag)
        if kind is None:
            return value.decode("utf-8", errors="replace").strip("\0 ")
        if len(value) < struct.calcsize(kind):
            return None
        return struct.unpack_from(self.order + kind, value)[0]


def value_of(dataset: Any, tag: str) -> Any:
    """Return the value of an attribute, or None if it is absent or makes no sense."""
    if dataset is None or not tag:
        return None
    if isinstance(dataset, RawHeader):
        return dataset.get(tag)
    try:
        return dataset.get(tag)
    except Exception:
        # pydicom decodes here, and raises many kinds of error.
        return None


def text_of(dataset: Any, tag: str) -> str:
    """Return an attribute as text, empty if it is absent or makes no sense."""
    value = value_of(dataset, tag)
    return "" if value is None else str(value).strip()


def integer_of(dataset: Any, tag: str) -> int | None:
    """Return an attribute as a whole number, or None."""
    try:
        return int(text_of(dataset, tag))
    except ValueError:
        return None


def floats_of(dataset: Any, tag: str, count: int) -> tuple[float, ...]:
    """Return an attribute as `count` finite numbers (any number of them if 0), or nothing."""
    value = value_of(dataset, tag)
    try:
        parts = value.split("\\") if isinstance(value, str) else value
        numbers = [float(value)] if count == 1 else [float(part) for part in parts]
    except (TypeError, ValueError):
        return ()
    right = len(numbers) == count or count == 0
    return tuple(numbers) if right and all(map(math.isfinite, numbers)) else ()


def items_of(dataset: Any, tag: str) -> list[Any]:
    """Return the items of a sequence, none if it is absent or is no sequence."""
    value = value_of(dataset, tag)
    try:
        return [item for item in value or [] if hasattr(item, "get")]
    except TypeError:
        return []


def plane_from(position: Any, orientation: Any, measures: Any) -> Plane | None:
    """Return the image plane from the datasets that hold its three attributes, if all are there."""
    parts = (
        floats_of(position, "ImagePositionPatient", 3),
        floats_of(orientation, "ImageOrientationPatient", 6),
        floats_of(measures, "PixelSpacing", 2),
    )
    return Plane(*parts) if all(parts) else None
