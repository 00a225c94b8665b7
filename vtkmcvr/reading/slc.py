"""Read SLC, the volume format of VolVis: a text header, a preview picture, slices of bytes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import fail, header_errors
from .source import VolumeSource
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from .options import ReadOptions

MAGIC = b"11111"
NUMBERS = 12
HEAD = 1024
HIGHEST_RUN = 127


def open_slc(source: Path, options: ReadOptions) -> VolumeSource:
    """Judge a .slc file by its header.

    Raises
    ------
    VolumeReadError
        If the file is damaged or not of 8 bits.
    """
    with source.open("rb") as stream:
        head = stream.read(HEAD)
    with header_errors(source):
        size, spacing, packed, start = _header(source, head)
    check_dimension(source, size)
    voxels = size[0] * size[1] * size[2]
    held = source.stat().st_size * (HIGHEST_RUN if packed else 1)
    if voxels > held:
        fail(source, "truncated: voxels are missing at its end; copy or export the file again")

    def load(_: int) -> LoadedVolume:
        data = source.read_bytes()
        place = _after_preview(source, data, start)
        values = np.empty(size[::-1], np.uint8)
        for k in range(size[2]):
            place = _read_slice(source, data, place, packed, values[k])
            options.progress((k + 1) / size[2], "reading SLC")
        return LoadedVolume(
            values=values,
            spacing=np.array(spacing),
            origin=np.zeros(3),
            direction=np.eye(3),
            notes=["read as SLC", "no anatomical space in the file: its axes are taken as LPS"],
        )

    return VolumeSource(size=size, memory=voxels + source.stat().st_size, load=load)


def _header(source: Path, head: bytes) -> tuple[list[int], list[float], bool, int]:
    words = list(re.finditer(rb"\S+", head))[:NUMBERS]
    if not words or words[0][0] != MAGIC:
        fail(source, "not an SLC file (it does not begin with 11111); check the file")
    if len(words) < NUMBERS:
        raise ValueError("too few numbers")
    texts = [word[0] for word in words]
    size = [int(text) for text in texts[1:4]]
    if int(texts[4]) != 8:
        fail(source, "SLC with other than 8 bits per voxel is not supported; save it with 8")
    spacing = [float(text) for text in texts[5:8]]
    return size, spacing, int(texts[11]) == 1, words[-1].end()


def _after_preview(source: Path, data: bytes, start: int) -> int:
    """Return where the slices begin: behind 'WIDTH HEIGHT X' and a picture in three colours."""
    match = re.compile(rb"\s*(\d{1,6})\s+(\d{1,6})\s+X").match(data, start)
    if match is None:
        fail(source, "the SLC header is damaged; copy or export the file again")
    return match.end() + 3 * int(match[1]) * int(match[2])


def _read_slice(
    source: Path, data: bytes, place: int, packed: bool, target: NDArray[np.uint8]
) -> int:
    if not packed:
        end = place + target.size
        values = np.frombuffer(data[place:end], np.uint8)
    else:
        match = re.compile(rb"\s*(\d{1,9})\s+X").match(data, place)
        if match is None:
            fail(source, "a slice of the SLC data is damaged; copy or export the file again")
        end = match.end() + int(match[1])
        values = _unpacked(data[match.end() : end], target.size)
    if values.size != target.size:
        fail(source, "truncated: voxels are missing at its end; copy or export the file again")
    target[...] = values.reshape(target.shape)
    return end


def _unpacked(data: bytes, count: int) -> NDArray[np.uint8]:
    """Unpack runs: a count with its top bit set precedes so many bytes, else one to repeat."""
    parts: list[Any] = []
    place = total = 0
    while place < len(data) and total < count:
        length = data[place] & 127
        if not length:
            break
        plain = data[place] & 128
        piece = data[place + 1 : place + 1 + (length if plain else 1)]
        parts.append(piece if plain else piece * length)
        total += len(parts[-1])
        place += 1 + (length if plain else 1)
    return np.frombuffer(b"".join(parts), np.uint8)[:count]
