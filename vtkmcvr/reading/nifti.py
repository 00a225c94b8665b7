"""Read NIfTI-1 and NIfTI-2, plain, gzipped or as a pair of header and image."""

from __future__ import annotations

import gzip
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

from .compact import compact_values
from .errors import fail, header_errors
from .nifti_header import extension_text, read_nifti_header
from .segments import segments_from_caret
from .source import VolumeSource
from .streams import check_promise, fill, skip, unpacking
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from .nifti_header import NiftiHeader
    from .options import ReadOptions

HEAD = 1 << 20


def open_nifti(source: Path, options: ReadOptions) -> VolumeSource:
    """Judge a .nii, .nii.gz, .hdr or .img file by its header.

    Raises
    ------
    VolumeReadError
        If the file is damaged or not 3-D.
    """
    source = _header_of_pair(source)
    head = _head(source)
    with header_errors(source):
        header = read_nifti_header(source, head)
        check_dimension(source, header.size)
    if not header.is_pair:
        header.segments = segments_from_caret(extension_text(head, header.offset))
    data = _image_of_pair(source) if header.is_pair else source
    packing = _packing(data)
    whole = header.volume_bytes() * header.volumes
    check_promise(source, [data], packing, header.offset + whole)
    return VolumeSource(
        size=header.size,
        memory=header.volume_bytes() * (1 if header.slope == 1.0 else 6),
        load=lambda index: _load(source, data, header, index, options),
        times=[k * header.time_step for k in range(header.volumes)],
    )


def _header_of_pair(source: Path) -> Path:
    name = source.name
    for old, new in ((".img.gz", ".hdr.gz"), (".img", ".hdr")):
        if name.lower().endswith(old):
            header = source.with_name(name[: -len(old)] + new)
            if not header.is_file():
                fail(source, "its header (.hdr) is missing; put it beside the image")
            return header
    return source


def _image_of_pair(source: Path) -> Path:
    name = source.name
    for suffix in (".hdr.gz", ".hdr"):
        if name.lower().endswith(suffix):
            stem = name[: -len(suffix)]
            for ending in (".img", ".img.gz"):
                if source.with_name(stem + ending).is_file():
                    return source.with_name(stem + ending)
    fail(source, "a NIfTI header without voxels; give one .nii file or put the .img beside it")


def _packing(source: Path) -> str:
    with source.open("rb") as stream:
        return "gzip" if stream.read(2) == b"\x1f\x8b" else "raw"


def _head(source: Path) -> bytes:
    try:
        with source.open("rb") as stream:
            packed = source.suffix.lower() == ".gz"
            return unpacking(stream, "gzip" if packed else "raw").read(HEAD)
    except (gzip.BadGzipFile, EOFError, zlib.error):
        fail(source, "damaged or truncated gzip data; copy or export the file again")


def _load(
    source: Path, data: Path, header: NiftiHeader, index: int, options: ReadOptions
) -> LoadedVolume:
    flat = np.empty(header.volume_bytes() // header.kind.itemsize, header.kind)
    with data.open("rb") as stream:
        packing = _packing(data)
        start = header.offset + index * header.volume_bytes()
        if packing == "raw":
            stream.seek(start)
        packed = unpacking(stream, packing)
        if packing == "gzip":
            skip(source, packed, start)
        fill(source, packed, flat, lambda done: options.progress(done, "reading NIfTI"))
    noted = ["read as NIfTI", *header.notes]
    values = _rescaled(_shaped(flat, header), header, noted)
    spacing = np.linalg.norm(header.directions, axis=0)
    if not (np.isfinite(spacing).all() and spacing.min() > 0):
        fail(source, "an axis of the file has no direction or length; export the file again")
    return LoadedVolume(
        values=values,
        spacing=spacing,
        origin=header.origin,
        direction=header.directions / spacing,
        notes=noted,
        segments=header.segments,
    )


def _shaped(flat: NDArray[Any], header: NiftiHeader) -> NDArray[Any]:
    shape = header.size[::-1]
    if header.components == 1:
        return flat.reshape(shape)
    if header.kind.itemsize == 1:
        return flat.reshape(*shape, header.components)
    return np.moveaxis(flat.reshape(header.components, *shape), 0, -1)


def _rescaled(values: NDArray[Any], header: NiftiHeader, noted: list[str]) -> NDArray[Any]:
    slope, intercept = header.slope, header.intercept
    if (slope, intercept) == (1.0, 0.0):
        return compact_values(values, noted)
    noted.append(f"rescaled: value = {slope:g} x stored + {intercept:g}")
    whole = float(slope).is_integer() and float(intercept).is_integer()
    if values.dtype.kind in "iu" and whole:
        return compact_values(values.astype(np.float64) * slope + intercept, noted)
    rescaled = np.empty(values.shape, np.float32)
    for target, stored in zip(rescaled, values, strict=True):
        target[...] = stored.astype(np.float64) * slope + intercept
    return rescaled
