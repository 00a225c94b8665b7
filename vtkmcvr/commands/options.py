"""Options that commands share, and what they say about bad ones."""

from __future__ import annotations

import argparse
from typing import Any

from .camera_options import add_camera_options
from .cutting import add_cutting_options
from .inputs import add_input_options
from .technique_options import add_technique_options
from .transport_options import add_display_options, add_transport_options

MEASURED = "measured"


def add_scene_options(parser: argparse.ArgumentParser, *, all_times: bool = False) -> None:
    """Everything that decides what is seen."""
    add_input_options(parser, all_times=all_times)
    add = parser.add_argument
    add(
        "--preset",
        metavar="NAME",
        help="look, see `vtkmcvr presets`; or a file: .json, presets.xml#NAME or .vp of 3D "
        "Slicer. Default: chosen from the values",
    )
    add("--size", type=parse_size, default=(800, 600), metavar="WxH", help="default 800x600")
    add("--threads", type=int, help="default: all CPUs of the process")
    add("--view", help="front back left right top bottom: side of the patient seen")
    add("--azimuth", type=float, help="degrees around the volume, to the right")
    add("--elevation", type=float, help="degrees up")
    add("--roll", type=float, help="degrees clockwise")
    add("--zoom", type=float, help="2 shows half the height")
    add(
        "--flip",
        metavar="AXES",
        help="index axes that run backwards, such as k; for files that "
        "do not say which way they were stored",
    )
    add("--shift", type=float, help="added to the values to get HU; default: detected")
    add("--whole", action="store_true", help="also what CT looks leave out: table, skin")
    add("--overlay", metavar="VOLUME", help="a second volume in the same world, as PET over CT")
    add("--overlay-preset", metavar="NAME", help="its look; default: chosen from its values")
    add("--environment", metavar="MAP", help="light by this .hdr or .exr panorama instead")
    add_camera_options(parser)
    add_transport_options(parser)
    add_cutting_options(parser)
    add("--quiet", action="store_true", help="no progress and no report")


def add_render_options(parser: argparse.ArgumentParser) -> None:
    """Everything that decides a picture."""
    add_scene_options(parser, all_times=True)
    add = parser.add_argument
    add_technique_options(parser)
    add("--samples", type=int, help="samples per pixel, default 64")
    add("--seconds", type=float, help="time to render; the first limit that is met ends the render")
    add("--nrms", type=float, help="error to reach, such as 0.02")
    add(
        "--adaptive",
        action="store_true",
        help="samples go where a short pilot sees noise; --samples is then the mean",
    )
    add("--seed", type=int, default=0)
    add("--backend", choices=("auto", "cpu", "cuda"), default="auto",
        help="who renders; auto: a CUDA device where there is one")  # fmt: skip
    add("--exposure", type=float, help="stops; default: the look's")
    add(
        "--background",
        type=_background,
        default="preset",
        metavar="COLOUR",
        help="transparent, or sRGB as #rrggbb",
    )
    add_display_options(parser)
    add("--bits", type=int, choices=(8, 16), default=8, help="of a .png")
    add("--denoise", choices=("knn", "oidn"), help="reduce noise, at a bias; the report says so")
    add("--aovs", action="store_true", help="also albedo and normal, in .exr, .vti and .npz")
    add(
        "--dry-run",
        action="store_true",
        help="predict samples, time and memory for --nrms (0.01) from a short pilot; no picture",
    )
    add(
        "--explain",
        nargs="?",
        const="reasons",
        choices=("reasons", MEASURED),
        help="say which effects were simulated and why; measured: and what each of them costs, by "
        "rendering the scene without it",
    )
    add("--report", metavar="FILE", help="page about the picture, its error and its cost: .html")
    add("--json", metavar="FILE", help="what was measured")


def parse_size(text: str) -> tuple[int, int]:
    """Return width and height of text such as 800x600."""
    try:
        width, height = (int(part) for part in text.lower().split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"size is WIDTHxHEIGHT in pixels, got {text!r}") from None
    return width, height


def _background(text: str) -> Any:
    if text in ("transparent", "preset"):
        return text
    try:
        number = int(text.removeprefix("#"), 16)
        if len(text.removeprefix("#")) != 6:
            raise ValueError
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"background is transparent or a colour like #202428, got {text!r}"
        ) from None
    return tuple((number >> shift & 255) / 255 for shift in (16, 8, 0))
