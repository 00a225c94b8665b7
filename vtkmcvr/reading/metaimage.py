"""Read MetaImage, with its header checked first."""

from __future__ import annotations

import contextlib
import zlib
from typing import TYPE_CHECKING

from .data_files import check_data_file
from .errors import fail, header_errors
from .itk import read_with_itk
from .volume import check_dimension

if TYPE_CHECKING:
    from pathlib import Path

    from .volume import LoadedVolume


def read_metaimage(source: Path) -> LoadedVolume:
    """Read a .mha or .mhd file.

    Raises
    ------
    VolumeReadError
        If the file is damaged or not 3-D.
    """
    header, data_start = _read_header(source)
    name = header.get("elementdatafile", "")
    if not name:
        fail(source, "not a MetaImage file (it names no ElementDataFile); check the file")
    if name not in {"LOCAL", "LIST"} and "%" not in name:
        check_data_file(source, name)
    with header_errors(source):
        _check_size(source, header)
    _check_compressed_size(source, header, data_start)
    return read_with_itk(source, "MetaImageIO", "MetaImage")


def _read_header(source: Path) -> tuple[dict[str, str], int]:
    header: dict[str, str] = {}
    with source.open("rb") as stream:
        for raw in iter(stream.readline, b""):
            key, _, value = raw.decode("utf-8", errors="replace").partition("=")
            header[key.strip().lower()] = value.strip()
            if "elementdatafile" in header:
                break
        return header, stream.tell()


def _check_size(source: Path, header: dict[str, str]) -> None:
    # A number of dimensions beyond 10 makes MetaIO write behind its memory.
    size = [int(word) for word in header.get("dimsize", "").replace(",", " ").split()]
    if int(header.get("ndims", "0")) != len(size):
        raise ValueError("DimSize does not have NDims numbers")
    check_dimension(source, size)


def _check_compressed_size(source: Path, header: dict[str, str], data_start: int) -> None:
    # With too small a CompressedDataSize, SimpleITK leaves the last voxels undefined.
    declared = header.get("compresseddatasize", "")
    name = header["elementdatafile"]
    if not declared.isdigit() or name == "LIST" or "%" in name:
        return
    data = source if name == "LOCAL" else source.parent / name
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
