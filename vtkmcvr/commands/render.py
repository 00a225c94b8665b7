"""`vtkmcvr demo` and `vtkmcvr render`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from .camera_options import camera_options
from .inputs import read_as_asked
from .options import add_render_options
from .terminal import Bar, Interrupt, say_to, write_json

if TYPE_CHECKING:
    from ..picture import Picture

DEMO_PICTURE = "vtkmcvr-demo.png"


def add_demo(commands: Any) -> None:
    """Command `demo`."""
    demo = commands.add_parser("demo", help="render a synthetic CT head, or any volume")
    demo.add_argument("--input", help="volume to show instead of the synthetic head")
    demo.add_argument("-o", "--output", default=DEMO_PICTURE, help=f"default: {DEMO_PICTURE}")
    add_render_options(demo)
    demo.set_defaults(command=_demo)


def add_render(commands: Any) -> None:
    """Command `render`."""
    render = commands.add_parser("render", help="render a volume to a picture")
    render.add_argument(
        "input", help="DICOM folder or file, .nrrd .nhdr .nii .nii.gz .mha .mhd .vti"
    )
    render.add_argument("-o", "--output", required=True, help="picture: .png .exr .vti .npz")
    add_render_options(render)
    render.set_defaults(command=_render)


def _demo(args: argparse.Namespace) -> int:
    if args.input is not None:
        return make_picture(read_as_asked(args.input, args), args, explain=True)
    from ..phantom import head_phantom
    from ..scene import Volume

    say = say_to(args)
    say("synthetic CT head phantom (no patient), 192 x 192 x 192")
    if args.preset is None:
        args.preset = "ct-bone"
    if args.azimuth == 0 and args.elevation == 0 and args.view == "front":
        args.azimuth, args.elevation = -28.0, 6.0
    return make_picture(Volume.from_grid(*head_phantom(192)), args, explain=True)


def _render(args: argparse.Namespace) -> int:
    from ..picture import check_suffix

    if args.time == "all":
        from .sequence import make_sequence

        return make_sequence(args)
    check_suffix(args.output)
    return make_picture(read_as_asked(args.input, args), args)


def make_picture(data: Any, args: argparse.Namespace, *, explain: bool = False) -> int:
    """Render, save, report; returns the exit status."""
    from ..picture import check_suffix

    check_suffix(args.output)
    say = say_to(args)
    picture = picture_of(data, args)
    picture.save(args.output, bits=args.bits)
    if explain:
        say(picture.plan.explain())
    for note in picture.recipe["notes"]:
        say(f"note: {note}")
    say(_cost(picture))
    say(f"picture: {Path(args.output).resolve()}")
    write_json(args.json, picture_facts(picture))
    return 0


def picture_of(data: Any, args: argparse.Namespace) -> Picture:
    """Render as the arguments say."""
    from ..front import BACKDROP, render

    data = _flipped(data, args.flip)
    options = _scene_options(data, args)
    background = {"preset": BACKDROP, "transparent": None}.get(args.background, args.background)
    stop = Interrupt()
    with stop, Bar(args.quiet) as bar:
        picture = render(
            data, samples=args.samples, seconds=args.seconds, seed=args.seed, threads=args.threads,
            exposure=args.exposure, background=background, progress=bar, abort=stop.is_set,
            **options,
        )  # fmt: skip
    return picture.denoised(args.denoise) if args.denoise else picture


def _flipped(data: Any, axes: str | None) -> Any:
    if axes is None:
        return data
    from ..scene import Volume
    from ..vtk_scene import volume_of

    return (data if isinstance(data, Volume) else volume_of(data)).flipped(axes)


def _scene_options(data: Any, args: argparse.Namespace) -> dict[str, Any]:
    from ..front import View

    options: dict[str, Any] = {
        "preset": args.preset,
        "size": args.size,
        "shift": args.shift,
        "view": View(args.view, args.azimuth, args.elevation, args.roll, args.zoom),
    }
    if args.aovs or args.denoise == "oidn":
        options["aovs"] = ("albedo", "normal")
    if args.environment:
        from ..environment_files import read_environment
        from ..lights import EnvironmentMap

        options["lights"] = [EnvironmentMap(read_environment(args.environment))]
    return camera_options(data, options, args)


def picture_facts(picture: Picture) -> dict[str, Any]:
    """What was measured, ready for JSON."""
    return {
        **picture.facts(),
        "volume": picture.recipe["volume"],
        "preset": picture.recipe["preset"],
        "version": __version__,
        "notes": picture.recipe["notes"],
    }


def _cost(picture: Picture) -> str:
    width, height = picture.size
    error = f"estimated error (NRMS) {picture.nrms:.2%}"
    if picture.denoiser is not None:
        error = f"denoised by {picture.denoiser['method']}, error not known"
    return (
        f"{width} x {height}, {picture.samples} samples per pixel in {picture.seconds:.2f} s on "
        f"{picture.threads} threads ({picture.paths_per_second / 1e6:.2f} M paths/s), "
        f"stopped by {picture.stopped_by}; {error}"
    )
