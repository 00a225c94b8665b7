"""Read TIFF: one file with many pages, or a folder with one file per slice."""

from __future__ import annotations

import re
import struct
import warnings
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .compact import compact_values
from .errors import VolumeReadError, fail
from .raw import NO_SPACING
from .source import VolumeSource
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from .options import ReadOptions

SUFFIXES = (".tif", ".tiff")
# Modes of Pillow whose pixels are values, with their bytes and components.
MODES = {
    "L": (1, 1), "RGB": (1, 3), "RGBA": (1, 4), "I;16": (2, 1), "I;16B": (2, 1), "I": (4, 1),
    "F": (4, 1), "1": (1, 1),
}  # fmt: skip
HIGHEST_COUNT = 1_000_000


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
    files = _slices(source) if source.is_dir() else [source]
    try:
        size, mode, count = _first_page(files[0])
    except Exception:
        fail(source, "not a TIFF file, or it is damaged; copy or export it again")
    if mode not in MODES:
        fail(source, f"TIFF with pixels of kind {mode} is not supported; save grey or RGB values")
    count = len(files) if len(files) > 1 else count
    if count < 2:
        fail(source, "a 2-D image is not a volume; give the folder that holds all its slices")
    check_dimension(source, (*size, count))
    width, components = MODES[mode]

    def load(_: int) -> LoadedVolume:
        shape = (count, size[1], size[0], *([components] if components > 1 else []))
        noted = ["read as TIFF"] + ([NO_SPACING] if options.spacing is None else [])
        # TIFF has a resolution in the plane only, and many programs write one without meaning.
        return LoadedVolume(
            values=compact_values(_read(source, files, shape, options), noted),
            spacing=np.ones(3),
            origin=np.zeros(3),
            direction=np.eye(3),
            notes=noted,
        )

    voxels = size[0] * size[1] * count
    return VolumeSource(size=(*size, count), memory=2 * voxels * width * components, load=load)


def _first_page(file: Path) -> tuple[tuple[int, int], str, int]:
    from PIL import Image

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with Image.open(file, formats=["TIFF"]) as image:
            return image.size, image.mode, _page_count(file)


def _page_count(file: Path) -> int:
    """Count the pages, and refuse a chain of them that does not end inside the file.

    Raises
    ------
    ValueError
        If the chain is broken. Pillow would give the pages before the break without a word.
    """
    with file.open("rb") as stream:
        head = stream.read(16)
        order: Literal["<", ">"] = "<" if head[:2] == b"II" else ">"
        big = head[2:3] == b"+" or head[3:4] == b"+"
        entries, offset, entry = ("Q", "Q", 20) if big else ("H", "I", 12)
        place = struct.unpack_from(order + offset, head, 8 if big else 4)[0]
        seen: set[int] = set()
        while place and len(seen) < HIGHEST_COUNT:
            if place in seen:
                raise ValueError("the pages are a circle")
            seen.add(place)
            stream.seek(place)
            count = struct.unpack(order + entries, stream.read(struct.calcsize(entries)))[0]
            stream.seek(count * entry, 1)
            place = struct.unpack(order + offset, stream.read(struct.calcsize(offset)))[0]
        return len(seen)


def _read(
    source: Path, files: list[Path], shape: tuple[int, ...], options: ReadOptions
) -> NDArray[Any]:
    values: NDArray[Any] | None = None
    done = 0
    try:
        for k, page in enumerate(_pages(files)):
            if values is None:
                values = np.empty(shape, page.dtype)
            if page.shape != shape[1:] or page.dtype != values.dtype:
                fail(source, f"page {k + 1} has another size or type than the first; save it again")
            values[k] = page
            done = k + 1
            options.progress(done / len(values), "reading TIFF")
    except VolumeReadError:
        raise
    except Exception:
        # Pillow raises many kinds of error for damaged data.
        fail(source, "damaged or truncated TIFF data; copy or export it again")
    if values is None or done < len(values):
        fail(source, "truncated: pages are missing at its end; copy or export it again")
    return values


def _pages(files: list[Path]) -> Iterator[NDArray[Any]]:
    from PIL import Image, ImageSequence

    for file in files:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with Image.open(file, formats=["TIFF"]) as image:
                pages = ImageSequence.Iterator(image) if len(files) == 1 else [image]
                for page in pages:
                    yield np.asarray(page)


def _slices(folder: Path) -> list[Path]:
    return sorted((file for file in folder.iterdir() if is_tiff(file)), key=_numbers)


def _numbers(path: Path) -> list[tuple[int, int, str]]:
    """Sort "slice2" before "slice10"."""
    parts = re.findall(r"(\d+)|(\D+)", path.name)
    return [(0, int(number), "") if number else (1, 0, text) for number, text in parts]
