"""Sort the slices of one series into volumes: which belong together, and which are left out."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from .dicom_geometry import (
    ORIENTATION_TOLERANCE,
    SAME_POSITION_MM,
    StackGeometry,
    heights_of,
    judge_stack,
    plane_axes,
)
from .dicom_headers import TRAITS
from .errors import VolumeReadError

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

    from .dicom_headers import Frame
    from .options import ReadOptions

# Traits that name a volume, and clocks that only put the slices at one position into an order.
KINDS = ("image type", "echo time", "b-value", "temporal position", "acquisition number")
CLOCKS = ("trigger time", "frame time", "acquisition time", "instance number")
TIMES = {"temporal position", "acquisition number", *CLOCKS}
SECONDS = {"trigger time": 1e-3, "frame time": 1e-3}


@dataclass(frozen=True)
class Volumes:
    """The volumes of one series, all on one grid.

    Attributes
    ----------
    stacks : list of list of Frame
        The slices of each volume, in the order of their positions.
    geometry : StackGeometry
        The grid.
    times : list of float
        Seconds since the first volume where they are known, else 0, 1, 2 ...
    differ : str
        What differs between volumes that are no time steps.
    notes : list of str
        What was left out.
    """

    stacks: list[list[Frame]]
    geometry: StackGeometry
    times: list[float]
    differ: str
    notes: list[str]


def sort_volumes(frames: Sequence[Frame], label: str, options: ReadOptions) -> Volumes:
    """Sort the slices of one series into volumes on one grid.

    Raises
    ------
    VolumeReadError
        If they are not regular stacks at the same positions.
    """
    kept, noted = _kept(list(frames), label, options)
    plane_axes(_planes(kept), label)
    groups = _positions(kept)
    stacks, differ = [kept], ""
    if len(groups[0]) > 1 and len({len(group) for group in groups}) == 1 and len(groups) > 1:
        stacks, differ = _split(groups)
    if len(stacks) == 1 and len(groups) < len(kept):
        kept = _without_duplicates(groups, label, options, noted)
        stacks = [kept]
    if len(stacks[0]) < 2:
        raise VolumeReadError(
            f"{label} has one slice, which is a 2-D image; give 2 or more at different positions."
        )
    geometry = judge_stack(_planes(stacks[0]), label, resample=options.resample)
    times = _times(stacks, differ)
    ordered = [[stack[k] for k in geometry.order] for stack in stacks]
    choose = "" if set(differ.split(" and ")) <= TIMES else differ
    return Volumes(ordered, geometry, times, choose, noted)


# What is left out


def _kept(frames: list[Frame], label: str, options: ReadOptions) -> tuple[list[Frame], list[str]]:
    noted: list[str] = []
    placed = [frame for frame in frames if frame.plane is not None]
    if len(placed) < len(frames):
        problem = (
            f"{len(frames) - len(placed)} of {len(frames)} slices have no position, orientation "
            "or pixel spacing, so their place is unknown"
        )
        if "unplaced" not in options.ignore or not placed:
            raise VolumeReadError(
                f"{label}: {problem}; give ignore='unplaced' to leave them out, or export the "
                "original series."
            )
        noted.append(f"left out: {problem}")
    filters: tuple[tuple[str, Callable[[Frame], Hashable]], ...] = (
        ("orientations", _orientation),
        ("sizes", _size),
        ("image types", lambda frame: frame.traits[0]),
    )
    for name, key in filters:
        if name in options.ignore:
            most = Counter(map(key, placed)).most_common(1)[0][0]
            left = [frame for frame in placed if key(frame) == most]
            if len(left) < len(placed):
                noted.append(f"{len(placed) - len(left)} slices left out: other {name}")
            placed = left
    _check_sizes(placed, label)
    return placed, noted


def _orientation(frame: Frame) -> Hashable:
    assert frame.plane is not None
    return tuple(round(x / (10 * ORIENTATION_TOLERANCE)) for x in frame.plane.orientation)


def _size(frame: Frame) -> Hashable:
    assert frame.plane is not None
    spacing = tuple(round(x, 4) for x in frame.plane.pixel_spacing)
    return frame.file.rows, frame.file.columns, spacing


def _check_sizes(frames: list[Frame], label: str) -> None:
    sizes = Counter((frame.file.rows, frame.file.columns) for frame in frames)
    if len(sizes) > 1:
        found = ", ".join(f"{count} of {rows} x {cols}" for (rows, cols), count in sizes.items())
        raise VolumeReadError(
            f"{label} has slices of different size ({found}); give ignore='sizes' to keep the "
            "most frequent one."
        )


def _without_duplicates(
    groups: list[list[Frame]], label: str, options: ReadOptions, noted: list[str]
) -> list[Frame]:
    count = sum(map(len, groups)) - len(groups)
    if "duplicates" in options.ignore:
        noted.append(f"{count} slices left out: another one lies at their position")
        return [min(group, key=_instance) for group in groups]
    shared = max(groups, key=len)
    what = " and ".join(_varying(shared, KINDS) or _varying(shared, CLOCKS))
    remedy = "give ignore='duplicates' to keep the first at each position"
    if "image type" in what:
        remedy = f"give ignore='image types' to keep the most frequent image type, or {remedy[5:]}"
    raise VolumeReadError(
        f"{label}: {len(shared)} slices lie at one position (slice {groups.index(shared) + 1} of "
        f"{len(groups)}, {heights_of(_planes(shared))[0]:.2f} mm)"
        f"{f' and differ in {what}' if what else ''}, but a volume has one slice at each; {remedy}."
    )


def _instance(frame: Frame) -> tuple[float, int]:
    return _number(_trait(frame, "instance number")), frame.index


# Volumes that share their positions


def _planes(frames: Sequence[Frame]) -> list[Any]:
    return [frame.plane for frame in frames]


def _positions(frames: list[Frame]) -> list[list[Frame]]:
    """Group slices by their position along the normal, in its order."""
    heights = heights_of(_planes(frames))
    order = np.argsort(heights, kind="stable")
    groups = [[frames[order[0]]]]
    for before, index in pairwise(order):
        if heights[index] - heights[before] > SAME_POSITION_MM:
            groups.append([])
        groups[-1].append(frames[index])
    return groups


def _split(groups: list[list[Frame]]) -> tuple[list[list[Frame]], str]:
    """Return one stack per volume and what differs; or all in one, if nothing tells them apart."""
    count = len(groups[0])
    names = _varying([frame for group in groups for frame in group], KINDS)
    stacks: dict[tuple[str, ...], list[Frame]] = defaultdict(list)
    for group in groups:
        for frame in group:
            stacks[tuple(_trait(frame, name) for name in names)].append(frame)
    if len(stacks) == count and all(len(stack) == len(groups) for stack in stacks.values()):
        keys = sorted(stacks, key=lambda key: [(_number(text), text) for text in key])
        return [stacks[key] for key in keys], " and ".join(names)
    for name in CLOCKS:
        if all(len({_number(_trait(f, name)) for f in group}) == count for group in groups):
            ranked = [sorted(group, key=lambda f: _number(_trait(f, name))) for group in groups]
            return [[group[k] for group in ranked] for k in range(count)], " and ".join(
                [*names, name] if set(names) - TIMES else [name]
            )
    return [[frame for group in groups for frame in group]], ""


def _varying(frames: Sequence[Frame], names: Sequence[str]) -> list[str]:
    return [name for name in names if len({_trait(frame, name) for frame in frames}) > 1]


def _trait(frame: Frame, name: str) -> str:
    return frame.traits[list(TRAITS).index(name)]


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


def _times(stacks: list[list[Frame]], differ: str) -> list[float]:
    """Return the seconds from the first volume, by the clock that tells the volumes apart."""
    for name in ("trigger time", "frame time", "acquisition time"):
        if differ == "temporal position" or name in differ:
            times = [min(_seconds(frame, name) for frame in stack) for stack in stacks]
            if all(later > earlier for earlier, later in pairwise(times)):
                return [round(time - times[0], 6) for time in times]
    return [float(k) for k in range(len(stacks))]


def _seconds(frame: Frame, name: str) -> float:
    text = _trait(frame, name)
    if name in SECONDS:
        return _number(text) * SECONDS[name]
    # A DICOM time of day is hhmmss.ffffff.
    return _number(text[:2]) * 3600 + _number(text[2:4]) * 60 + _number(text[4:])
