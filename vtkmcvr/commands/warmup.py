"""`vtkmcvr warmup`."""

from __future__ import annotations

import argparse
from typing import Any

from .terminal import say_to


def add_warmup(commands: Any) -> None:
    """Command `warmup`."""
    warmup = commands.add_parser(
        "warmup", help="compile the kernels of all looks ahead, as for a container image"
    )
    add = warmup.add_argument
    add("--types", default="int16,uint8", metavar="TYPES",
        help="of voxels: uint8, int16, uint16, float32; default int16,uint8")  # fmt: skip
    add("--presets", metavar="NAMES", help="such as ct-bone,solid; default: all looks")
    add("--aovs", action="store_true", help="for pictures with albedo and normal")
    add("--quiet", action="store_true", help="no report")
    warmup.set_defaults(command=_warmup)


def _warmup(args: argparse.Namespace) -> int:
    from ..scene import AOVS
    from ..warming import warm_up

    say = say_to(args)
    count = warm_up(
        args.types.split(","), args.presets and args.presets.split(","),
        aovs=AOVS if args.aovs else (),
        report=lambda words, seconds: say(f"{words}: {seconds:.1f} s"),
    )  # fmt: skip
    say(f"{count} sets of kernels are in the cache")
    return 0
