"""Read the header of one DICOM file; no pixels and no patient attributes are looked at."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .dicom_deflated import check_deflated
from .dicom_quiet import quiet_pydicom
from .dicom_tags import RawHeader, floats_of, integer_of, text_of, value_of
from .errors import VolumeReadError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .dicom_geometry import Plane

# What may tell slices at one position apart: attribute of a file, then of a frame.
TRAITS = {
    "image type": ("ImageType", "FrameType"),
    "echo time": ("EchoTime", "EffectiveEchoTime"),
    "b-value": ("DiffusionBValue", "DiffusionBValue"),
    "temporal position": ("TemporalPositionIdentifier", "TemporalPositionIndex"),
    "acquisition number": ("AcquisitionNumber", ""),
    "trigger time": ("TriggerTime", "NominalCardiacTriggerDelayTime"),
    "frame time": ("FrameReferenceTime", ""),
    "acquisition time": ("AcquisitionTime", ""),
    "instance number": ("InstanceNumber", ""),
}
HEADER_TAGS = [
    "SOPInstanceUID",
    "SeriesInstanceUID",
    "SeriesNumber",
    "SeriesDescription",
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
    "BitsAllocated",
    "BitsStored",
    "PixelRepresentation",
    "SamplesPerPixel",
    "PlanarConfiguration",
    "PhotometricInterpretation",
    "PixelPaddingValue",
    "PixelPaddingRangeLimit",
    "GridFrameOffsetVector",
    "DoseGridScaling",
    "DoseUnits",
    "ModalityLUTSequence",
    *(tag for tag, _ in TRAITS.values()),
]


@dataclass(frozen=True)
class PixelFormat:
    """How the pixels of a file are stored."""

    allocated: int
    stored: int
    signed: bool
    samples: int
    planar: bool
    photometric: str


@dataclass(frozen=True)
class FileHeader:
    """What the reader needs to know about one DICOM image file.

    `pixel_offset` is where the pixel data element begins; `description` may hold anything, so it
    is shown only to those who ask for it.
    """

    path: Path
    storage_class: str
    syntax: str
    pixel_offset: int
    instance_uid: str
    series_uid: str
    series_number: int | None
    description: str = field(repr=False)
    modality: str
    rows: int
    columns: int
    frames: int
    pixels: PixelFormat
    unit: str
    padding: tuple[int, int] | None
    has_lookup_table: bool


@dataclass(frozen=True)
class Frame:
    """One slice: a file, or a frame of a multi-frame file.

    `traits` has one text per entry of `TRAITS`.
    """

    file: FileHeader
    index: int
    plane: Plane | None
    rescale: tuple[float, float] | None
    rescale_type: str
    traits: tuple[str, ...]
    segment: int = 0


def read_dataset(file: Path, tags: Sequence[str] | None = None) -> tuple[Any, int]:
    """Return the header of a DICOM file and where its pixel data element begins.

    Parameters
    ----------
    file : Path
        Any file.
    tags : sequence of str or None
        Keywords of the attributes to keep; None keeps all.

    Returns
    -------
    dataset : pydicom.Dataset or None
        None if the file is not DICOM.
    offset : int
        In bytes from the beginning of the file.

    Raises
    ------
    VolumeReadError
        If it is DICOM with a damaged header.
    """
    import pydicom

    try:
        with quiet_pydicom(), file.open("rb") as stream:
            check_deflated(file, stream)
            dataset = pydicom.dcmread(
                stream, stop_before_pixels=True, specific_tags=None if tags is None else [*tags]
            )
            return dataset, stream.tell()
    except pydicom.errors.InvalidDicomError:
        return None, 0
    except (OSError, VolumeReadError):
        raise
    except Exception:
        # pydicom raises many kinds of error, and its texts may quote patient attributes.
        raise VolumeReadError(
            f"{file}: the DICOM header is damaged; copy or export the file again."
        ) from None


def header_from_dataset(file: Path, dataset: Any, raw: RawHeader, offset: int) -> FileHeader | None:
    """Return the facts about an image file, or None if the file holds no image."""
    rows, columns = integer_of(raw, "Rows"), integer_of(raw, "Columns")
    if not rows or not columns:
        return None
    preamble = RawHeader(dataset.file_meta)
    return FileHeader(
        path=file,
        storage_class=text_of(preamble, "MediaStorageSOPClassUID"),
        syntax=text_of(preamble, "TransferSyntaxUID"),
        pixel_offset=offset,
        instance_uid=text_of(raw, "SOPInstanceUID"),
        series_uid=text_of(raw, "SeriesInstanceUID"),
        series_number=integer_of(raw, "SeriesNumber"),
        description=text_of(raw, "SeriesDescription"),
        modality=text_of(raw, "Modality"),
        rows=rows,
        columns=columns,
        frames=integer_of(raw, "NumberOfFrames") or 1,
        pixels=_pixel_format(raw),
        unit=text_of(raw, "Units") or text_of(raw, "DoseUnits"),
        padding=_padding(raw),
        has_lookup_table=bool(value_of(raw, "ModalityLUTSequence")),
    )


def _pixel_format(dataset: Any) -> PixelFormat:
    allocated = integer_of(dataset, "BitsAllocated") or 16
    stored = integer_of(dataset, "BitsStored") or allocated
    return PixelFormat(
        allocated=allocated,
        stored=min(stored, allocated),
        signed=integer_of(dataset, "PixelRepresentation") == 1,
        samples=integer_of(dataset, "SamplesPerPixel") or 1,
        planar=integer_of(dataset, "PlanarConfiguration") == 1,
        photometric=text_of(dataset, "PhotometricInterpretation"),
    )


def _padding(dataset: Any) -> tuple[int, int] | None:
    first = integer_of(dataset, "PixelPaddingValue")
    if first is None:
        return None
    last = integer_of(dataset, "PixelPaddingRangeLimit")
    return first, first if last is None else last


def rescale_from(dataset: Any) -> tuple[float, float] | None:
    """Return rescale slope and intercept, or None where the dataset has none."""
    slope = floats_of(dataset, "RescaleSlope", 1)
    intercept = floats_of(dataset, "RescaleIntercept", 1)
    if not slope:
        # An RT dose has a factor of its own kind.
        slope, intercept = floats_of(dataset, "DoseGridScaling", 1), (0.0,)
    return (slope[0], intercept[0]) if slope and intercept else None


def storage_class(dataset: Any) -> str:
    """Return the kind of object that the file says it stores."""
    return text_of(RawHeader(dataset.file_meta), "MediaStorageSOPClassUID")
