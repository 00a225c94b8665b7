"""Find the DICOM images of a folder or a DICOMDIR, and count what else lies there."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .dicom_frames import image_of
from .dicom_headers import HEADER_TAGS, read_dataset, storage_class
from .dicom_tags import items_of, text_of, value_of
from .errors import VolumeReadError, fail

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .dicom_headers import FileHeader, Frame
    from .options import ReadOptions

DICOMDIR_CLASS = "1.2.840.10008.1.3.10"


@dataclass
class Scan:
    """The DICOM images found, each with its first slice, and how much else there was."""

    images: list[Frame] = field(default_factory=list)
    other_files: int = 0
    not_images: int = 0
    copies: int = 0
    damaged: int = 0
    missing: int = 0

    def notes(self) -> list[str]:
        """Say what was skipped."""
        counts = (
            (self.other_files, "files that are not DICOM skipped"),
            (self.not_images, "DICOM files without an image skipped"),
            (self.copies, "copies of the same slice skipped"),
            (self.damaged, "damaged DICOM files left out"),
            (self.missing, "files that the DICOMDIR names are missing"),
        )
        return [f"{count} {what}" for count, what in counts if count]


def scan_folder(folder: Path, options: ReadOptions) -> Scan:
    """Read the header of every DICOM image in `folder` and the folders below it.

    Raises
    ------
    VolumeReadError
        If a DICOM file has a damaged header.
    """
    return _scan(folder, list(_files_below(folder)), options)


def scan_directory_file(source: Path, options: ReadOptions) -> Scan:
    """Read the header of every image that a DICOMDIR names.

    Raises
    ------
    VolumeReadError
        If it names files outside its folder, or a file has a damaged header.
    """
    dataset, _ = read_dataset(source)
    names = [
        value_of(record, "ReferencedFileID")
        for record in items_of(dataset, "DirectoryRecordSequence")
    ]
    found = [_below(source, name) for name in names if name]
    scan = _scan(source.parent, [path for path in found if path is not None], options)
    scan.missing = found.count(None)
    if scan.missing and not scan.images:
        fail(source, "none of the files it names is there; copy the whole disc, not only DICOMDIR")
    return scan


def is_directory_file(dataset: Any) -> bool:
    """Say whether a DICOM dataset is a DICOMDIR."""
    return storage_class(dataset) == DICOMDIR_CLASS


def _below(source: Path, name: Any) -> Path | None:
    parts = [name] if isinstance(name, str) else [str(part) for part in name]
    place = source.parent
    for part in parts:
        if part in ("", ".", "..") or "/" in part or "\\" in part or "\0" in part:
            fail(source, "it names a file outside its folder, which is not allowed; do not use it")
        choices = (part, part.lower(), part.upper())
        place = next((place / p for p in choices if (place / p).exists()), place / part)
    return place if place.is_file() else None


def _files_below(folder: Path) -> Iterator[Path]:
    """Yield files in name order; each folder is entered once, even where links make a circle."""
    seen: set[tuple[int, int]] = set()
    for place, folders, files in os.walk(folder, followlinks=True):
        status = os.stat(place)
        key = status.st_dev, status.st_ino
        if key in seen:
            folders.clear()
            continue
        seen.add(key)
        folders.sort()
        yield from (Path(place) / name for name in sorted(files))


def _scan(folder: Path, files: list[Path], options: ReadOptions) -> Scan:
    scan = Scan()
    found: list[tuple[int, Any, Frame | None]] = []
    for index, file in enumerate(files):
        try:
            dataset, offset = read_dataset(file, HEADER_TAGS) if file.is_file() else (None, 0)
        except VolumeReadError:
            _damaged(scan, folder, index, len(files), options)
            continue
        if dataset is None:
            scan.other_files += 1
        else:
            found.append((index, dataset, image_of(file, dataset, offset)))
        if index % 50 == 0:
            options.progress(index / len(files), "reading DICOM headers")
    _check_image_files(scan, folder, found, len(files), options)
    scan.images = _without_copies([frame for _, _, frame in found if frame is not None])
    scan.copies = sum(frame is not None for _, _, frame in found) - len(scan.images)
    return scan


def _damaged(scan: Scan, folder: Path, index: int, count: int, options: ReadOptions) -> None:
    if "damaged" in options.ignore:
        scan.damaged += 1
        return
    # The file is named by its place, because file names may hold patient names.
    raise VolumeReadError(
        f"{folder}: file {index + 1} of {count} in name order has a damaged DICOM header; "
        "copy or export the series again, or give ignore='damaged' to leave it out."
    ) from None


def _check_image_files(
    scan: Scan, folder: Path, found: Sequence[tuple[int, Any, Frame | None]], count: int,
    options: ReadOptions,
) -> None:  # fmt: skip
    """Refuse headers cut off before the image size, which would be slices lost in silence."""
    image_classes = {frame.file.storage_class for _, _, frame in found if frame is not None}
    for index, dataset, frame in found:
        if frame is not None:
            continue
        kind = storage_class(dataset)
        nameless = not text_of(dataset, "SeriesInstanceUID") and kind != DICOMDIR_CLASS
        if nameless or kind in image_classes:
            _damaged(scan, folder, index, count, options)
        else:
            scan.not_images += 1


def _without_copies(frames: list[Frame]) -> list[Frame]:
    unique = {_identity(frame.file): frame for frame in reversed(frames)}
    return list(reversed(unique.values()))


def _identity(header: FileHeader) -> str:
    return header.instance_uid or str(header.path)
