"""`vtkmcvr cost`."""

from __future__ import annotations

import argparse
from typing import Any

from .inputs import read_as_asked
from .options import add_scene_options
from .scenes import demo_volume, flipped, scene_options
from .terminal import Bar, Interrupt, say_to


def add_cost(commands: Any) -> None:
    """Command `cost`."""
    cost = commands.add_parser(
        "cost", help="measure what accuracy costs in time, on your own scene"
    )
    cost.add_argument("input", help="volume, as for render; or demo for the synthetic head")
    cost.add_argument("-o", "--output", required=True, metavar="FOLDER")
    cost.add_argument(
        "--budget", type=duration, default=60.0, metavar="60s", help="time to spend: 90s, 5m, 1h"
    )
    cost.add_argument("--no-figures", action="store_true", help="write no figures")
    add_scene_options(cost)
    cost.set_defaults(command=_cost)


def duration(text: str) -> float:
    """Seconds of a time like 90s, 5m or 1h."""
    unit = {"s": 1.0, "m": 60.0, "h": 3600.0}.get(text[-1:], None)
    number = text if unit is None else text[:-1]
    try:
        value = float(number) * (unit or 1.0)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"a time is written like 90s, 5m or 1h; got {text!r}")
    return value


def _cost(args: argparse.Namespace) -> int:
    from ..costs.study import study
    from ..front import scene_of

    say = say_to(args)
    data = demo_volume() if args.input == "demo" else read_as_asked(args.input, args)
    data = flipped(data, args.flip)
    scene = scene_of(data, **scene_options(data, args)).scene
    stop = Interrupt()
    with stop, Bar(args.quiet) as bar:
        found = study(
            scene, args.budget, folder=args.output, threads=args.threads, abort=stop.is_set,
            progress=lambda done, of, name: bar.show(done / of, name),
        )  # fmt: skip
    written = [found.write(args.output)]
    if not args.no_figures:
        written += found.draw(args.output)
    say(str(found))
    for path in written:
        say(f"written: {path}")
    return 0
