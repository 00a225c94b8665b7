"""A volume that was found and judged by its header, before its voxels are read."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .errors import fail

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from .volume import LoadedVolume


@dataclass(frozen=True)
class VolumeSource:
    """What a header promises.

    Attributes
    ----------
    size : sequence of 3 int
        Voxels along i, j and k.
    memory : int
        Bytes that reading takes at its peak.
    load : callable
        Takes the index of the volume in a 4-D source and reads it.
    times : sequence of float
        One value per volume of a 4-D source: seconds where they are known, else 0, 1, 2 ...
    choose : str
        For a 4-D source whose volumes are no time steps: what differs between them. Then the
        caller must choose one.
    """

    size: Sequence[int]
    memory: int
    load: Callable[[int], LoadedVolume]
    times: Sequence[float] = (0.0,)
    choose: str = ""


def chosen_volume(path: Path, source: VolumeSource, time: int | None) -> int:
    """Return the index of the volume to read.

    Raises
    ------
    VolumeReadError
        If there is no such volume, or the caller has to choose.
    """
    count = len(source.times)
    if time is None and source.choose:
        fail(
            path,
            f"{count} volumes that share their positions and differ in {source.choose}; choose "
            f"one with time=0 to time={count - 1}",
        )
    index = time or 0
    if index >= count:
        allowed = f"0 to {count - 1}" if count > 1 else "only 0"
        fail(path, f"there is no volume with time={index}; allowed is {allowed}")
    return index


def time_notes(source: VolumeSource, index: int) -> list[str]:
    """Say which volume of a 4-D source was read."""
    count = len(source.times)
    if count == 1:
        return []
    what = f"volumes that differ in {source.choose}" if source.choose else "time steps"
    return [f"volume {index} of 0 to {count - 1} read ({what}); choose another with time="]


def check_memory(path: Path, source: VolumeSource) -> None:
    """Refuse a volume that does not fit into the memory that is free now.

    Raises
    ------
    VolumeReadError
        If more memory is needed than is free.
    """
    check_bytes(path, source.memory, " x ".join(str(n) for n in source.size))


def check_bytes(path: Path, needed: int, size: str) -> None:
    """Refuse what does not fit into the memory that is free now; `size` says how large it is.

    Raises
    ------
    VolumeReadError
        If more memory is needed than is free.
    """
    free = free_memory()
    if free is not None and needed > free:
        fail(
            path,
            f"reading {size} voxels takes {amount(needed)} of memory and {amount(free)} are "
            "free; close other programs, or crop or downsample the volume",
        )


def amount(count: int) -> str:
    """Return a number of bytes in words, such as "524 MB" (10**6 bytes)."""
    for unit, size in (("TB", 10**12), ("GB", 10**9), ("MB", 10**6)):
        if count >= size:
            return f"{count / size:.3g} {unit}"
    return f"{max(count, 1000) / 1000:.3g} kB"


def free_memory() -> int | None:
    """Return the bytes of memory that are free for this process, or None if unknown."""
    try:
        with open("/proc/meminfo", encoding="ascii") as stream:
            for line in stream:
                if line.startswith("MemAvailable:"):
                    return int(line.split()[1]) * 1024
    except (OSError, ValueError):
        pass
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        return None
