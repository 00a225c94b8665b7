"""Read MetaImage, with its header checked first."""

from __future__ import annotations

import contextlib
import math
import zlib
from typing import TYPE_CHECKING

from .data_files import data_file
from .errors import fail, header_errors
from .itk import open_with_itk
from .streams import check_promise
from .volume import check_dimension

if TYPE_CHECKING:
    from pathlib import Path

    from .options import ReadOptions
    from .source import VolumeSource

LINE_LIMIT = 1 << 16
DIMENSIONS = 4
BYTES = {
    "MET_CHAR": 1, "MET_UCHAR": 1, "MET_SHORT": 2, "MET_USHORT": 2, "MET_INT": 4, "MET_UINT": 4,
    "MET_LONG": 4, "MET_ULONG": 4, "MET_LONG_LONG": 8, "MET_ULONG_LONG": 8, "MET_FLOAT": 4,
    "MET_DOUBLE": 8,
}  # fmt: skip


def open_metaimage(source: Path, options: ReadOptions) -> VolumeSource:
    """Judge a .mha or .mhd file by its header.

    Raises
    ------
    VolumeReadError
        If the file is damaged or not 3-D.
    """
    header, data_start = _read_header(source)
    name = header.get("elementdatafile", "")
    if not name:
        fail(source, "not a MetaImage file (it names no ElementDataFile); check the file")
    if name == "LIST" or "%" in name:
        fail(source, "a list of data files is not supported; save it with one data file")
    data = source if name == "LOCAL" else data_file(source, name)
    with header_errors(source):
        _check_size(source, header, data)
    _check_compressed_size(source, header, data, data_start)
    return open_with_itk(source, "MetaImageIO", "MetaImage", options)


def _read_header(source: Path) -> tuple[dict[str, str], int]:
    header: dict[str, str] = {}
    with source.open("rb") as stream:
        for raw in iter(lambda: stream.readline(LINE_LIMIT), b""):
            key, _, value = raw.decode("utf-8", errors="replace").partition("=")
            header[key.strip().lower()] = value.strip()
            if "elementdatafile" in header:
                break
        return header, stream.tell()


def _check_size(source: Path, header: dict[str, str], data: Path) -> None:
    # A number of dimensions beyond 10 makes MetaIO write behind its memory.
    size = [int(word) for word in header.get("dimsize", "").replace(",", " ").split()]
    if int(header.get("ndims", "0")) != len(size) or min(size, default=0) < 1:
        raise ValueError("DimSize does not have NDims numbers")
    if len(size) > DIMENSIONS:
        fail(source, f"{len(size)} dimensions are too many; save it with {DIMENSIONS} or less")
    check_dimension(source, size[:3])
    kind = header.get("elementtype", "").upper().removesuffix("_ARRAY")
    if kind not in BYTES:
        fail(source, f"MetaImage voxels of type {kind[:40]!r} are not supported; save another type")
    channels = int(header.get("elementnumberofchannels", "1"))
    if channels < 1:
        raise ValueError("ElementNumberOfChannels is below 1")
    compressed = header.get("compresseddata", "").lower() in {"true", "t", "1"}
    promised = math.prod(size) * channels * BYTES[kind]
    check_promise(source, [data], "gzip" if compressed else "raw", promised)


def _check_compressed_size(
    source: Path, header: dict[str, str], data: Path, data_start: int
) -> None:
    # With too small a CompressedDataSize, SimpleITK leaves the last voxels undefined.
    declared = header.get("compresseddatasize", "")
    if not declared.isdigit():
        return
    name = header["elementdatafile"]
    with data.open("rb") as stream:
        stream.seek(data_start if name == "LOCAL" else 0)
        available = data.stat().st_size - stream.tell()
        if available == int(declared) or _is_whole_stream(stream.read(int(declared))):
            return
    fail(
        source,
        f"its header says {declared} bytes of compressed data but there are {available}: "
        "the file is damaged or truncated; write it again",
    )


def _is_whole_stream(data: bytes) -> bool:
    stream = zlib.decompressobj()
    with contextlib.suppress(zlib.error):
        stream.decompress(data)
    return stream.eof
