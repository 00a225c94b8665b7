"""Unpack a zip archive where its names can do no harm and its size is known."""

from __future__ import annotations

import shutil
import tempfile
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from .errors import fail
from .source import amount, free_memory

if TYPE_CHECKING:
    from contextlib import ExitStack

    from .options import ReadOptions

HIGHEST_COUNT = 200_000
PIECE = 1 << 20
HIDDEN = ("__MACOSX", ".")


def unpacked(source: Path, options: ReadOptions, stack: ExitStack) -> Path:
    """Unpack a zip archive into a new folder that lasts as long as `stack`.

    Files get the names 000000, 000001 ... with their old endings, all in one folder, so that
    neither a path that leads elsewhere nor a link is followed.

    Raises
    ------
    VolumeReadError
        If the archive is damaged, encrypted, or would fill disk or memory.
    """
    place = stack.enter_context(tempfile.TemporaryDirectory(prefix="vtkmcvr-"))
    folder = Path(place)
    try:
        with zipfile.ZipFile(source) as archive:
            entries = [entry for entry in archive.infolist() if _is_wanted(entry)]
            _check(source, entries, folder)
            for number, entry in enumerate(entries):
                _unpack(archive, entry, folder / f"{number:06}{_ending(entry.filename)}")
                options.progress((number + 1) / len(entries), "unpacking")
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError):
        fail(source, "the zip archive is damaged, or packed in an unsupported way; pack it again")
    return folder


def _is_wanted(entry: zipfile.ZipInfo) -> bool:
    parts = PurePosixPath(entry.filename).parts
    return not entry.is_dir() and not any(part.startswith(HIDDEN) for part in parts if part != "..")


def _ending(name: str) -> str:
    suffixes = [suffix.lower() for suffix in PurePosixPath(name).suffixes[-2:]]
    known = {".nii", ".gz", ".nrrd", ".seg", ".mha", ".vti", ".vtk", ".npy", ".npz", ".slc",
             ".tif", ".tiff", ".dcm"}  # fmt: skip
    return "".join(suffix for suffix in suffixes if suffix in known)


def _check(source: Path, entries: list[zipfile.ZipInfo], folder: Path) -> None:
    if not entries:
        fail(source, "the zip archive holds no file; give one with DICOM slices")
    if any(entry.flag_bits & 1 for entry in entries):
        fail(source, "the zip archive is encrypted; unpack it first")
    if len(entries) > HIGHEST_COUNT:
        fail(source, f"the zip archive holds more than {HIGHEST_COUNT} files; unpack it first")
    size = sum(entry.file_size for entry in entries)
    free = min(shutil.disk_usage(folder).free, free_memory() or size)
    if size > free:
        fail(
            source,
            f"unpacking takes {amount(size)} and {amount(free)} are free; unpack what is needed "
            "elsewhere",
        )


def _unpack(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, target: Path) -> None:
    left = entry.file_size
    with archive.open(entry) as packed, target.open("xb") as file:
        # A wrong size in the directory must not lead to more than was checked.
        while left >= 0 and (piece := packed.read(PIECE)):
            left -= len(piece)
            file.write(piece)
    if left < 0:
        raise zipfile.BadZipFile
