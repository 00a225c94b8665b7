"""Check the sizes of packed blocks in a VTK XML file, which VTK allocates as they are given."""

from __future__ import annotations

import base64
import mmap
import re
import struct
from typing import TYPE_CHECKING

from .errors import fail

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

HEAD = 1 << 16
INLINE = re.compile(rb'format="binary"[^>]*>\s*([A-Za-z0-9+/=]{8,44})')
OFFSET = re.compile(rb'offset="(\d{1,18})"')
APPENDED = re.compile(rb'<AppendedData[^>]*encoding="(raw|base64)"[^>]*>\s*_')


def check_blocks(source: Path, promised: int) -> None:
    """Refuse packed arrays with more or larger blocks than the image and the file have room for.

    Parameters
    ----------
    source : Path
        A .vti file.
    promised : int
        Most bytes that one array of the image may take, unpacked.

    Raises
    ------
    VolumeReadError
        If a block header makes no sense.
    """
    with (
        source.open("rb") as stream,
        mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as data,
    ):
        head = data[:HEAD]
        if b"compressor=" not in head:
            return
        order = ">" if b'byte_order="BigEndian"' in head else "<"
        kind = "Q" if b'header_type="UInt64"' in head else "I"
        for begin in _block_headers(data, struct.calcsize(kind)):
            if len(begin) < 3 * struct.calcsize(kind):
                continue
            count, size, _ = struct.unpack_from(f"{order}3{kind}", begin)
            most = 2 * promised + HEAD
            if count > len(data) or size > most or count * size > most:
                fail(source, "damaged: a block of its data has no possible size; write it again")


def _block_headers(data: mmap.mmap, width: int) -> Iterator[bytes]:
    for match in INLINE.finditer(data):
        yield _decoded(match[1])
    appended = APPENDED.search(data)
    if appended is None:
        return
    for match in OFFSET.finditer(data, 0, appended.start()):
        start = appended.end() + int(match[1])
        part = data[start : start + 4 * width]
        yield part if appended[1] == b"raw" else _decoded(data[start : start + 44])


def _decoded(text: bytes) -> bytes:
    try:
        return base64.b64decode(text[: len(text) // 4 * 4])
    except ValueError:
        return b""
