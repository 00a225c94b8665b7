"""Read NIfTI-1, with its header and size checked first."""

from __future__ import annotations

import contextlib
import gzip
import struct
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import fail, header_errors
from .itk import read_with_itk

if TYPE_CHECKING:
    from pathlib import Path

    from .volume import LoadedVolume


def read_nifti(source: Path) -> LoadedVolume:
    """Read a .nii or .nii.gz file.

    Raises
    ------
    VolumeReadError
        If the file is damaged or not 3-D.
    """
    with header_errors(source):
        header = _read_header(source)
        _check_size(source, header)
    volume = read_with_itk(source, "NiftiImageIO", "NIfTI")
    unit = {1: "m", 3: "um"}.get(header.unit_code)
    if unit is not None:
        volume.notes.append(f"lengths converted from {unit} to mm")
    if not header.has_orientation:
        volume.notes.append("the file says nothing about left and right: LPS axes are assumed")
    return volume


@dataclass(frozen=True)
class _Header:
    bytes_needed: int
    unit_code: int
    has_orientation: bool


def _read_header(source: Path) -> _Header:
    try:
        with _open_maybe_gzip(source) as stream:
            head = stream.read(348)
    except (OSError, EOFError, zlib.error):
        fail(source, "damaged or truncated gzip data; copy or export the file again")
    if head[:4] in {struct.pack("<i", 540), struct.pack(">i", 540)}:
        fail(source, "NIfTI-2 is not supported; save it as NIfTI-1")
    order = next((o for o in "<>" if head[:4] == struct.pack(o + "i", 348)), None)
    if order is None or len(head) < 348 or head[344:347] not in {b"n+1", b"ni1"}:
        fail(source, "not a NIfTI file (its header is damaged); export it again")
    if head[344:347] == b"ni1":
        fail(source, "a NIfTI header without voxels; give one .nii or .nii.gz file")
    dims = struct.unpack_from(order + "8h", head, 40)
    bits = struct.unpack_from(order + "h", head, 72)[0]
    offset = struct.unpack_from(order + "f", head, 108)[0]
    codes = struct.unpack_from(order + "2h", head, 252)
    voxels = int(np.prod([max(d, 1) for d in dims[1 : 1 + dims[0]]], dtype=np.int64))
    return _Header(int(offset) + voxels * bits // 8, head[123] & 7, any(codes))


def _open_maybe_gzip(source: Path) -> Any:
    return gzip.open(source, "rb") if source.suffix.lower() == ".gz" else source.open("rb")


def _check_size(source: Path, header: _Header) -> None:
    # SimpleITK fills the missing end of a truncated NIfTI file with zeros and says nothing.
    compressed = source.suffix.lower() == ".gz"
    size = _gzip_size(source, header.bytes_needed) if compressed else source.stat().st_size
    if size < header.bytes_needed:
        fail(source, "truncated: voxels are missing at its end; copy or export the file again")


def _gzip_size(source: Path, expected: int) -> int:
    """Return the unpacked size, unpacking only if the gzip trailer is not the `expected` one."""
    with source.open("rb") as stream:
        stream.seek(-4, 2)
        trailer = struct.unpack("<I", stream.read(4))[0]
    if trailer == expected % 2**32:
        return expected
    size = 0
    with gzip.open(source, "rb") as unpacked, contextlib.suppress(OSError, EOFError, zlib.error):
        while chunk := unpacked.read(1 << 20):
            size += len(chunk)
    return size
