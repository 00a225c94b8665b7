"""Read TIFF: one file with many pages, or a folder with one file per slice."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from .errors import VolumeReadError, fail
from .itk import open_with_itk
from .raw import NO_SPACING
from .source import VolumeSource

if TYPE_CHECKING:
    from pathlib import Path

    from .options import ReadOptions
    from .volume import LoadedVolume

SUFFIXES = (".tif", ".tiff")
MAGIC = {b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"}


def is_tiff(path: Path) -> bool:
    """Say whether a path is named like a TIFF file."""
    return path.suffix.lower() in SUFFIXES


def open_tiff(source: Path, options: ReadOptions) -> VolumeSource:
    """Judge a TIFF file with several pages, or a folder of files in the order of their numbers.

    Raises
    ------
    VolumeReadError
        If it is damaged or has one page.
    """
    files = _slices(source) if source.is_dir() else []
    if not all(map(_begins_as_tiff, files or [source])):
        fail(source, "not a TIFF file, or it is damaged; copy or export it again")
    try:
        opened = open_with_itk(source, "TIFFImageIO", "TIFF", options, files)
    except VolumeReadError as error:
        if "2-D image" in str(error):
            fail(source, "a 2-D image is not a volume; give the folder that holds all its slices")
        raise

    def load(index: int) -> LoadedVolume:
        volume = opened.load(index)
        # TIFF has a resolution in the plane only, and many programs write one without meaning.
        volume.spacing, volume.origin, volume.direction = np.ones(3), np.zeros(3), np.eye(3)
        if options.spacing is None:
            volume.notes.append(NO_SPACING)
        return volume

    return VolumeSource(opened.size, opened.memory, load, opened.times)


def _slices(folder: Path) -> list[Path]:
    files = sorted((file for file in folder.iterdir() if is_tiff(file)), key=_numbers)
    if len(files) < 2:
        fail(folder, "the folder holds one TIFF file, which is a 2-D image; give 2 or more slices")
    return files


def _begins_as_tiff(path: Path) -> bool:
    with path.open("rb") as stream:
        return stream.read(4) in MAGIC


def _numbers(path: Path) -> list[tuple[int, int, str]]:
    """Sort "slice2" before "slice10"."""
    parts = re.findall(r"(\d+)|(\D+)", path.name)
    return [(0, int(number), "") if number else (1, 0, text) for number, text in parts]
