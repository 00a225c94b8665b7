"""Find the DICOM images of a folder, and count what else lies there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from .dicom_headers import header_from_dataset, read_dataset, storage_class, text_of
from .errors import VolumeReadError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from .dicom_headers import SliceHeader

DICOMDIR_CLASS = "1.2.840.10008.1.3.10"


@dataclass(frozen=True)
class FolderScan:
    """The DICOM images found directly in a folder, and how much else lay there."""

    headers: list[SliceHeader]
    not_dicom: int
    not_images: int
    copies: int
    folders: int

    def notes(self) -> list[str]:
        """Say what was skipped."""
        counts = (
            (self.not_dicom, "files that are not DICOM skipped"),
            (self.not_images, "DICOM files without an image skipped"),
            (self.copies, "copies of the same slice skipped"),
            (self.folders, "subfolders not searched"),
        )
        return [f"{count} {what}" for count, what in counts if count]


def scan_folder(folder: Path) -> FolderScan:
    """Read the header of every DICOM image that lies directly in `folder`.

    Raises
    ------
    VolumeReadError
        If a DICOM file has a damaged header.
    """
    entries = sorted(folder.iterdir())
    files = [entry for entry in entries if entry.is_file()]
    datasets = [_read_listed(folder, files, index) for index in range(len(files))]
    found = [
        None if dataset is None else header_from_dataset(file, dataset)
        for file, dataset in zip(files, datasets, strict=True)
    ]
    images = [header for header in found if header is not None]
    _check_image_files(folder, datasets, found)
    unique = _without_copies(images)
    return FolderScan(
        headers=unique,
        not_dicom=datasets.count(None),
        not_images=len(files) - datasets.count(None) - len(images),
        copies=len(images) - len(unique),
        folders=sum(entry.is_dir() for entry in entries),
    )


def _read_listed(folder: Path, files: list[Path], index: int) -> Any:
    try:
        return read_dataset(files[index])
    except VolumeReadError:
        raise VolumeReadError(_damaged_file(folder, index, len(files))) from None


def _damaged_file(folder: Path, index: int, count: int) -> str:
    # The file is named by its place, because file names may hold patient names.
    return (
        f"{folder}: file {index + 1} of {count} in name order has a damaged DICOM header; "
        "copy or export the series again."
    )


def _check_image_files(
    folder: Path, datasets: Sequence[Any], found: Sequence[SliceHeader | None]
) -> None:
    """Refuse headers cut off before the image size, which would be slices lost in silence."""
    image_classes = {header.storage_class for header in found if header is not None}
    for index, (dataset, header) in enumerate(zip(datasets, found, strict=True)):
        if dataset is None or header is not None:
            continue
        kind = storage_class(dataset)
        nameless = not text_of(dataset, "SeriesInstanceUID") and kind != DICOMDIR_CLASS
        if nameless or kind in image_classes:
            raise VolumeReadError(_damaged_file(folder, index, len(datasets)))


def _without_copies(headers: list[SliceHeader]) -> list[SliceHeader]:
    unique = {(h.instance_uid or str(h.path)): h for h in reversed(headers)}
    return list(reversed(unique.values()))
