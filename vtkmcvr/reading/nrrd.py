"""Read NRRD, with its header checked first, because SimpleITK says little about what is wrong."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from .data_files import check_data_file
from .errors import fail, header_errors
from .itk import read_with_itk
from .volume import four_dimensional

if TYPE_CHECKING:
    from pathlib import Path

    from .volume import LoadedVolume

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


def read_nrrd(source: Path) -> LoadedVolume:
    """Read a .nrrd or .nhdr file.

    Raises
    ------
    VolumeReadError
        If the file is damaged, of an unsupported variant or not 3-D.
    """
    header = _read_header(source)
    with header_errors(source):
        _check_header(source, header)
    volume = read_with_itk(source, "NrrdImageIO", "NRRD")
    if "spacings" not in header and "space directions" not in header:
        volume.notes.append("no spacing in the file: 1 is assumed")
    if header.get("space", "3d-right-handed").lower() == "3d-right-handed":
        volume.notes.append("no anatomical space in the file: its axes are taken as LPS")
    return _in_mm(volume, header)


def _read_header(source: Path) -> dict[str, str]:
    header: dict[str, str] = {}
    with source.open("rb") as stream:
        if stream.read(4) != b"NRRD":
            fail(source, "not a NRRD file (its first letters are not 'NRRD'); check the file")
        stream.readline()
        for raw in stream:
            line = raw.decode("utf-8", errors="replace").strip()
            if not line:
                break
            key, separator, value = line.partition(":")
            if separator and not value.startswith("=") and not line.startswith("#"):
                header[key.strip().lower()] = value.strip()
    return header


def _check_header(source: Path, header: dict[str, str]) -> None:
    if header.get("encoding", "").lower() in {"bzip2", "bz2"}:
        fail(source, f"NRRD with bzip2 encoding is not supported; {_bzip2_remedy(header)}")
    space = header.get("space", "").lower()
    if space == "3d-left-handed" or (space and "spacings" in header):
        fail(
            source,
            f"NRRD space '{space}' is not supported here; save it with space "
            "left-posterior-superior and with 'space directions' instead of 'spacings'",
        )
    _check_axes(source, header)
    for name in _data_files(header):
        check_data_file(source, name)


def _bzip2_remedy(header: dict[str, str]) -> str:
    if "data file" in header or "datafile" in header:
        return (
            "unpack its data file with bunzip2, then write the name of the unpacked file and "
            "'encoding: raw' into the header"
        )
    return "convert it with Teem's command 'unu save -f nrrd -e gzip -i OLD.nrrd -o NEW.nrrd'"


def _check_axes(source: Path, header: dict[str, str]) -> None:
    sizes = header.get("sizes", "").split()
    kinds = header.get("kinds", "").lower().split() or ["domain"] * len(sizes)
    places = {"domain", "space", "time", "none", "???"}
    domain = [size for size, kind in zip(sizes, kinds, strict=False) if kind in places]
    if 0 < len(domain) < 3:
        fail(source, f"a {len(domain)}-D image is not a volume; give a file with 3 dimensions")
    volumes = [*_sizes_without_direction(header, sizes), *domain[3:]]
    if len(domain) > 3 and volumes[0] != "1":
        fail(source, four_dimensional(int(volumes[0])))


def _sizes_without_direction(header: dict[str, str], sizes: list[str]) -> list[str]:
    directions = re.findall(r"\([^)]*\)|none", header.get("space directions", ""))
    pairs = zip(sizes, directions, strict=False)
    return [size for size, direction in pairs if direction == "none"]


def _data_files(header: dict[str, str]) -> list[str]:
    words = header.get("data file", header.get("datafile", "")).split()
    if not words or words[0] == "LIST":
        return []
    if "%" not in words[0] or len(words) < 4:
        return [" ".join(words)]
    first, last, step = (int(word) for word in words[1:4])
    return [words[0] % number for number in range(first, last + (1 if step > 0 else -1), step)]


def _in_mm(volume: LoadedVolume, header: dict[str, str]) -> LoadedVolume:
    named = {unit.lower() for unit in header.get("space units", "").replace('"', " ").split()}
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
