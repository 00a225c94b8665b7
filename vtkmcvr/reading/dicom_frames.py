"""The slices of a DICOM file, placed by its header or by its functional groups."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .dicom_geometry import Plane
from .dicom_headers import TRAITS, Frame, header_from_dataset, read_dataset, rescale_from
from .dicom_tags import RawHeader, floats_of, integer_of, items_of, plane_from, text_of
from .errors import fail

if TYPE_CHECKING:
    from pathlib import Path

    from .dicom_headers import FileHeader

# A frame of one bit per pixel and few pixels takes no less, in bytes.
SMALLEST_FRAME = 1
GUESSED = "the file gives no place for its frames: steps of {:g} mm along LPS axes are assumed"
TRAIT_GROUPS = {
    "image type": ("MRImageFrameTypeSequence", "CTImageFrameTypeSequence", "PETFrameTypeSequence"),
    "echo time": ("MREchoSequence",),
    "b-value": ("MRDiffusionSequence",),
    "temporal position": ("FrameContentSequence",),
    "trigger time": ("CardiacSynchronizationSequence",),
}


def single_frame(header: FileHeader, dataset: Any) -> Frame:
    """Return the one slice of a file."""
    return Frame(
        file=header,
        index=0,
        plane=plane_from(dataset, dataset, dataset),
        rescale=rescale_from(dataset),
        rescale_type=text_of(dataset, "RescaleType"),
        traits=tuple(text_of(dataset, tag) for tag, _ in TRAITS.values()),
    )


def image_of(file: Path, dataset: Any, offset: int) -> Frame | None:
    """Return the first slice of a file that was just read, or None if it holds no image."""
    raw = RawHeader(dataset)
    header = header_from_dataset(file, dataset, raw, offset)
    return None if header is None else single_frame(header, raw)


def frames_of(header: FileHeader) -> tuple[list[Frame], list[str]]:
    """Return the slices of a multi-frame file, and notes about their place.

    Raises
    ------
    VolumeReadError
        If the header places another number of frames than it has.
    """
    if header.frames * SMALLEST_FRAME > header.path.stat().st_size:
        fail(header.path, f"the header promises {header.frames} frames, for which the file is too "
             "short; copy or export it again")  # fmt: skip
    dataset, _ = read_dataset(header.path)
    groups = items_of(dataset, "PerFrameFunctionalGroupsSequence")
    if groups and len(groups) != header.frames:
        fail(header.path, "the header places another number of frames than it has; export it again")
    shared = items_of(dataset, "SharedFunctionalGroupsSequence")
    usual = single_frame(header, dataset)
    frames = [_grouped(usual, k, _Groups(group, shared)) for k, group in enumerate(groups)]
    if not frames:
        frames = [replace(usual, index=k) for k in range(header.frames)]
    if groups and all(frame.plane is not None for frame in frames):
        return frames, []
    return _placed(frames, dataset)


class _Groups:
    """The functional groups of one frame, which may be shared by all frames."""

    def __init__(self, frame: Any, shared: list[Any]):
        self.holders = (frame, *shared)

    def first(self, name: str) -> Any:
        """Return the named group, or None."""
        for holder in self.holders:
            items = items_of(holder, name)
            if items:
                return items[0]
        return None


def _grouped(usual: Frame, index: int, groups: _Groups) -> Frame:
    transform = groups.first("PixelValueTransformationSequence")
    plane = plane_from(
        groups.first("PlanePositionSequence"),
        groups.first("PlaneOrientationSequence"),
        groups.first("PixelMeasuresSequence"),
    )
    segment = groups.first("SegmentIdentificationSequence")
    return replace(
        usual,
        index=index,
        plane=plane,
        rescale=usual.rescale if transform is None else rescale_from(transform),
        rescale_type=usual.rescale_type if transform is None else text_of(transform, "RescaleType"),
        traits=tuple(
            _trait(groups, name, tag) or before
            for (name, (_, tag)), before in zip(TRAITS.items(), usual.traits, strict=True)
        ),
        segment=integer_of(segment, "ReferencedSegmentNumber") or 0,
    )


def _trait(groups: _Groups, name: str, tag: str) -> str:
    found = (text_of(groups.first(group), tag) for group in TRAIT_GROUPS.get(name, ()))
    return next(filter(None, found), "")


# Files without functional groups


def _placed(frames: list[Frame], dataset: Any) -> tuple[list[Frame], list[str]]:
    """Place frames by the grid of an RT dose, by the detector of a SPECT, or by a noted guess."""
    detector = next(iter(items_of(dataset, "DetectorInformationSequence")), None)
    first = plane_from(dataset, dataset, dataset) or plane_from(detector, detector, dataset)
    offsets = floats_of(dataset, "GridFrameOffsetVector", 0)
    step = _step(dataset)
    if len(offsets) != len(frames):
        offsets = tuple(step * k for k in range(len(frames)))
        noted = [] if first is not None and detector is not None else [GUESSED.format(step)]
    else:
        noted = []
    if first is None:
        spacing = floats_of(dataset, "PixelSpacing", 2) or (1.0, 1.0)
        first = Plane((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0), spacing)
    elif offsets[0] != 0.0:
        # Offsets that do not begin at 0 are positions along the patient's axis.
        offsets = tuple(offset - offsets[0] for offset in offsets)
    return [_moved(frame, first, z) for frame, z in zip(frames, offsets, strict=True)], noted


def _step(dataset: Any) -> float:
    for tag in ("SpacingBetweenSlices", "SliceThickness"):
        step = floats_of(dataset, tag, 1)
        if step and step[0] > 0.0:
            return step[0]
    return 1.0


def _moved(frame: Frame, first: Plane, along: float) -> Frame:
    columns, rows = np.reshape(first.orientation, (2, 3))
    position = np.array(first.position) + along * np.cross(columns, rows)
    return replace(frame, plane=replace(first, position=tuple(float(x) for x in position)))
