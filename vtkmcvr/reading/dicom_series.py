"""Find the DICOM series to read in a folder, a file or a DICOMDIR."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from .dicom_folder import Scan, is_directory_file, scan_directory_file, scan_folder
from .dicom_frames import image_of
from .dicom_headers import HEADER_TAGS, read_dataset
from .dicom_quiet import quiet_pydicom
from .dicom_source import series_source
from .errors import fail

if TYPE_CHECKING:
    from pathlib import Path

    from .dicom_headers import Frame
    from .options import ReadOptions
    from .source import VolumeSource


@dataclass(frozen=True)
class SeriesInfo:
    """One DICOM series that can be chosen.

    Attributes
    ----------
    number : int or None
        Series number.
    modality : str
        Such as "CT".
    slices : int
        Slices or frames in all.
    rows, columns : int
        Size of most of them.
    uid : str
        Series instance UID.
    description : str
        Free text of the scanner's operator. It may name the patient, so no error, note or
        recipe quotes it, and `repr` leaves it out.
    """

    number: int | None
    modality: str
    slices: int
    rows: int
    columns: int
    uid: str
    description: str = field(repr=False)


@quiet_pydicom()
def open_dicom(source: Path, options: ReadOptions) -> VolumeSource:
    """Find the volume in a DICOM folder, file or DICOMDIR.

    A file that holds one slice stands for its series in its folder.

    Raises
    ------
    VolumeReadError
        If there is no such series, or it is not one regular volume.
    """
    scan, chosen = _scanned(source, options)
    groups = _by_series(scan.images)
    if not groups:
        fail(source, _nothing_found(scan, source.is_dir()))
    series = options.series if chosen is None else chosen
    group = max(groups, key=_slices) if series is None else _wanted(source, groups, series)
    noted = scan.notes()
    others = [other for other in groups if other is not group]
    if others and chosen is None:
        listed = "; ".join(map(_describe, others))
        noted.append(f"{_describe(group)} read of {len(groups)} series; others: {listed}")
    return series_source(source, group, _label(group), options, noted)


@quiet_pydicom()
def list_dicom(source: Path, options: ReadOptions) -> list[SeriesInfo]:
    """Return the series that `open_dicom` can choose from, by their numbers."""
    scan = _scan_place(source, options)
    return [_info(group) for group in _by_series(scan.images)]


def _scanned(source: Path, options: ReadOptions) -> tuple[Scan, str | None]:
    """Return what was found, and the UID of the series that the file belongs to."""
    if source.is_dir():
        return scan_folder(source, options), None
    dataset, offset = read_dataset(source, HEADER_TAGS)
    if dataset is not None and is_directory_file(dataset):
        return scan_directory_file(source, options), None
    first = None if dataset is None else image_of(source, dataset, offset)
    if first is None:
        fail(source, "a DICOM file without an image; give a folder of slices or a multi-frame file")
    if options.series is not None:
        fail(source, "'series' is only for DICOM folders; leave it out for a single file")
    if first.file.frames > 1 or not first.file.series_uid:
        return Scan(images=[first]), None
    return scan_folder(source.parent, options), first.file.series_uid


def _scan_place(source: Path, options: ReadOptions) -> Scan:
    if source.is_dir():
        return scan_folder(source, options)
    dataset, _ = read_dataset(source, HEADER_TAGS)
    if dataset is not None and is_directory_file(dataset):
        return scan_directory_file(source, options)
    return _scanned(source, options)[0]


def _nothing_found(scan: Scan, folder: bool) -> str:
    files = scan.other_files + scan.not_images + scan.damaged
    if not files:
        return "the folder is empty; give one with DICOM slices"
    where = f"its {files} files" if folder else f"the {files} files it names"
    return (
        f"no DICOM image among {where}; give a folder with DICOM slices, or one file of another "
        "format"
    )


def _by_series(frames: list[Frame]) -> list[list[Frame]]:
    groups: dict[str, list[Frame]] = defaultdict(list)
    for frame in frames:
        groups[frame.file.series_uid].append(frame)
    return sorted(groups.values(), key=lambda group: group[0].file.series_number or 0)


def _slices(group: list[Frame]) -> int:
    return sum(frame.file.frames for frame in group)


def _info(group: list[Frame]) -> SeriesInfo:
    first = group[0].file
    (rows, columns), _ = Counter((f.file.rows, f.file.columns) for f in group).most_common(1)[0]
    return SeriesInfo(
        number=first.series_number,
        modality=first.modality,
        slices=_slices(group),
        rows=rows,
        columns=columns,
        uid=first.series_uid,
        description=first.description,
    )


def _label(group: list[Frame]) -> str:
    """Name a series by its number and modality, without any patient attribute."""
    first = group[0].file
    number = "without number" if first.series_number is None else str(first.series_number)
    return f"series {number} ({first.modality or 'unknown modality'})"


def _describe(group: list[Frame]) -> str:
    info = _info(group)
    return f"{_label(group)}, {info.slices} slices of {info.rows} x {info.columns}"


def _wanted(source: Path, groups: list[list[Frame]], series: str | int) -> list[Frame]:
    matches = [g for g in groups if series in (g[0].file.series_uid, g[0].file.series_number)]
    if not matches and isinstance(series, str) and series.strip():
        text = series.strip().lower()
        matches = [group for group in groups if text in group[0].file.description.lower()]
    if len(matches) == 1:
        return matches[0]
    if matches:
        uids = ", ".join(group[0].file.series_uid for group in matches)
        what = "the number" if isinstance(series, int) else "a description with"
        fail(source, f"{len(matches)} series have {what} {series}; give one of the UIDs {uids}")
    fail(source, f"no series {series!r}; allowed are {', '.join(_allowed(g) for g in groups)}")


def _allowed(group: list[Frame]) -> str:
    first = group[0].file
    key = repr(first.series_uid) if first.series_number is None else str(first.series_number)
    return f"{key} ({first.modality}, {_slices(group)} slices)"
