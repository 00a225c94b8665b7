"""The header of a NRRD file: what its axes are and where they lie."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .data_files import data_file
from .errors import fail

if TYPE_CHECKING:
    from numpy.typing import NDArray

LINE_LIMIT = 1 << 20
HEADER_LIMIT = 1 << 22
PAIR = re.compile(r"([^:]*):=(.*)")
TYPES = {
    "int8": ("signed char", "int8", "int8_t"),
    "uint8": ("uchar", "unsigned char", "uint8", "uint8_t"),
    "int16": ("short", "short int", "signed short", "signed short int", "int16", "int16_t"),
    "uint16": ("ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"),
    "int32": ("int", "signed int", "int32", "int32_t"),
    "uint32": ("uint", "unsigned int", "uint32", "uint32_t"),
    "int64": (
        "longlong", "long long", "long long int", "signed long long", "signed long long int",
        "int64", "int64_t",
    ),
    "uint64": (
        "ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t",
    ),
    "float32": ("float",),
    "float64": ("double",),
}  # fmt: skip
ENCODINGS = {
    "raw": "raw", "txt": "ascii", "text": "ascii", "ascii": "ascii", "hex": "hex", "gz": "gzip",
    "gzip": "gzip", "bz2": "bzip2", "bzip2": "bzip2",
}  # fmt: skip
SPATIAL_KINDS = {"domain", "space"}
VOLUME_KINDS = {"time", "list", "none", "???", ""}
SHORT_SPACES = {
    "ras": "right-anterior-superior",
    "las": "left-anterior-superior",
    "lps": "left-posterior-superior",
}
LPS_SIGN = {
    "left": 1.0, "right": -1.0, "posterior": 1.0, "anterior": -1.0, "superior": 1.0,
    "inferior": -1.0,
}  # fmt: skip


@dataclass
class NrrdHeader:
    """What a NRRD header says, checked.

    `spatial`, `component` and `volume` are axis numbers; the first axis runs fastest.
    `directions` has one column of mm in LPS per spatial axis.
    """

    path: Path
    fields: dict[str, str]
    pairs: dict[str, str]
    data_start: int
    kind: np.dtype = field(default_factory=lambda: np.dtype(np.uint8))
    encoding: str = "raw"
    sizes: list[int] = field(default_factory=list)
    spatial: list[int] = field(default_factory=list)
    component: int | None = None
    volume: list[int] = field(default_factory=list)
    directions: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    origin: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    files: list[Path] = field(default_factory=list)
    line_skip: int = 0
    byte_skip: int = 0
    notes: list[str] = field(default_factory=list)

    def bytes_of_voxels(self) -> int:
        """Return the size of the unpacked data."""
        return int(np.prod(self.sizes, dtype=object)) * self.kind.itemsize


def read_nrrd_header(source: Path) -> NrrdHeader:
    """Read and judge the header of a .nrrd or .nhdr file.

    Raises
    ------
    VolumeReadError
        If it is damaged, or describes no 3-D volume.
    ValueError
        For numbers that are none.
    """
    header = _parse(source)
    fields = header.fields
    kind = fields.get("type", "").lower()
    names = [name for name, spellings in TYPES.items() if kind in spellings]
    if not names:
        fail(source, f"unknown type of voxels {kind[:40]!r}; save it as a type of numbers")
    header.kind = np.dtype(names[0])
    if fields.get("endian", "little").lower() != "little":
        header.kind = header.kind.newbyteorder(">")
    encoding = fields.get("encoding", "").lower()
    if encoding not in ENCODINGS:
        fail(source, f"unknown encoding {encoding[:40]!r}; allowed are {', '.join(ENCODINGS)}")
    header.encoding = ENCODINGS[encoding]
    header.line_skip = int(fields.get("line skip", fields.get("lineskip", "0")))
    header.byte_skip = int(fields.get("byte skip", fields.get("byteskip", "0")))
    if header.line_skip < 0 or header.byte_skip < -1:
        fail(
            source,
            f"its header has a byte skip of {header.byte_skip} and a line skip of "
            f"{header.line_skip}; allowed are -1 and more, and 0 and more",
        )
    _judge_axes(header)
    _place(header)
    _find_files(header)
    return header


def _parse(source: Path) -> NrrdHeader:
    fields: dict[str, str] = {}
    pairs: dict[str, str] = {}
    with source.open("rb") as stream:
        if stream.read(4) != b"NRRD":
            fail(source, "not a NRRD file (its first letters are not 'NRRD'); check the file")
        stream.readline(LINE_LIMIT)
        length = 0
        while raw := stream.readline(LINE_LIMIT):
            line = raw.decode("utf-8", errors="replace").rstrip("\r\n")
            length += len(raw)
            if length > HEADER_LIMIT:
                fail(source, f"its header is longer than {HEADER_LIMIT} bytes; check the file")
            if not line.strip():
                break
            if line.startswith("#"):
                continue
            if _take_line(line, fields, pairs) == "LIST":
                # The names of the files follow up to the end.
                fields["list"] = stream.read(HEADER_LIMIT).decode("utf-8", errors="replace")
                break
        return NrrdHeader(source, fields, pairs, stream.tell())


def _take_line(line: str, fields: dict[str, str], pairs: dict[str, str]) -> str:
    """Put a line where it belongs, and return the first word of a line that names data files."""
    pair = PAIR.match(line)
    if pair:
        pairs[pair[1].strip()] = pair[2].strip()
        return ""
    name, separator, value = line.partition(":")
    name = name.strip().lower()
    if separator:
        fields[name] = value.strip()
    return (value.split() or [""])[0] if name in {"data file", "datafile"} else ""


def _judge_axes(header: NrrdHeader) -> None:
    fields, source = header.fields, header.path
    header.sizes = [int(word) for word in fields.get("sizes", "").split()]
    count = int(fields.get("dimension", "0"))
    if count != len(header.sizes) or not 1 <= count <= 16 or min(header.sizes) < 1:
        raise ValueError("sizes do not fit the dimension")
    kinds = fields.get("kinds", "").lower().split() or [""] * count
    vectors = _vectors(fields.get("space directions", ""))
    if len(kinds) != count or (vectors and len(vectors) != count):
        raise ValueError("kinds or directions do not fit the dimension")
    plain = [k for k, kind in enumerate(kinds) if kind in SPATIAL_KINDS | VOLUME_KINDS - {"time"}]
    header.spatial = [k for k, v in enumerate(vectors) if v is not None] if vectors else plain[:3]
    others = [k for k in range(count) if k not in header.spatial]
    components = [k for k in others if kinds[k] not in SPATIAL_KINDS | VOLUME_KINDS]
    header.volume = [k for k in others if k not in components]
    if len(header.spatial) < 3 or len(components) > 1:
        flat = len(header.spatial) < 3
        what = f"a {len(header.spatial)}-D image" if flat else "an image of tensors"
        fail(source, f"{what} is not a volume; give a file with 3 dimensions")
    if len(header.spatial) > 3:
        raise ValueError("more than 3 directions in space")
    header.component = components[0] if components else None


def _vectors(text: str) -> list[list[float] | None]:
    found = re.findall(r"\(([^)]*)\)|\bnone\b", text)
    vectors = [[float(word) for word in inside.split(",")] if inside else None for inside in found]
    if any(vector is not None and len(vector) == 4 for vector in vectors):
        # Of a space with time, only the part in space has a place here.
        parts = [None if vector is None else vector[:3] for vector in vectors]
        return [part if part and (any(part) or len(parts) == 1) else None for part in parts]
    return vectors


def _place(header: NrrdHeader) -> None:
    fields = header.fields
    vectors = _vectors(fields.get("space directions", ""))
    origin = _vectors(fields.get("space origin", ""))
    if vectors:
        columns = [vectors[axis] for axis in header.spatial]
        header.directions = np.array(columns, dtype=np.float64).T
    else:
        header.directions = np.diag(_spacings(header))
    if header.directions.shape != (3, 3):
        raise ValueError("the space does not have 3 dimensions")
    if origin and origin[0] is not None:
        header.origin = np.array(origin[0], dtype=np.float64)
    elif "axis mins" in fields:
        mins = [float(word) for word in fields["axis mins"].split()]
        header.origin = np.nan_to_num(np.array([mins[axis] for axis in header.spatial]))
    if header.origin.shape != (3,):
        raise ValueError("the space does not have 3 dimensions")
    sign = _signs(header)[:, None]
    header.directions, header.origin = sign * header.directions, sign[:, 0] * header.origin


def _spacings(header: NrrdHeader) -> list[float]:
    given = [float(word) for word in header.fields.get("spacings", "").split()]
    if not given:
        header.notes.append("no spacing in the file: 1 is assumed")
        return [1.0, 1.0, 1.0]
    chosen = [given[axis] for axis in header.spatial]
    return [1.0 if np.isnan(step) else step for step in chosen]


def _signs(header: NrrdHeader) -> NDArray[np.float64]:
    space = header.fields.get("space", "").lower()
    space = SHORT_SPACES.get(space.removesuffix("t"), space) if len(space) <= 4 else space
    words = space.removesuffix("-time").split("-")
    if len(words) == 3 and all(word in LPS_SIGN for word in words):
        return np.array([LPS_SIGN[word] for word in words])
    header.notes.append("no anatomical space in the file: its axes are taken as LPS")
    if "left-handed" in space:
        header.notes.append("its space is left-handed: if the picture is mirrored, flip one axis")
    return np.ones(3)


def _find_files(header: NrrdHeader) -> None:
    fields, source = header.fields, header.path
    words = fields.get("data file", fields.get("datafile", "")).split()
    if not words:
        header.files = [source]
        return
    if words[0] == "LIST":
        names = [name.strip() for name in fields.get("list", "").splitlines() if name.strip()]
    elif "%" in words[0] and len(words) >= 4:
        first, last, step = (int(word) for word in words[1:4])
        if step == 0 or abs(last - first) // abs(step) > 10**6:
            raise ValueError("the list of data files has no end")
        numbers = range(first, last + (1 if step > 0 else -1), step)
        names = [words[0] % number for number in numbers]
    else:
        names = [" ".join(words)]
    header.data_start = 0
    header.files = [data_file(source, name) for name in names]
    if not header.files:
        fail(source, "its list of data files is empty; write the names below 'data file: LIST'")
