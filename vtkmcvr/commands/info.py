"""`vtkmcvr info`."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from typing import Any

from .inputs import add_input_options, read_as_asked
from .terminal import write_json


def add_info(commands: Any) -> None:
    """Command `info`."""
    info = commands.add_parser("info", help="what a volume holds and what the reader noticed")
    info.add_argument("input")
    info.add_argument(
        "--list",
        action="store_true",
        help="the DICOM series, with descriptions, which may name the patient",
    )
    add_input_options(info)
    info.add_argument("--json", metavar="FILE", help="the same as JSON")
    info.set_defaults(command=_info)


def _info(args: argparse.Namespace) -> int:
    from ..volume_info import volume_info
    from .info_page import format_info

    if args.list:
        return _list(args)
    info = volume_info(read_as_asked(args.input, args))
    print(format_info(info))
    write_json(args.json, info)
    return 0


def _list(args: argparse.Namespace) -> int:
    from ..readers import list_series

    found = list_series(args.input)
    for series in found:
        number = "-" if series.number is None else series.number
        size = f"{series.slices} slices of {series.rows} x {series.columns}"
        print(f"{number:>6} {series.modality:<4} {size:<30} {series.description}  {series.uid}")
    if not found:
        print("no DICOM series")
    write_json(args.json, {"series": [asdict(series) for series in found]})
    return 0
