"""DICOM files that are deflated as a whole: how much they unpack to, before anything holds it."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import IO

from .errors import VolumeReadError
from .source import amount, free_memory

DEFLATED = "1.2.840.10008.1.2.1.99"
# The transfer syntax stands in the first few hundred bytes, before anything is deflated
HEAD = 1024
# Preamble, mark, and the element that says how long the rest of the meta information is
FIXED = 128 + 4 + 12
READ, UNPACKED = 1 << 20, 1 << 24


def check_deflated(file: Path, stream: IO[bytes]) -> None:
    """Refuse a deflated file that unpacks to more than a quarter of the free memory.

    pydicom unpacks it in one piece, whatever its size: 1 MB may stand for 1 GB. Other files pass.
    The stream is at its beginning before and after.
    """
    head = stream.read(HEAD)
    stream.seek(0)
    free = free_memory()
    if DEFLATED.encode() not in head or free is None:
        return
    if _unpacked_size(stream, head, free // 4) > free // 4:
        raise VolumeReadError(
            f"{file}: the deflated file unpacks to more than {amount(free // 4)}, a quarter of the "
            "free memory; convert it to plain DICOM, or free memory."
        )
    stream.seek(0)


def _unpacked_size(stream: IO[bytes], head: bytes, limit: int) -> int:
    """Bytes after unpacking, or more than `limit`; holds a few megabytes of them at a time."""
    stream.seek(FIXED + int.from_bytes(head[FIXED - 4 : FIXED], "little"))
    unpack = zlib.decompressobj(-zlib.MAX_WBITS)
    size = 0
    while size <= limit and not unpack.eof:
        packed = unpack.unconsumed_tail or stream.read(READ)
        if not packed:
            break
        size += len(unpack.decompress(packed, UNPACKED))
    return size
