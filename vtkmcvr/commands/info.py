"""`vtkmcvr info`."""

from __future__ import annotations

import argparse
from typing import Any

from .inputs import read_input
from .terminal import write_json


def add_info(commands: Any) -> None:
    """Command `info`."""
    info = commands.add_parser("info", help="what a volume holds and what the reader noticed")
    info.add_argument("input")
    info.add_argument("--series", help="series UID or number, where a folder holds several")
    info.add_argument("--json", metavar="FILE", help="the same as JSON")
    info.set_defaults(command=_info)


def _info(args: argparse.Namespace) -> int:
    from ..volume_info import format_info, volume_info

    info = volume_info(read_input(args.input, args.series))
    print(format_info(info))
    write_json(args.json, info)
    return 0
