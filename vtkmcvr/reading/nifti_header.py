"""The header of a NIfTI-1 or NIfTI-2 file: type, size, place in the world, label table."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import fail

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from ..recorded_facts import Segment

TYPES = {
    2: "u1", 4: "i2", 8: "i4", 16: "f4", 64: "f8", 128: "3u1", 256: "i1", 512: "u2", 768: "u4",
    1024: "i8", 1280: "u8", 2304: "4u1",
}  # fmt: skip
MM_PER_UNIT = {1: ("m", 1000.0), 3: ("um", 1e-3)}
SECONDS_PER_UNIT = {8: 1.0, 16: 1e-3, 24: 1e-6}
VECTOR_INTENT = 1007
LABEL_INTENT = 1002
EXTENSION_LIMIT = 1 << 24
HALF_TURN = 1e-7


@dataclass
class NiftiHeader:
    """What a NIfTI header says, in mm and LPS.

    `size` has the voxels along i, j and k; `components` and `volumes` count the rest.
    """

    size: list[int]
    components: int
    volumes: int
    kind: np.dtype
    offset: int
    slope: float
    intercept: float
    directions: NDArray[np.float64]
    origin: NDArray[np.float64]
    time_step: float
    is_pair: bool
    is_labels: bool
    notes: list[str] = field(default_factory=list)
    segments: list[Segment] = field(default_factory=list)

    def volume_bytes(self) -> int:
        """Return the size of one volume, unpacked."""
        return int(np.prod(self.size, dtype=object)) * self.components * self.kind.itemsize


@dataclass(frozen=True)
class _Layout:
    """Where the fields of one version lie, and their types."""

    length: int
    dim: tuple[str, int]
    datatype: int
    pixdim: tuple[str, int]
    offset: tuple[str, int]
    slope: tuple[str, int]
    codes: tuple[str, int]
    quaternion: tuple[str, int]
    rows: tuple[str, int]
    units: tuple[str, int]
    intent: tuple[str, int]
    magic: tuple[int, tuple[bytes, bytes]]


NIFTI_1 = _Layout(
    348, ("8h", 40), 70, ("8f", 76), ("f", 108), ("2f", 112), ("2h", 252), ("6f", 256),
    ("12f", 280), ("b", 123), ("h", 68), (344, (b"n+1", b"ni1")),
)  # fmt: skip
NIFTI_2 = _Layout(
    540, ("8q", 16), 12, ("8d", 104), ("q", 168), ("2d", 176), ("2i", 344), ("6d", 352),
    ("12d", 400), ("i", 500), ("i", 504), (4, (b"n+2", b"ni2")),
)  # fmt: skip


def read_nifti_header(source: Path, head: bytes) -> NiftiHeader:
    """Judge the first 540 or more bytes of a NIfTI file.

    Raises
    ------
    VolumeReadError
        If it is no NIfTI file or has voxels of an unsupported kind.
    ValueError
        For a size that is none.
    struct.error
        If the header is cut off.
    """
    layout, order = _layout(source, head)

    def get(place: tuple[str, int]) -> Any:
        return struct.unpack_from(order + place[0], head, place[1])

    dims = get(layout.dim)
    if not 1 <= dims[0] <= 7 or min(dims[1 : 1 + dims[0]], default=0) < 1:
        raise ValueError("dimensions")
    sizes = [*dims[1 : 1 + dims[0]], 1, 1, 1, 1][: max(dims[0], 5)]
    code = get(("h", layout.datatype))[0]
    if code not in TYPES:
        fail(
            source,
            f"NIfTI voxels of type {code} (complex or long double) are not supported; save them "
            "as float",
        )
    name = TYPES[code]
    colours = int(name[0]) if len(name) == 3 else 1
    intent = get(layout.intent)[0]
    vector = intent == VECTOR_INTENT and sizes[3] == 1 and colours == 1
    rest = int(np.prod(sizes[3:], dtype=object))
    slope, intercept = get(layout.slope)
    codes = get(layout.codes)
    pixdim = get(layout.pixdim)
    unit = get(layout.units)[0]
    header = NiftiHeader(
        size=list(sizes[:3]),
        components=rest if vector else colours,
        volumes=1 if vector else rest,
        kind=np.dtype(order + name[-2:]),
        offset=_offset(get(layout.offset)[0]),
        slope=slope if np.isfinite(slope) and slope else 1.0,
        intercept=intercept if np.isfinite(slope) and slope and np.isfinite(intercept) else 0.0,
        directions=np.eye(3),
        origin=np.zeros(3),
        time_step=_time_step(pixdim[4], unit),
        is_pair=head[layout.magic[0] :][:3] == layout.magic[1][1],
        is_labels=intent == LABEL_INTENT,
    )
    _place(header, codes, pixdim, get(layout.quaternion), np.reshape(get(layout.rows), (3, 4)))
    _to_mm(header, unit & 7)
    return header


def extension_text(head: bytes, offset: int) -> str:
    """Return what lies between a header that is no pair and its voxels, as text."""
    length = 540 if len(head) > 4 and head[4:7] == b"n+2" else 348
    return head[length : min(offset, EXTENSION_LIMIT)].decode("utf-8", errors="replace")


def _layout(source: Path, head: bytes) -> tuple[_Layout, str]:
    for layout in (NIFTI_1, NIFTI_2):
        place, marks = layout.magic
        for order in "<>":
            if head[:4] == struct.pack(order + "i", layout.length):
                if head[place : place + 3] in marks and len(head) >= layout.length:
                    return layout, order
    fail(source, "not a NIfTI file (its header is damaged); export it again")


def _offset(value: float) -> int:
    if not np.isfinite(value) or value < 0:
        raise ValueError("offset")
    return int(value)


def _time_step(step: float, unit: int) -> float:
    seconds = SECONDS_PER_UNIT.get(unit & 56)
    return step * seconds if seconds and np.isfinite(step) and step > 0 else 1.0


def _place(
    header: NiftiHeader, codes: Any, pixdim: Any, quaternion: Any, rows: NDArray[np.float64]
) -> None:
    """Place the voxels by the affine matrix, else by the quaternion; NIfTI worlds are RAS."""
    steps = np.abs(np.array(pixdim[1:4], dtype=np.float64))
    if codes[1] > 0:
        ras, origin = rows[:, :3].astype(np.float64), rows[:, 3].astype(np.float64)
    elif codes[0] > 0:
        ras = _rotation(*quaternion[:3]) * steps
        ras[:, 2] *= -1.0 if pixdim[0] < 0 else 1.0
        origin = np.array(quaternion[3:], dtype=np.float64)
    else:
        header.notes.append("the file says nothing about left and right: LPS axes are assumed")
        header.directions = np.diag(steps)
        return
    lps = np.array([-1.0, -1.0, 1.0])
    header.directions, header.origin = lps[:, None] * ras, lps * origin


def _rotation(b: float, c: float, d: float) -> NDArray[np.float64]:
    """Return the rotation of a unit quaternion given without its real part."""
    square = b * b + c * c + d * d
    if square > 1.0 - HALF_TURN:
        # The real part is lost in the rounding of float32: a half turn.
        b, c, d = (x / square**0.5 for x in (b, c, d))
        square = 1.0
    a = (1.0 - square) ** 0.5
    return np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
        ]
    )


def _to_mm(header: NiftiHeader, unit: int) -> None:
    if unit in MM_PER_UNIT:
        name, factor = MM_PER_UNIT[unit]
        header.directions, header.origin = header.directions * factor, header.origin * factor
        header.notes.append(f"lengths converted from {name} to mm")
