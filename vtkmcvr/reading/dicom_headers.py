"""Read the header of one DICOM file; no pixels and no patient attributes are looked at."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .dicom_geometry import Plane
from .errors import VolumeReadError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

VARIANT_TAGS = {
    "ImageType": "image type",
    "AcquisitionNumber": "acquisition number",
    "EchoTime": "echo time",
    "TriggerTime": "trigger time",
    "TemporalPositionIdentifier": "temporal position",
    "DiffusionBValue": "b-value",
}
HEADER_TAGS = [
    "SOPInstanceUID",
    "SeriesInstanceUID",
    "SeriesNumber",
    "Modality",
    "Rows",
    "Columns",
    "NumberOfFrames",
    "ImagePositionPatient",
    "ImageOrientationPatient",
    "PixelSpacing",
    "RescaleSlope",
    "RescaleIntercept",
    "RescaleType",
    "Units",
    "BitsStored",
    "PixelRepresentation",
    "SamplesPerPixel",
    "PhotometricInterpretation",
    *VARIANT_TAGS,
]


@dataclass(frozen=True)
class SliceHeader:
    """What the reader needs to know about one DICOM image file."""

    path: Path
    storage_class: str
    instance_uid: str
    series_uid: str
    series_number: int | None
    modality: str
    rows: int
    columns: int
    frames: int
    plane: Plane | None
    rescale: tuple[float, float] | None
    rescale_type: str
    unit: str
    pixel_format: tuple[int, int, int]
    photometric: str
    variants: tuple[str, ...]

    @property
    def is_signed(self) -> bool:
        """Whether stored pixels are signed."""
        return self.pixel_format[1] == 1


def read_dataset(file: Path, tags: Sequence[str] | None = HEADER_TAGS) -> Any:
    """Return the header of a DICOM file as a pydicom dataset, or None if it is not DICOM.

    Parameters
    ----------
    file : Path
        Any file.
    tags : sequence of str or None
        Keywords of the attributes to keep; None keeps all.

    Raises
    ------
    VolumeReadError
        If it is DICOM with a damaged header.
    """
    import pydicom

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return pydicom.dcmread(
                file, stop_before_pixels=True, specific_tags=None if tags is None else list(tags)
            )
        except pydicom.errors.InvalidDicomError:
            return None
        except OSError:
            raise
        except Exception:
            # pydicom raises many kinds of error, and its texts may quote patient attributes.
            raise VolumeReadError(
                f"{file}: the DICOM header is damaged; copy or export the file again."
            ) from None


def header_from_dataset(file: Path, dataset: Any) -> SliceHeader | None:
    """Return the facts about an image file, or None if the file holds no image."""
    rows, columns = _integer(dataset, "Rows"), _integer(dataset, "Columns")
    if not rows or not columns:
        return None
    return SliceHeader(
        path=file,
        storage_class=storage_class(dataset),
        instance_uid=text_of(dataset, "SOPInstanceUID"),
        series_uid=text_of(dataset, "SeriesInstanceUID"),
        series_number=_integer(dataset, "SeriesNumber"),
        modality=text_of(dataset, "Modality"),
        rows=rows,
        columns=columns,
        frames=_integer(dataset, "NumberOfFrames") or 1,
        plane=plane_from(dataset, dataset, dataset),
        rescale=rescale_from(dataset),
        rescale_type=text_of(dataset, "RescaleType"),
        unit=text_of(dataset, "Units"),
        pixel_format=_pixel_format(dataset),
        photometric=text_of(dataset, "PhotometricInterpretation"),
        variants=tuple(text_of(dataset, tag) for tag in VARIANT_TAGS),
    )


def _pixel_format(dataset: Any) -> tuple[int, int, int]:
    return (
        _integer(dataset, "BitsStored") or 0,
        _integer(dataset, "PixelRepresentation") or 0,
        _integer(dataset, "SamplesPerPixel") or 1,
    )


def plane_from(position: Any, orientation: Any, measures: Any) -> Plane | None:
    """Return the image plane from the datasets that hold its three attributes, if all are there."""
    parts = (
        _floats(position, "ImagePositionPatient", 3),
        _floats(orientation, "ImageOrientationPatient", 6),
        _floats(measures, "PixelSpacing", 2),
    )
    return Plane(*parts) if all(parts) else None


def rescale_from(dataset: Any) -> tuple[float, float] | None:
    """Return rescale slope and intercept, or None where the dataset has none."""
    slope = _floats(dataset, "RescaleSlope", 1)
    intercept = _floats(dataset, "RescaleIntercept", 1)
    return (slope[0], intercept[0]) if slope and intercept else None


def varying(headers: Sequence[SliceHeader]) -> str:
    """Name the attributes that tell several slices at one position apart."""
    columns = zip(*(header.variants for header in headers), strict=True)
    names = zip(VARIANT_TAGS.values(), columns, strict=True)
    return " and ".join(name for name, values in names if len(set(values)) > 1)


def value_of(dataset: Any, tag: str) -> Any:
    """Return the value of an attribute, or None if it is absent or makes no sense."""
    if dataset is None:
        return None
    with warnings.catch_warnings():
        # pydicom decodes here, and warns about oddities that do not matter to the volume.
        warnings.simplefilter("ignore")
        try:
            return dataset.get(tag)
        except Exception:
            return None


def storage_class(dataset: Any) -> str:
    """Return the kind of object that the file says it stores."""
    return text_of(dataset.file_meta, "MediaStorageSOPClassUID")


def text_of(dataset: Any, tag: str) -> str:
    """Return an attribute as text, empty if it is absent or makes no sense."""
    value = value_of(dataset, tag)
    return "" if value is None else str(value).strip()


def _integer(dataset: Any, tag: str) -> int | None:
    try:
        return int(text_of(dataset, tag))
    except ValueError:
        return None


def _floats(dataset: Any, tag: str, count: int) -> tuple[float, ...]:
    value = value_of(dataset, tag)
    try:
        numbers = [float(value)] if count == 1 else [float(part) for part in value]
    except (TypeError, ValueError):
        return ()
    return tuple(numbers) if len(numbers) == count and all(map(math.isfinite, numbers)) else ()
