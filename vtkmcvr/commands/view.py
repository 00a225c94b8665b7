"""`vtkmcvr view`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .inputs import add_input_options, read_as_asked
from .options import parse_size
from .scenes import demo_volume, flipped
from .terminal import say_to

if TYPE_CHECKING:
    from ..presets import Dressed

PICTURE = "vtkmcvr-view.png"


def add_view(commands: Any) -> None:
    """Command `view`."""
    view = commands.add_parser("view", help="look at a volume in a window, by light transport")
    add = view.add_argument
    add("input", nargs="?", help="as of `vtkmcvr render`; default: the synthetic CT head")
    add("-o", "--output", help=f"picture that the key k writes, default {PICTURE}")
    add("--preset", metavar="NAME", help="look; default: chosen from the values")
    add("--technique", choices=("monte-carlo", "occlusion", "emission-absorption"),
        default="monte-carlo", help="default: monte-carlo")  # fmt: skip
    add("--size", type=parse_size, default=(1024, 768), metavar="WxH", help="default 1024x768")
    add("--samples", type=int, help="samples per pixel of a picture that is done, default 256")
    add("--seconds", type=float, help="time after which it is done")
    add("--nrms", type=float, help="error at which it is done, such as 0.02")
    add("--exposure", type=float, help="stops; default: the look's")
    add("--threads", type=int, help="default: all CPUs of the process")
    add("--flip", metavar="AXES", help="index axes that run backwards, such as k")
    add("--shift", type=float, help="added to the values to get HU; default: detected")
    add("--whole", action="store_true", help="also what CT looks leave out: table, skin")
    add("--quiet", action="store_true", help="no progress and no report")
    add_input_options(view)
    view.set_defaults(command=_view)


def _view(args: argparse.Namespace) -> int:
    import pyvista as pv

    from ..pictures.picture import check_suffix
    from ..pyvista_hooks.viewer import Viewer

    check_suffix(args.output or PICTURE)
    if not (pv.OFF_SCREEN or pv.system_supports_plotting()):
        raise ValueError(
            "there is no display for a window: set DISPLAY, or use `vtkmcvr render VOLUME -o FILE`"
        )
    dressed = _dressed(args)
    names = ("technique", "samples", "seconds", "nrms", "exposure", "threads")
    asked = {name: getattr(args, name) for name in names if getattr(args, name) is not None}
    viewer = Viewer(dressed, args.output or PICTURE, **asked)
    say = say_to(args)
    for note in (*dressed.notes, *viewer.limits):
        say(f"note: {note}")
    for key, (_, words) in viewer.keys.items():
        say(f"  {key}  {words}")
    say("  q  end")
    viewer.show()
    if args.output:
        viewer.keep()
        say(f"picture: {Path(args.output).resolve()}")
    viewer.close()
    return 0


def _dressed(args: argparse.Namespace) -> Dressed:
    from ..front import scene_of

    data = demo_volume() if args.input is None else read_as_asked(args.input, args)
    return scene_of(
        flipped(data, args.flip), preset=args.preset, size=args.size, shift=args.shift,
        whole=args.whole,
    )  # fmt: skip
