"""Read MetaImage, plain or packed, with its voxels in the header's file or in one beside it."""

from __future__ import annotations

import contextlib
import math
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .compact import compact_values
from .data_files import data_file
from .errors import fail, header_errors
from .source import VolumeSource
from .streams import PIECE, check_promise, fill, skip
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from .options import ReadOptions

LINE_LIMIT = 1 << 16
DIMENSIONS = 4
TYPES = {
    "MET_CHAR": "i1", "MET_UCHAR": "u1", "MET_SHORT": "i2", "MET_USHORT": "u2", "MET_INT": "i4",
    "MET_UINT": "u4", "MET_LONG": "i4", "MET_ULONG": "u4", "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8", "MET_FLOAT": "f4", "MET_DOUBLE": "f8",
}  # fmt: skip


@dataclass(frozen=True)
class _Header:
    """What a MetaImage header says; `size` has 3 or 4 numbers, i first."""

    data: Path
    start: int
    size: list[int]
    channels: int
    kind: np.dtype
    packed: bool
    spacing: NDArray[np.float64]
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]

    def volume_bytes(self) -> int:
        """Return the size of one volume, unpacked."""
        return math.prod(self.size[:3]) * self.channels * self.kind.itemsize


def open_metaimage(source: Path, options: ReadOptions) -> VolumeSource:
    """Judge a .mha or .mhd file by its header.

    Raises
    ------
    VolumeReadError
        If the file is damaged or not 3-D.
    """
    fields, end = _fields(source)
    with header_errors(source):
        header = _judged(source, fields, end)
    if header.packed:
        _check_compressed_size(source, fields, header)
    volumes = math.prod(header.size[3:])
    promised = header.volume_bytes() * volumes
    check_promise(source, [header.data], "gzip" if header.packed else "raw", promised)
    step = _numbers(fields, ("elementspacing", "elementsize"), len(header.size), 1.0)[-1]
    return VolumeSource(
        size=header.size[:3],
        memory=2 * header.volume_bytes(),
        load=lambda index: _load(source, header, index, options),
        times=[k * float(step) for k in range(volumes)],
    )


def _fields(source: Path) -> tuple[dict[str, str], int]:
    fields: dict[str, str] = {}
    with source.open("rb") as stream:
        for raw in iter(lambda: stream.readline(LINE_LIMIT), b""):
            key, _, value = raw.decode("utf-8", errors="replace").partition("=")
            fields[key.strip().lower()] = value.strip()
            if "elementdatafile" in fields:
                break
        return fields, stream.tell()


def _judged(source: Path, fields: dict[str, str], end: int) -> _Header:
    data, start = _data_place(source, fields, end)
    size = _size(source, fields)
    kind = fields.get("elementtype", "").upper().removesuffix("_ARRAY")
    if kind not in TYPES:
        fail(source, f"MetaImage voxels of type {kind[:40]!r} are not supported; save another type")
    channels = int(fields.get("elementnumberofchannels", "1"))
    if channels < 1:
        raise ValueError("ElementNumberOfChannels is below 1")
    big = _yes(fields, "elementbyteordermsb") or _yes(fields, "binarydatabyteordermsb")
    count = len(size)
    header = _Header(
        data=data,
        start=start,
        size=size,
        channels=channels,
        kind=np.dtype((">" if big else "<") + TYPES[kind]),
        packed=_yes(fields, "compresseddata"),
        spacing=_numbers(fields, ("elementspacing", "elementsize"), count, 1.0)[:3],
        origin=_numbers(fields, ("offset", "position", "origin"), count, 0.0)[:3],
        direction=_matrix(fields, count),
    )
    if start == -1:
        # The voxels are the end of the file.
        return _Header(**header.__dict__ | {"start": _start_from_end(header)})
    return header


def _data_place(source: Path, fields: dict[str, str], end: int) -> tuple[Path, int]:
    """Return the file of the voxels and where they begin, -1 if they are its end."""
    name = fields.get("elementdatafile", "")
    if not name:
        fail(source, "not a MetaImage file (it names no ElementDataFile); check the file")
    if name == "LIST" or "%" in name:
        fail(source, "a list of data files is not supported; save it with one data file")
    if name == "LOCAL":
        return source, end
    start = int(fields.get("headersize", "0"))
    if start < -1:
        raise ValueError("HeaderSize is below -1")
    return data_file(source, name), start


