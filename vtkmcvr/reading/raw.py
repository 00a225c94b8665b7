"""Read a file that has no header, by a layout that the caller gives."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from .compact import compact_values
from .errors import fail
from .source import VolumeSource
from .streams import check_promise, fill, skip, unpacking
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from .options import ReadOptions

TEXT = re.compile(r"(\d+)x(\d+)x(\d+):(\w+)(?::(big|little))?(?::(\d+))?")
NO_SPACING = "no spacing in the file: 1 is assumed; give spacing="
KINDS = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")


@dataclass(frozen=True)
class RawLayout:
    """Layout of voxels in a file without header.

    Attributes
    ----------
    size : sequence of 3 int
        Voxels along i, j and k; i runs fastest.
    dtype : str
        One of uint8, int8, uint16, int16, uint32, int32, float32 and float64.
    byte_order : str
        "little" or "big".
    offset : int
        Bytes before the voxels, after unpacking.
    components : int
        Numbers per voxel, which lie side by side.
    """

    size: tuple[int, int, int]
    dtype: str
    byte_order: str = "little"
    offset: int = 0
    components: int = 1

    def __post_init__(self) -> None:
        size = tuple(self.size)
        if len(size) != 3 or not all(isinstance(n, int) and n > 0 for n in size):
            raise ValueError(f"size of a raw file must be 3 whole numbers above 0, got {size!r}")
        if self.dtype not in KINDS:
            raise ValueError(f"dtype of a raw file must be one of {KINDS}, got {self.dtype!r}")
        if self.byte_order not in {"little", "big"}:
            raise ValueError(f"byte_order must be 'little' or 'big', got {self.byte_order!r}")
        if self.offset < 0 or self.components < 1:
            raise ValueError("offset of a raw file must be 0 or more, components 1 or more")


def raw_layout(given: RawLayout | Mapping[str, Any] | str) -> RawLayout:
    """Return a layout from its parts, or from text such as "256x256x113:uint16:big:512".

    Raises
    ------
    ValueError
        For a layout that makes no sense.
    """
    if isinstance(given, RawLayout):
        return given
    if not isinstance(given, str):
        unknown = sorted(given.keys() - {part.name for part in fields(RawLayout)})
        if unknown or not {"size", "dtype"} <= given.keys():
            raise ValueError(
                "raw must give size and dtype, and may give byte_order, offset and components; "
                f"got {', '.join(map(str, given)) or 'nothing'}"
            )
        return RawLayout(**given)
    match = TEXT.fullmatch(given)
    if match is None:
        raise ValueError(
            f"a raw layout is IxJxK:TYPE[:big|little][:OFFSET], such as 256x256x113:uint16:big; "
            f"got {given!r}"
        )
    size = (int(match[1]), int(match[2]), int(match[3]))
    return RawLayout(size, match[4], match[5] or "little", int(match[6] or 0))


def open_raw(source: Path, options: ReadOptions) -> VolumeSource:
    """Judge a file without header by the layout in `options`.

    Raises
    ------
    VolumeReadError
        If the file is too short for the layout, or no layout is given.
    """
    if options.raw is None:
        fail(
            source,
            "a file without header says nothing about its voxels; give raw={'size': (i, j, k), "
            "'dtype': 'uint8'} and spacing=(x, y, z)",
        )
    layout = raw_layout(options.raw)
    check_dimension(source, layout.size)
    kind = np.dtype(layout.dtype).newbyteorder("<" if layout.byte_order == "little" else ">")
    count = math.prod(layout.size) * layout.components
    packing = {".gz": "gzip", ".bz2": "bzip2"}.get(source.suffix.lower(), "raw")
    check_promise(source, [source], packing, layout.offset + count * kind.itemsize)

    def load(_: int) -> LoadedVolume:
        flat = np.empty(count, kind)
        with source.open("rb") as stream:
            packed = unpacking(stream, packing)
            skip(source, packed, layout.offset)
            fill(source, packed, flat, lambda done: options.progress(done, "reading raw voxels"))
            extra = bool(packed.read(1))
        noted = ["read as raw voxels"]
        if extra:
            noted.append("the file is longer than the layout says")
        shape = (*layout.size[::-1], *([layout.components] if layout.components > 1 else []))
        return LoadedVolume(
            values=compact_values(flat.reshape(shape), noted),
            spacing=np.ones(3),
            origin=np.zeros(3),
            direction=np.eye(3),
            notes=noted if options.spacing is not None else [*noted, NO_SPACING],
        )

    return VolumeSource(size=layout.size, memory=2 * count * kind.itemsize, load=load)
