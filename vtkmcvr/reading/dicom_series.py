"""Find the DICOM series to read in a folder and hand it to the right pixel reader."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING

from .dicom_folder import scan_folder
from .dicom_frames import read_multiframe
from .dicom_headers import header_from_dataset, read_dataset
from .dicom_slices import read_slices
from .errors import fail

if TYPE_CHECKING:
    from pathlib import Path

    from .dicom_folder import FolderScan
    from .dicom_headers import SliceHeader
    from .volume import LoadedVolume


def read_dicom(source: Path, series: str | int | None) -> LoadedVolume:
    """Read a DICOM folder or a multi-frame DICOM file.

    Parameters
    ----------
    source : Path
        Folder that directly holds the slices, or one file.
    series : str, int or None
        Series instance UID or series number; None picks the series with the most slices.

    Returns
    -------
    LoadedVolume
        Voxels after rescale, with the geometry of the headers in LPS and mm.

    Raises
    ------
    VolumeReadError
        If there is no such series, or it is not one regular volume.
    """
    return _read_folder(source, series) if source.is_dir() else _read_single(source, series)


def series_label(headers: list[SliceHeader]) -> str:
    """Name a series by its number and modality, without any patient attribute."""
    first = headers[0]
    number = "without number" if first.series_number is None else str(first.series_number)
    return f"series {number} ({first.modality or 'unknown modality'})"


def _read_single(source: Path, series: str | int | None) -> LoadedVolume:
    if series is not None:
        fail(source, "'series' is only for DICOM folders; leave it out for a single file")
    dataset = read_dataset(source)
    header = None if dataset is None else header_from_dataset(source, dataset)
    if header is None:
        fail(source, "a DICOM file without an image; give a folder of slices or a multi-frame file")
    if header.frames < 2:
        fail(source, "one DICOM slice is a 2-D image; give the folder that holds all its slices")
    return read_multiframe(header)


def _read_folder(folder: Path, series: str | int | None) -> LoadedVolume:
    scan = scan_folder(folder)
    if not scan.headers:
        fail(folder, _nothing_found(scan))
    groups = _group_by_series(scan.headers)
    chosen = max(groups, key=_slice_count) if series is None else _wanted(folder, groups, series)
    volume = _read_group(folder, chosen)
    volume.notes += scan.notes()
    others = [group for group in groups if group is not chosen]
    if others:
        listed = "; ".join(_describe(group) for group in others)
        volume.notes.append(f"{_describe(chosen)} read of {len(groups)} series; others: {listed}")
    return volume


def _nothing_found(scan: FolderScan) -> str:
    if scan.folders and not scan.not_dicom and not scan.not_images:
        return "the folder holds only subfolders; give the one with the DICOM slices"
    if not scan.not_dicom and not scan.not_images:
        return "the folder is empty; give one with DICOM slices"
    return (
        f"no DICOM image among its {scan.not_dicom + scan.not_images} files; "
        "give a folder with DICOM slices, or one file of another format"
    )


def _group_by_series(headers: list[SliceHeader]) -> list[list[SliceHeader]]:
    groups: dict[str, list[SliceHeader]] = defaultdict(list)
    for header in headers:
        groups[header.series_uid].append(header)
    return sorted(groups.values(), key=lambda group: group[0].series_number or 0)


def _slice_count(group: list[SliceHeader]) -> int:
    return sum(header.frames for header in group)


def _describe(group: list[SliceHeader]) -> str:
    sizes = Counter((header.rows, header.columns) for header in group)
    (rows, columns), _ = sizes.most_common(1)[0]
    return f"{series_label(group)}, {_slice_count(group)} slices of {rows} x {columns}"


def _wanted(folder: Path, groups: list[list[SliceHeader]], series: str | int) -> list[SliceHeader]:
    matches = [group for group in groups if series in (group[0].series_uid, group[0].series_number)]
    if len(matches) == 1:
        return matches[0]
    if matches:
        uids = ", ".join(group[0].series_uid for group in matches)
        fail(folder, f"{len(matches)} series have the number {series}; give one of the UIDs {uids}")
    fail(folder, f"no series {series!r}; allowed are {', '.join(_allowed(g) for g in groups)}")


def _allowed(group: list[SliceHeader]) -> str:
    first = group[0]
    key = repr(first.series_uid) if first.series_number is None else str(first.series_number)
    return f"{key} ({first.modality}, {_slice_count(group)} slices)"


def _read_group(folder: Path, group: list[SliceHeader]) -> LoadedVolume:
    label = f"{folder}: {series_label(group)}"
    multiframe = sum(header.frames > 1 for header in group)
    if multiframe == 1 and len(group) == 1:
        return read_multiframe(group[0])
    if multiframe:
        fail(folder, f"{series_label(group)} has {multiframe} multi-frame files; give one of them")
    if len(group) == 1:
        fail(folder, f"{series_label(group)} has one slice, which is a 2-D image; give 2 or more")
    sizes = Counter((header.rows, header.columns) for header in group)
    if len(sizes) > 1:
        found = ", ".join(f"{count} of {rows} x {cols}" for (rows, cols), count in sizes.items())
        fail(folder, f"{series_label(group)} has slices of different size ({found}); keep one size")
    return read_slices(group, label)