def _size(source: Path, fields: dict[str, str]) -> list[int]:
    size = [int(word) for word in fields.get("dimsize", "").replace(",", " ").split()]
    if int(fields.get("ndims", "0")) != len(size) or min(size, default=0) < 1:
        raise ValueError("DimSize does not have NDims numbers")
    if len(size) > DIMENSIONS:
        fail(source, f"{len(size)} dimensions are too many; save it with {DIMENSIONS} or less")
    check_dimension(source, size[:3])
    return size


def _yes(fields: dict[str, str], key: str) -> bool:
    return fields.get(key, "").lower() in {"true", "t", "1"}


def _numbers(
    fields: dict[str, str], keys: tuple[str, ...], count: int, usual: float
) -> NDArray[np.float64]:
    text = next((fields[key] for key in keys if key in fields), None)
    if text is None:
        return np.full(count, usual)
    numbers = np.array([float(word) for word in text.replace(",", " ").split()])
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise ValueError(f"{keys[0]} does not have {count} finite numbers")
    return numbers


def _matrix(fields: dict[str, str], count: int) -> NDArray[np.float64]:
    """Return the directions of the axes as columns; the file has one axis after the other."""
    keys = ("transformmatrix", "orientation", "rotation")
    if not any(key in fields for key in keys):
        return np.eye(3)
    return _numbers(fields, keys, count * count, 0.0).reshape(count, count)[:3, :3].T


def _start_from_end(header: _Header) -> int:
    volumes = math.prod(header.size[3:])
    return max(header.data.stat().st_size - header.volume_bytes() * volumes, 0)


def _check_compressed_size(source: Path, fields: dict[str, str], header: _Header) -> None:
    """Refuse a stream that is not whole within the size that the header gives for it.

    What other readers make of such a file has an undefined end.
    """
    declared = fields.get("compresseddatasize", "")
    if not declared.isdigit():
        return
    with header.data.open("rb") as stream:
        stream.seek(header.start)
        available = header.data.stat().st_size - header.start
        if available == int(declared) or _is_whole_stream(stream, int(declared)):
            return
    fail(
        source,
        f"its header says {declared} bytes of compressed data but there are {available}: "
        "the file is damaged or truncated; write it again",
    )


def _is_whole_stream(stream: Any, length: int) -> bool:
    unpacker = zlib.decompressobj()
    with contextlib.suppress(zlib.error):
        while length > 0 and not unpacker.eof:
            piece = stream.read(min(length, PIECE))
            length -= len(piece)
            if not piece:
                break
            while piece and not unpacker.eof:
                unpacker.decompress(piece, PIECE)
                piece = unpacker.unconsumed_tail
    return unpacker.eof


class _Unpacked:
    """The unpacked bytes of a zlib or gzip stream, as far as they are asked for."""

    def __init__(self, stream: Any):
        self.stream = stream
        # 32: either kind of header.
        self.unpacker = zlib.decompressobj(wbits=32 + zlib.MAX_WBITS)

    def readinto(self, target: memoryview) -> int:
        """Fill `target` as far as there is something, and return how far."""
        piece = self.unpacker.unconsumed_tail
        data = b""
        while not data and not self.unpacker.eof:
            piece = piece or self.stream.read(PIECE)
            if not piece:
                break
            data = self.unpacker.decompress(piece, len(target))
            piece = self.unpacker.unconsumed_tail
        target[: len(data)] = data
        return len(data)


def _load(source: Path, header: _Header, index: int, options: ReadOptions) -> LoadedVolume:
    flat = np.empty(header.volume_bytes() // header.kind.itemsize, header.kind)
    with header.data.open("rb") as stream:
        stream.seek(header.start)
        unpacked = _Unpacked(stream) if header.packed else stream
        skip(source, unpacked, index * header.volume_bytes())
        fill(source, unpacked, flat, lambda done: options.progress(done, "reading MetaImage"))
    shape = (*header.size[2::-1], *([header.channels] if header.channels > 1 else []))
    noted = ["read as MetaImage"]
    length = np.linalg.norm(header.direction, axis=0)
    if not length.all():
        fail(source, "an axis of the file has no direction; export the file again")
    return LoadedVolume(
        values=compact_values(flat.reshape(shape), noted),
        spacing=header.spacing,
        origin=header.origin,
        direction=header.direction / length,
        notes=noted,
    )
