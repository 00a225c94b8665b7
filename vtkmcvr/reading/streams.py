"""Take a known number of bytes out of a file, plain or compressed, and never more."""

from __future__ import annotations

import bz2
import gzip
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import fail

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

PIECE = 1 << 22
# Neither gzip nor bzip2 packs zeros tighter than this; bzip2 comes near on nothing but zeros.
HIGHEST_RATIO = {"raw": 1, "gzip": 1032, "bzip2": 45_000_000}
SKIP_LIMIT = 1 << 30


def check_promise(source: Path, files: Sequence[Path], packing: str, promised: int) -> None:
    """Refuse a header that promises more bytes than its files can hold.

    Raises
    ------
    VolumeReadError
        Before anything is allocated.
    """
    held = sum(file.stat().st_size for file in files)
    if promised > held * HIGHEST_RATIO[packing]:
        fail(
            source,
            f"truncated or damaged: its header promises {promised} bytes of voxels and there "
            f"are only {held} bytes{'' if packing == 'raw' else ', packed'}; copy or export the "
            "file again",
        )


def fill(source: Path, stream: Any, target: NDArray[Any], report: Callable[[float], None]) -> None:
    """Fill a contiguous array from a stream.

    Parameters
    ----------
    source : Path
        The file to name in an error.
    stream : binary stream
        Plain, or unpacking.
    target : ndarray
        What to fill.
    report : callable
        Called with the share that is done.

    Raises
    ------
    VolumeReadError
        If the stream ends early or is damaged.
    """
    view: Any = memoryview(target.reshape(-1).view(np.uint8))  # type: ignore[arg-type]
    done = 0
    try:
        while done < len(view):
            count = stream.readinto(view[done : done + PIECE])
            if not count:
                raise EOFError
            done += count
            report(done / len(view))
    except (EOFError, zlib.error, gzip.BadGzipFile, OSError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        fail(
            source,
            "truncated or damaged: voxels are missing at its end; copy or export the file again",
        )


def unpacking(stream: Any, packing: str) -> Any:
    """Return a stream of the bytes that are packed in `stream` as "raw", "gzip" or "bzip2"."""
    if packing == "gzip":
        return gzip.GzipFile(fileobj=stream)
    return bz2.BZ2File(stream) if packing == "bzip2" else stream


def skip(source: Path, stream: Any, count: int) -> None:
    """Read over `count` bytes.

    Raises
    ------
    VolumeReadError
        If there are not so many, or they are damaged.
    """
    trash = np.empty(min(count, PIECE), np.uint8)
    while count:
        part = trash[: min(count, PIECE)]
        fill(source, stream, part, lambda done: None)
        count -= len(part)


def tail(source: Path, stream: Any, count: int) -> bytes:
    """Return the last `count` bytes of a packed stream.

    Raises
    ------
    VolumeReadError
        If there are fewer, or very many before them.
    """
    kept, seen = bytearray(), 0
    try:
        while piece := stream.read(PIECE):
            seen += len(piece)
            kept += piece
            del kept[: max(len(kept) - count, 0)]
            if seen > count + SKIP_LIMIT:
                fail(source, "unpacks to far more than its header says; check the file")
    except (EOFError, zlib.error, gzip.BadGzipFile):
        fail(source, "truncated or damaged packed data; copy or export the file again")
    if len(kept) < count:
        fail(source, "truncated: voxels are missing at its end; copy or export the file again")
    return bytes(kept)
