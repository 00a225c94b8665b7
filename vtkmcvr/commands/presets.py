"""`vtkmcvr presets`."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .inputs import add_input_options, read_as_asked
from .options import parse_size
from .scenes import demo_volume, flipped
from .terminal import Bar, Interrupt, say_to

if TYPE_CHECKING:
    from ..presets import Look


def add_presets(commands: Any) -> None:
    """Command `presets`."""
    presets = commands.add_parser(
        "presets", help="list the looks, export one, or make thumbnails of them"
    )
    add = presets.add_argument
    add("look", nargs="?", help="one look, or a file of looks; default: all of them")
    add(
        "-o",
        "--output",
        metavar="PATH",
        help="LOOK.json: write the look; or a folder: a thumbnail of each",
    )
    add("--input", metavar="VOLUME", help="what thumbnails show; default: the synthetic CT head")
    add("--size", type=parse_size, default=(240, 240), metavar="WxH", help="default 240x240")
    add("--samples", type=int, default=64, help="samples per pixel, default 64")
    add("--threads", type=int, help="default: all CPUs of the process")
    add("--flip", metavar="AXES", help="index axes that run backwards, such as k")
    add("--quiet", action="store_true", help="no progress and no report")
    add_input_options(presets)
    presets.set_defaults(command=_presets)


def _presets(args: argparse.Namespace) -> int:
    from ..presets import write_look

    looks = _asked(args.look)
    if args.output is None:
        _list(looks)
        return 0
    if Path(args.output).suffix.lower() != ".json":
        return _thumbnails(looks, args)
    if len(looks) != 1:
        raise ValueError(f"a .json file holds one look: name one of {', '.join(_names(looks))}")
    write_look(looks[0], args.output)
    say_to(args)(f"look: {Path(args.output).resolve()}")
    return 0


def _asked(name: str | None) -> list[Look]:
    """Look by name, looks of a file, or all."""
    from ..presets import LOOKS, look_named, read_look, read_looks
    from ..presets.files import names_file

    if name is None:
        return list(LOOKS.values())
    if name not in LOOKS and names_file(name):
        return [read_look(name)] if "#" in name else read_looks(name)
    return [look_named(name)]


def _list(looks: list[Look]) -> None:
    width = max(map(len, _names(looks)))
    for look in looks:
        print(f"{look.name:<{width}}  {look.units:<9}  {look.about}")


def _names(looks: Iterable[Look]) -> list[str]:
    return [look.name for look in looks]


def _thumbnails(looks: list[Look], args: argparse.Namespace) -> int:
    """Write a picture of each look; returns the exit status."""
    from ..front import render

    data = demo_volume() if args.input is None else read_as_asked(args.input, args)
    data = flipped(data, args.flip)
    folder = Path(args.output)
    folder.mkdir(parents=True, exist_ok=True)
    say = say_to(args)
    stop = Interrupt()
    with stop, Bar(args.quiet) as bar:
        for number, look in enumerate(looks):
            bar.show(number / len(looks), look.name)
            if look.units == "labels" and args.input is None:
                say(f"{look.name}: needs a label map, give one by --input")
                continue
            picture = render(
                data, preset=look, size=args.size, samples=args.samples, threads=args.threads,
                abort=stop.is_set,
            )  # fmt: skip
            path = folder / f"{_file_name(look.name)}.png"
            picture.save(path)
            say(f"{path}  {picture.recipe['notes'][0]}")
            if stop.is_set():
                break
    return 0


def _file_name(name: str) -> str:
    """Return a name of a look without what a path would take amiss."""
    return "".join(c if c.isalnum() or c in "-_." else "-" for c in name).lstrip(".") or "look"
