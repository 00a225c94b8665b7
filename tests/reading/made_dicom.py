"""DICOM files made for the tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from made_volumes import ORIGIN, SECRET, VOXELS
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import CTImageStorage, EnhancedMRImageStorage, ExplicitVRLittleEndian, generate_uid

DEFAULTS = {
    "SOPClassUID": CTImageStorage,
    "SeriesInstanceUID": "1.2.3.4",
    "SeriesNumber": 4,
    "Modality": "CT",
    "PatientName": f"{SECRET}^NAME",
    "PatientID": SECRET,
    "SeriesDescription": f"Head of {SECRET}",
    "SamplesPerPixel": 1,
    "PhotometricInterpretation": "MONOCHROME2",
    "BitsAllocated": 16,
    "BitsStored": 16,
    "HighBit": 15,
    "PixelSpacing": [1.1, 0.7],
    "ImageOrientationPatient": [0.8, 0.6, 0.0, 0.0, 0.0, 1.0],
    "RescaleSlope": 1,
    "RescaleIntercept": 0,
}
# Normal of that orientation.
NORMAL = np.array([0.6, -0.8, 0.0])


def write_slice(path: Path, pixels: np.ndarray, position: object, **attributes: object) -> None:
    """Write one image file; an attribute given as None is left out."""
    own = {
        "SOPInstanceUID": generate_uid(),
        "Rows": pixels.shape[-2],
        "Columns": pixels.shape[-1],
        "PixelRepresentation": int(pixels.dtype.kind == "i"),
        "ImagePositionPatient": position,
    }
    dataset = Dataset()
    for tag, value in (DEFAULTS | own | attributes).items():
        if value is not None:
            setattr(dataset, tag, value)
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    dataset.PixelData = pixels.astype(pixels.dtype.newbyteorder("<")).tobytes()
    path.parent.mkdir(parents=True, exist_ok=True)
    dataset.save_as(path, enforce_file_format=True)


def positions(count: int, step: object = None) -> list[list[float]]:
    along = 2.5 * NORMAL if step is None else np.asarray(step)
    return [[round(float(x), 6) for x in np.array(ORIGIN) + k * along] for k in range(count)]


def write_series(
    folder: Path, pixels: np.ndarray = VOXELS, places: object = None, **attributes: object
) -> Path:
    """Write slices with file names that sort against their positions and have no extension."""
    places = positions(len(pixels)) if places is None else places
    for k, (plane, place) in enumerate(zip(pixels, places, strict=True)):
        own = {tag: value[k] for tag, value in attributes.items() if isinstance(value, tuple)}
        name = f"{attributes.get('SeriesNumber', 4)}-{99 - k}"
        write_slice(folder / name, plane, place, **{**attributes, **own})
    return folder


def frame_groups(place: object, rescale: tuple[float, float]) -> Dataset:
    position, values, frame = Dataset(), Dataset(), Dataset()
    position.ImagePositionPatient = place
    values.RescaleSlope, values.RescaleIntercept = rescale
    values.RescaleType = "US"
    frame.PlanePositionSequence = [position]
    frame.PixelValueTransformationSequence = [values]
    return frame


def shared_groups() -> Dataset:
    orientation, measures, shared = Dataset(), Dataset(), Dataset()
    orientation.ImageOrientationPatient = DEFAULTS["ImageOrientationPatient"]
    measures.PixelSpacing = DEFAULTS["PixelSpacing"]
    shared.PlaneOrientationSequence = [orientation]
    shared.PixelMeasuresSequence = [measures]
    return shared


def write_multiframe(
    path: Path,
    places: list[list[float]],
    rescales: object = None,
    pixels: np.ndarray = VOXELS,
    frames: int = 5,
) -> Path:
    """Write a file that says about its frames only what the functional groups hold."""
    rescales = [(2.0, 5.0)] * len(places) if rescales is None else rescales
    groups = [frame_groups(*pair) for pair in zip(places, rescales, strict=True)]
    elsewhere = ("PixelSpacing", "ImageOrientationPatient", "RescaleSlope", "RescaleIntercept")
    attributes = dict.fromkeys(elsewhere) | {
        "SOPClassUID": EnhancedMRImageStorage,
        "Modality": "MR",
        "NumberOfFrames": frames,
        "SharedFunctionalGroupsSequence": [shared_groups()],
        "PerFrameFunctionalGroupsSequence": groups,
    }
    write_slice(path, pixels, None, **attributes)
    return path
