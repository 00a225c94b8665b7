"""Read NRRD: every encoding, any space and order of axes, one volume out of several."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .compact import compact_values
from .errors import fail, header_errors
from .nrrd_header import read_nrrd_header
from .segments import segments_from_slicer
from .source import VolumeSource
from .streams import check_promise, fill, skip, tail, unpacking
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from .nrrd_header import NrrdHeader
    from .options import ReadOptions

MM_PER_UNIT = {
    "mm": 1.0,
    "millimeter": 1.0,
    "um": 1e-3,
    "µm": 1e-3,
    "micron": 1e-3,
    "microns": 1e-3,
    "micrometer": 1e-3,
    "cm": 10.0,
    "m": 1000.0,
    "meter": 1000.0,
}


def open_nrrd(source: Path, options: ReadOptions) -> VolumeSource:
    """Judge a .nrrd or .nhdr file by its header.

    Raises
    ------
    VolumeReadError
        If the file is damaged, of an unsupported variant or not 3-D.
    """
    with header_errors(source):
        header = read_nrrd_header(source)
        size = [header.sizes[axis] for axis in header.spatial]
        check_dimension(source, size)
    promised = header.bytes_of_voxels()
    if header.encoding in {"raw", "gzip", "bzip2"}:
        skipped = max(header.byte_skip, 0)
        check_promise(source, header.files, header.encoding, promised + skipped)
    else:
        # A number takes one digit and a space, or two hexadecimal digits per byte.
        check_promise(source, header.files, "raw", promised // header.kind.itemsize)
    layers = _is_layered(header)
    count = 1 if layers else int(np.prod([header.sizes[axis] for axis in header.volume]))
    return VolumeSource(
        size=size,
        memory=2 * promised,
        load=lambda index: _load(header, index, layers, options),
        times=_times(header, count),
        choose="" if count == 1 or _has_time(header) else "nothing that the file names",
    )


def _is_layered(header: NrrdHeader) -> bool:
    return "Segment0_LabelValue" in header.pairs


def _has_time(header: NrrdHeader) -> bool:
    kinds = header.fields.get("kinds", "").lower().split()
    return not kinds or any(kinds[axis] in {"time", "list"} for axis in header.volume)


def _times(header: NrrdHeader, count: int) -> list[float]:
    steps = [float(word) for word in header.fields.get("spacings", "").split()]
    step = 1.0
    if len(header.volume) == 1 and len(steps) > header.volume[0] and steps[header.volume[0]] > 0:
        step = steps[header.volume[0]]
    return [k * step for k in range(count)]


def _load(header: NrrdHeader, index: int, layers: bool, options: ReadOptions) -> LoadedVolume:
    values = _ordered(header, _stored(header, options))
    noted = ["read as NRRD", *header.notes]
    segments = segments_from_slicer(header.pairs)
    if layers:
        values = _flattened(values, header.pairs, noted)
    else:
        values = values[index]
    spacing = np.linalg.norm(header.directions, axis=0)
    if not (np.isfinite(spacing).all() and spacing.min() > 0):
        fail(header.path, "an axis of the file has no direction; export the file again")
    volume = LoadedVolume(
        values=compact_values(values, noted),
        spacing=spacing,
        origin=header.origin,
        direction=header.directions / spacing,
        notes=noted,
        segments=segments,
    )
    return _in_mm(volume, header.fields)


# Voxels


def _stored(header: NrrdHeader, options: ReadOptions) -> NDArray[Any]:
    """Return all voxels of the file in its order, slowest axis first."""
    total = int(np.prod(header.sizes, dtype=object))
    if header.encoding in {"ascii", "hex"}:
        flat = np.concatenate([_numbers(header, file) for file in header.files])
        if len(flat) < total:
            fail(header.path, "truncated: voxels are missing at its end; export the file again")
        return flat[:total].reshape(header.sizes[::-1])
    flat = np.empty(total, header.kind)
    share, rest = divmod(total, len(header.files))
    if rest:
        fail(header.path, "its data files do not share the voxels evenly; check the header")
    for number, file in enumerate(header.files):
        part = flat[number * share : (number + 1) * share]
        _read_part(header, file, part, options, number)
    return flat.reshape(header.sizes[::-1])


def _read_part(
    header: NrrdHeader, file: Path, part: NDArray[Any], options: ReadOptions, number: int
) -> None:
    files = len(header.files)

    def report(done: float) -> None:
        options.progress((number + done) / files, "reading NRRD")

    with file.open("rb") as stream:
        stream.seek(header.data_start)
        for _ in range(header.line_skip):
            if not stream.readline():
                fail(header.path, "its header skips more lines than there are; check it")
        if header.encoding == "raw" and header.byte_skip == -1:
            stream.seek(-part.nbytes, 2)
        packed = unpacking(stream, header.encoding)
        if header.encoding != "raw" and header.byte_skip == -1:
            part[:] = np.frombuffer(tail(header.path, packed, part.nbytes), part.dtype)
            return
        if header.byte_skip > 0:
            skip(header.path, packed, header.byte_skip)
        fill(header.path, packed, part, report)


def _numbers(header: NrrdHeader, file: Path) -> NDArray[Any]:
    with file.open("rb") as stream:
        stream.seek(header.data_start)
        for _ in range(header.line_skip):
            stream.readline()
        text = stream.read()
    with header_errors(header.path):
        if header.encoding == "hex":
            return np.frombuffer(bytes.fromhex(text.decode("ascii")), header.kind)
        words = text.replace(b",", b" ").split()
        if header.kind.kind == "f":
            return np.array([float(word) for word in words], header.kind.newbyteorder("="))
        return np.array([int(word) for word in words], header.kind.newbyteorder("="))


def _ordered(header: NrrdHeader, stored: NDArray[Any]) -> NDArray[Any]:
    """Return voxels as (volume, k, j, i) or (volume, k, j, i, component)."""
    last = len(header.sizes) - 1
    axes = [*reversed(header.volume), *reversed(header.spatial)]
    axes += [] if header.component is None else [header.component]
    ordered = stored.transpose([last - axis for axis in axes])
    return ordered.reshape(-1, *ordered.shape[len(header.volume) :])


def _flattened(values: NDArray[Any], pairs: dict[str, str], noted: list[str]) -> NDArray[Any]:
    """Return the layers of a Slicer segmentation as one label map, later segments on top."""
    if values.ndim == 5:
        values = np.moveaxis(values[0], -1, 0)
    if len(values) == 1:
        return values[0]
    segments = segments_from_slicer(pairs)
    flat = np.zeros(values.shape[1:], np.int32)
    overlapping = 0
    for number, segment in enumerate(segments, start=0):
        layer = int(pairs.get(f"Segment{number}_Layer", "0"))
        stored = int(pairs.get(f"Segment{number}_LabelValue", "0"))
        if not 0 <= layer < len(values):
            continue
        covered = values[layer] == stored
        overlapping += int(np.count_nonzero(flat[covered]))
        flat[covered] = segment.value
    if overlapping:
        noted.append(f"segments overlap in {overlapping} voxels, which belong to the later one")
    return flat


def _in_mm(volume: LoadedVolume, fields: dict[str, str]) -> LoadedVolume:
    named = {unit.lower() for unit in fields.get("space units", "").replace('"', " ").split()}
    unit = named.pop() if len(named) == 1 else "mm"
    if named:
        volume.notes.append("the axes have different length units, which were taken as mm")
    elif unit not in MM_PER_UNIT:
        volume.notes.append("unknown length unit, taken as mm")
    elif MM_PER_UNIT[unit] != 1.0:
        volume.spacing = volume.spacing * MM_PER_UNIT[unit]
        volume.origin = volume.origin * MM_PER_UNIT[unit]
        volume.notes.append(f"lengths converted from {unit} to mm")
    return volume
