"""`vtkmcvr cost`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from .inputs import read_input
from .options import add_scene_options
from .terminal import Bar, Interrupt, say_to


def add_cost(commands: Any) -> None:
    """Command `cost`."""
    cost = commands.add_parser(
        "cost", help="measure what accuracy costs in time, on your own scene"
    )
    cost.add_argument("input", help="volume, as for render; or demo for the synthetic head")
    cost.add_argument("-o", "--output", required=True, metavar="FOLDER")
    cost.add_argument(
        "--budget", type=_duration, default=60.0, metavar="60s", help="time to spend: 90s, 5m, 1h"
    )
    cost.add_argument("--no-figures", action="store_true", help="write no figures")
    add_scene_options(cost)
    cost.set_defaults(command=_cost)


def _duration(text: str) -> float:
    unit = {"s": 1.0, "m": 60.0, "h": 3600.0}.get(text[-1:], None)
    number = text if unit is None else text[:-1]
    try:
        value = float(number) * (unit or 1.0)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"a time is written like 90s, 5m or 1h; got {text!r}")
    return value
