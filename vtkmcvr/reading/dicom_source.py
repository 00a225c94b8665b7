"""One DICOM series as a volume: judged by its headers, then read."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .dicom_frames import frames_of
from .dicom_quiet import quiet_pydicom
from .dicom_seg import SEGMENTATION_CLASS, segmentation_source
from .dicom_stack import sort_volumes
from .dicom_suv import suv_factor
from .dicom_values import IDENTITY_RESCALE, check_rescale, read_values
from .errors import VolumeReadError, fail
from .resample import resample_slices
from .source import VolumeSource
from .volume import LoadedVolume

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from .dicom_headers import Frame
    from .dicom_stack import Volumes
    from .options import ReadOptions

FLOAT_BYTES = 4


def series_source(
    source: Path, group: Sequence[Frame], label: str, options: ReadOptions, noted: list[str]
) -> VolumeSource:
    """Judge one series by its headers.

    Parameters
    ----------
    source : Path
        What the caller gave, for errors.
    group : sequence of Frame
        The first slice of each of its files.
    label : str
        Its name in errors.
    options : ReadOptions
        What the caller wants.
    noted : list of str
        Notes of the search.

    Raises
    ------
    VolumeReadError
        If it is not one regular volume, or more than one on the same grid.
    """
    with _without_file_names(source, group):
        found = _judged(source, group, label, options, noted)

    def load(index: int) -> LoadedVolume:
        with _without_file_names(source, group):
            return found.load(index)

    return replace(found, load=load)


@contextlib.contextmanager
def _without_file_names(source: Path, group: Sequence[Frame]) -> Iterator[None]:
    """Name what the caller gave instead of a file in it, whose name may be a patient's."""
    try:
        yield
    except VolumeReadError as error:
        text = str(error)
        for frame in group:
            text = text.replace(str(frame.file.path), str(source))
        raise VolumeReadError(text) from None


def _judged(
    source: Path, group: Sequence[Frame], label: str, options: ReadOptions, noted: list[str]
) -> VolumeSource:
    first = group[0].file
    if first.storage_class in SEGMENTATION_CLASS:
        if len(group) > 1:
            fail(source, f"{label} has {len(group)} segmentation files; give one of them")
        return segmentation_source(first, options, noted)
    frames = _all_frames(group, noted)
    if first.frames == 1 and len(frames) == 1:
        fail(source, f"{label} has one slice, which is a 2-D image; give 2 or more")
    label = f"{source}: {label}"
    volumes = sort_volumes(frames, label, options)
    check_rescale(frames, label)
    size = (first.columns, first.rows, len(volumes.stacks[0]))

    @quiet_pydicom()
    def load(index: int) -> LoadedVolume:
        return _read_stack(volumes, index, label, options, noted)

    return VolumeSource(
        size=size,
        memory=int(np.prod(size, dtype=object)) * _bytes_per_voxel(frames),
        load=load,
        times=volumes.times,
        choose=volumes.differ,
    )


def _bytes_per_voxel(frames: Sequence[Frame]) -> int:
    """Return the stored bytes, and those of a float copy where values are no whole numbers."""
    pixels = frames[0].file.pixels
    stored = max(pixels.allocated // 8, 1) * pixels.samples
    whole = all((frame.rescale or IDENTITY_RESCALE)[0].is_integer() for frame in frames)
    return stored if whole else stored + FLOAT_BYTES


def _all_frames(group: Sequence[Frame], noted: list[str]) -> list[Frame]:
    frames: list[Frame] = []
    for frame in group:
        if frame.file.frames == 1:
            frames.append(frame)
        else:
            found, placed = frames_of(frame.file)
            frames += found
            noted += [note for note in placed if note not in noted]
    return frames


def _read_stack(
    volumes: Volumes, index: int, label: str, options: ReadOptions, noted: list[str]
) -> LoadedVolume:
    stack, geometry = volumes.stacks[index], volumes.geometry
    values, about = read_values(stack, label, options)
    volume = LoadedVolume(
        values=values,
        spacing=geometry.spacing,
        origin=geometry.origin,
        direction=geometry.direction,
        notes=["read as DICOM series", *about, *geometry.notes, *volumes.notes, *noted],
        modality=stack[0].file.modality,
    )
    if geometry.uneven is not None:
        _even_out(volume, geometry.uneven, geometry.direction)
    _describe(volume, stack)
    if options.units == "suv":
        _to_suv(volume, stack, label)
    return volume


def _even_out(volume: LoadedVolume, positions: Any, direction: Any) -> None:
    normal = np.cross(direction[:, 0], direction[:, 1])
    axes = np.column_stack([direction[:, :2], normal])
    before = len(volume.values)
    volume.values, ends = resample_slices(volume.values, positions, axes, volume.spacing[:2])
    step = float(np.linalg.norm(ends[1] - ends[0])) / (len(volume.values) - 1)
    volume.spacing = np.array([*volume.spacing[:2], step])
    volume.notes.append(
        f"{before} slices at uneven steps resampled to {len(volume.values)} with a step of "
        f"{step:.4g} mm"
    )


def _describe(volume: LoadedVolume, stack: Sequence[Frame]) -> None:
    """Note units and oddities of the values."""
    first = stack[0]
    header, rescale = first.file, first.rescale
    hounsfield = header.modality == "CT" and rescale is not None
    if hounsfield and first.rescale_type in {"", "HU"}:
        volume.units = "HU"
    elif hounsfield:
        volume.notes.append("the rescale type is not HU")
    if header.unit.upper() == "GY":
        volume.units = "Gy"
    if len({frame.rescale for frame in stack}) > 1:
        volume.notes.append(
            "rescale slope and intercept differ between slices and were applied to each"
        )
    elif rescale not in {None, IDENTITY_RESCALE}:
        assert rescale is not None
        volume.notes.append(f"rescaled: value = {rescale[0]:g} x stored + {rescale[1]:g}")
    oddities = (
        (header.unit, f"unit of the values: {header.unit}"),
        (header.pixels.photometric == "MONOCHROME1", "stored inverted (MONOCHROME1)"),
        (header.has_lookup_table, "a modality lookup table was not applied: values as stored"),
        (
            rescale is None and not header.pixels.signed and header.modality == "CT",
            "stored unsigned without rescale: the values may not be HU",
        ),
    )
    volume.notes += [text for present, text in oddities if present]


def _to_suv(volume: LoadedVolume, stack: Sequence[Frame], label: str) -> None:
    factor, problem = suv_factor(stack[0].file.path)
    if problem:
        raise VolumeReadError(f"{label}: units='suv' needs {problem}; leave out units to read it.")
    volume.values = volume.values * np.float32(factor)
    volume.units = "SUV"
    volume.notes.append("converted to standardised uptake values by body weight")
