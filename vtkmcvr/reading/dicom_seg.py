"""DICOM segmentations: sparse frames of bits become one label map with names and colours."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..recorded_facts import Segment
from .colours import rgb_of_dicom_lab, spread_colour
from .dicom_frames import frames_of
from .dicom_geometry import SAME_POSITION_MM, heights_of, plane_axes
from .dicom_headers import read_dataset
from .dicom_pixels import read_frames
from .dicom_quiet import quiet_pydicom
from .dicom_tags import floats_of, integer_of, items_of, text_of
from .errors import fail
from .source import VolumeSource
from .volume import LoadedVolume

if TYPE_CHECKING:
    from .dicom_headers import FileHeader, Frame
    from .options import ReadOptions

BITS_CLASS = "1.2.840.10008.5.1.4.1.1.66.4"
LABEL_MAP_CLASS = "1.2.840.10008.5.1.4.1.1.66.7"
SEGMENTATION_CLASS = {BITS_CLASS, LABEL_MAP_CLASS}
GRID_TOLERANCE = 0.02


def segmentation_source(header: FileHeader, options: ReadOptions, noted: list[str]) -> VolumeSource:
    """Judge a segmentation file by its header.

    Raises
    ------
    VolumeReadError
        If its frames have no place, or do not lie on one grid.
    """
    frames, _ = frames_of(header)
    dataset, _ = read_dataset(header.path)
    if not items_of(dataset, "PerFrameFunctionalGroupsSequence"):
        fail(header.path, "the segmentation gives no place for its frames; export it again")
    grid = _Grid(frames, _slice_step(dataset), header)

    @quiet_pydicom()
    def load(index: int) -> LoadedVolume:
        return _read(header, frames, grid, dataset, options, noted)

    size = (header.columns, header.rows, grid.count)
    voxels = int(np.prod(size, dtype=object))
    return VolumeSource(size=size, memory=2 * voxels, load=load)


class _Grid:
    """Even slices on which all frames of a segmentation lie."""

    def __init__(self, frames: list[Frame], step: float | None, header: FileHeader):
        planes = [frame.plane for frame in frames if frame.plane is not None]
        if len(planes) < len(frames):
            fail(header.path, "the segmentation gives no place for its frames; export it again")
        rows, columns = plane_axes(planes, str(header.path))
        self.axes = np.column_stack([columns, rows, np.cross(columns, rows)])
        heights = heights_of(planes)
        steps = np.diff(np.unique(np.round(heights, 3)))
        steps = steps[steps > SAME_POSITION_MM]
        self.step = float(step or (steps.min() if len(steps) else 1.0))
        places = (heights - heights.min()) / self.step
        if len(steps) and np.abs(places - np.rint(places)).max() > GRID_TOLERANCE:
            self.step = float(steps.min())
            places = (heights - heights.min()) / self.step
        off = np.abs(places - np.rint(places)).max()
        if off > GRID_TOLERANCE:
            fail(
                header.path,
                f"the frames of the segmentation do not lie at even steps of {self.step:.4g} mm "
                f"(one is {off * self.step:.4g} mm off); export it again on the grid of its images",
            )
        self.spacing = planes[0].pixel_spacing
        self.places = np.rint(places).astype(int)
        self.count = int(self.places.max()) + 1
        lowest = planes[int(heights.argmin())]
        self.origin = np.array(lowest.position)
        if self.count == 1:
            # A lone slice gets an empty one on each side, so that it is a volume.
            self.places, self.count = self.places + 1, 3
            self.origin = self.origin - self.step * self.axes[:, 2]


def _slice_step(dataset: Any) -> float | None:
    shared = next(iter(items_of(dataset, "SharedFunctionalGroupsSequence")), None)
    measures = next(iter(items_of(shared, "PixelMeasuresSequence")), None)
    for tag in ("SpacingBetweenSlices", "SliceThickness"):
        step = floats_of(measures, tag, 1)
        if step and step[0] > 0:
            return step[0]
    return None


def _read(
    header: FileHeader, frames: list[Frame], grid: _Grid, dataset: Any, options: ReadOptions,
    noted: list[str],
) -> LoadedVolume:  # fmt: skip
    segments = _segments(dataset)
    highest = max([s.value for s in segments] + [frame.segment for frame in frames] + [0])
    kind = np.uint8 if highest < 256 else np.uint16
    values = np.zeros((grid.count, header.rows, header.columns), kind)
    half = (integer_of(dataset, "MaximumFractionalValue") or 1) / 2
    planes: list[Any] = [None] * len(frames)
    read_frames(frames, f"{header.path}: segmentation", options, planes.__setitem__)
    overlapping = 0
    for frame, place, plane in zip(frames, grid.places, planes, strict=True):
        if header.storage_class == LABEL_MAP_CLASS:
            covered, label = plane > 0, plane
        else:
            covered = plane > 0 if header.pixels.allocated == 1 else plane >= half
            label = np.full(plane.shape, frame.segment)
        overlapping += int(np.count_nonzero(values[place][covered]))
        values[place][covered] = label[covered]
    about = ["read as DICOM segmentation", *noted]
    if header.pixels.allocated != 1 and header.storage_class == BITS_CLASS:
        about.append("fractions of one half and more count as inside a segment")
    if overlapping:
        about.append(f"segments overlap in {overlapping} voxels, which belong to the later one")
    return LoadedVolume(
        values=values,
        spacing=np.array([grid.spacing[1], grid.spacing[0], grid.step]),
        origin=grid.origin,
        direction=grid.axes,
        notes=about,
        modality="SEG",
        segments=segments,
    )


def _segments(dataset: Any) -> list[Segment]:
    found = []
    for item in items_of(dataset, "SegmentSequence"):
        value = integer_of(item, "SegmentNumber") or 0
        lab = floats_of(item, "RecommendedDisplayCIELabValue", 3)
        colour = rgb_of_dicom_lab(lab) if lab else spread_colour(value)
        found.append(Segment(value, text_of(item, "SegmentLabel") or str(value), colour))
    return found
