"""Volumes named on the command line."""

from __future__ import annotations

import argparse
from typing import Any

from .terminal import Bar


def add_input_options(parser: argparse.ArgumentParser, *, all_times: bool = False) -> None:
    """Which part of a source is read, and how."""
    add = parser.add_argument
    add("--series", help="DICOM series: number, UID or part of the description")
    times = "volume of 4-D data, from 0" + ("; all: one picture or frame each" if all_times else "")
    add("--time", type=_time, metavar="N", help=times)
    add("--resample", action="store_true", help="make uneven, incomplete or tilted stacks a box")
    add(
        "--ignore",
        action="append",
        metavar="WHAT",
        help="leave out of a DICOM series: damaged, duplicates, image-types, orientations, sizes "
        "(but the most frequent) or unplaced; may be given again",
    )
    add("--units", help="suv: PET as standardised uptake value")
    add("--raw", metavar="LAYOUT", help="of a file without header: IxJxK:TYPE[:big][:OFFSET]")
    add("--spacing", type=_spacing, metavar="X,Y,Z", help="of voxels in mm, instead of the file's")


def input_options(args: argparse.Namespace) -> dict[str, Any]:
    """Keyword arguments of `vtkmcvr.read` from the options above."""
    names = ("series", "time", "resample", "ignore", "units", "raw", "spacing", "threads")
    options = {name: getattr(args, name, None) for name in names}
    series = options["series"]
    options["series"] = int(series) if series is not None and series.isdigit() else series
    return {name: value for name, value in options.items() if value is not None}


def read_as_asked(path: str, args: argparse.Namespace, **changed: Any) -> Any:
    """Volume of a path, read as the input options say but for what is changed."""
    from ..readers import read_vtk

    options = input_options(args) | changed
    if options.get("time") == "all":
        raise ValueError("--time all is for `vtkmcvr render`; give the number of one volume")
    with Bar(getattr(args, "quiet", False)) as bar:
        return read_vtk(path, progress=bar.show, **options)


def read_input(path: str, series: str | None) -> Any:
    """Volume of a path; `series` is a number, a UID or part of the description."""
    return read_as_asked(path, argparse.Namespace(series=series))


def _time(text: str) -> int | str:
    if text == "all":
        return text
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"time is a number from 0, or all; got {text!r}") from None


def _spacing(text: str) -> tuple[float, ...]:
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3:
        raise argparse.ArgumentTypeError(f"spacing is X,Y,Z in mm, got {text!r}")
    return numbers
