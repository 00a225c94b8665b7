"""`vtkmcvr replay`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from .inputs import read_input
from .terminal import Bar, Interrupt, say_to, write_json

DIFFERENT = 1


def add_replay(commands: Any) -> None:
    """Command `replay`."""
    replay = commands.add_parser(
        "replay", help="make a saved picture again from the recipe in it, with the same bits"
    )
    add = replay.add_argument
    add("picture", help="picture that vtkmcvr saved: .png .exr .vti .npz")
    add("-o", "--output", required=True, help="picture: .png .exr .vti .npz")
    add("--input", action="append", default=[], metavar="VOLUME",
        help="volume it was made of; not needed for the synthetic head")  # fmt: skip
    add("--labels", action="append", default=[], metavar="FILE",
        help="segmentation, put onto the grid of the first volume")  # fmt: skip
    add("--series", help="series UID or number, where a DICOM folder holds several")
    add("--environment", action="append", default=[], metavar="MAP",
        help=".hdr or .exr panorama it was lit by")  # fmt: skip
    add("--bits", type=int, choices=(8, 16), default=8, help="of a .png")
    add("--threads", type=int, help="default: all CPUs of the process")
    add("--json", metavar="FILE", help="what was measured")
    add("--quiet", action="store_true", help="no progress and no report")
    replay.set_defaults(command=_replay)


def _replay(args: argparse.Namespace) -> int:
    from ..pictures.picture import check_suffix
    from ..recipes.files import read_recipe
    from ..recipes.replaying import replay

    check_suffix(args.output)
    say = say_to(args)
    recipe = read_recipe(args.picture)
    stop = Interrupt()
    with stop, Bar(args.quiet) as bar:
        picture, identical, notes = replay(
            recipe, _data(args), threads=args.threads, progress=bar, abort=stop.is_set
        )
    picture.save(args.output, bits=args.bits)
    for note in notes:
        say(f"note: {note}")
    say("the same bits" if identical else "NOT the same bits")
    say(f"picture: {Path(args.output).resolve()}")
    write_json(args.json, {**picture.facts(), "identical": identical, "notes": list(notes)})
    return 0 if identical else DIFFERENT


def _data(args: argparse.Namespace) -> list[Any]:
    from ..environment_files import read_environment

    volumes = [read_input(path, args.series) for path in args.input]
    maps = [read_environment(path) for path in args.environment]
    return [*volumes, *_labels(args.labels, volumes), *maps]


def _labels(paths: list[str], volumes: list[Any]) -> list[Any]:
    from ..readers import read_labels
    from ..vtk_bridge.image import grid_image
    from ..vtk_bridge.scene import volume_of

    if paths and not volumes:
        raise ValueError("--labels needs --input: the volume onto whose grid they are put")
    return [read_labels(path, like=grid_image(volume_of(volumes[0]))) for path in paths]
