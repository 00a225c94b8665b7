"""Decode the frames of one multi-frame DICOM file, placed by their functional groups."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .dicom_geometry import Plane, judge_stack
from .dicom_headers import plane_from, read_dataset, rescale_from, value_of
from .dicom_values import check_rescale, describe_values, place_volume
from .errors import VolumeReadError, fail
from .itk import read_with_itk

if TYPE_CHECKING:
    from .dicom_headers import SliceHeader
    from .volume import LoadedVolume

SAVE_ONE = "save one volume, time point or segment of it as a file of its own"


def read_multiframe(header: SliceHeader) -> LoadedVolume:
    """Read a multi-frame file, placing its frames by their functional groups.

    Raises
    ------
    VolumeReadError
        If the frames are not one regular stack, or their pixels cannot be decoded.
    """
    dataset = read_dataset(header.path, tags=None)
    label = f"{header.path}: multi-frame file"
    _check_frame_rescale(dataset, label)
    planes = _frame_planes(dataset)
    if planes and len(planes) != header.frames:
        fail(header.path, "the header places another number of frames than it has; export it again")
    geometry = judge_stack(planes, label, remedy=SAVE_ONE) if planes else None
    volume = read_with_itk(header.path, "GDCMImageIO", "multi-frame DICOM")
    if len(volume.values) != header.frames:
        fail(header.path, "the decoded frames do not fit the header; export the file again")
    if geometry is None:
        volume.notes.append("the file gives no place for its frames: SimpleITK's guess is kept")
    else:
        volume.values = volume.values[geometry.order]
        volume = place_volume(volume, geometry)
    if header.pixel_format[0] == 1:
        volume.values = (volume.values > 0).astype(np.uint8)
    return describe_values(volume, [header], _first_transform(dataset))


def _frame_planes(dataset: Any) -> list[Plane]:
    """Return the plane of each frame, or nothing if any frame lacks one."""
    planes = [
        plane_from(
            _group(dataset, frame, "PlanePositionSequence"),
            _group(dataset, frame, "PlaneOrientationSequence"),
            _group(dataset, frame, "PixelMeasuresSequence"),
        )
        for frame in value_of(dataset, "PerFrameFunctionalGroupsSequence") or []
    ]
    known = [plane for plane in planes if plane is not None]
    return known if len(known) == len(planes) else []


def _group(dataset: Any, frame: Any, name: str) -> Any:
    """Return the functional group of one frame, which may be shared by all frames."""
    shared = value_of(dataset, "SharedFunctionalGroupsSequence") or []
    for holder in (frame, *shared):
        items = value_of(holder, name)
        if items:
            return items[0]
    return None


def _transforms(dataset: Any) -> list[Any]:
    frames = value_of(dataset, "PerFrameFunctionalGroupsSequence") or []
    found = [_group(dataset, frame, "PixelValueTransformationSequence") for frame in frames]
    return [item for item in found if item is not None]


def _first_transform(dataset: Any) -> Any:
    return next(iter(_transforms(dataset)), None)


def _check_frame_rescale(dataset: Any, label: str) -> None:
    rescales = [rescale_from(item) for item in _transforms(dataset)]
    check_rescale(rescales, label)
    if len(set(rescales)) > 1:
        raise VolumeReadError(
            f"{label}: the rescale slope or intercept differs between the frames, which is not "
            "supported; export it as single slices."
        )
