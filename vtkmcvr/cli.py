"""Command line: `vtkmcvr demo | render | info | presets`."""

from __future__ import annotations

import argparse
import json
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import __version__

if TYPE_CHECKING:
    from .picture import Picture

DEMO_PICTURE = "vtkmcvr-demo.png"
BAD_USAGE, INTERRUPTED = 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status. Errors are one sentence on stderr."""
    args = _parser().parse_args(arguments)
    try:
        return args.command(args)
    except (ValueError, TypeError, OSError, ImportError, MemoryError) as error:
        print(f"vtkmcvr: {_sentence(error)}", file=sys.stderr)
        return BAD_USAGE
    except KeyboardInterrupt:
        print("vtkmcvr: interrupted before there was a picture", file=sys.stderr)
        return INTERRUPTED


def _sentence(error: BaseException) -> str:
    text = " ".join(str(error).split())
    if isinstance(error, MemoryError):
        return f"not enough memory: {text or 'the volume or the film is too large'}"
    return text or type(error).__name__


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="vtkmcvr", description="Physically based Monte Carlo volume rendering."
    )
    parser.add_argument("--version", action="version", version=f"vtkmcvr {__version__}")
    commands = parser.add_subparsers(required=True, metavar="command")
    demo = commands.add_parser("demo", help="render a synthetic CT head, or any volume")
    demo.add_argument("--input", help="volume to show instead of the synthetic head")
    demo.add_argument("-o", "--output", default=DEMO_PICTURE, help=f"default: {DEMO_PICTURE}")
    _render_options(demo)
    demo.set_defaults(command=_demo)
    render = commands.add_parser("render", help="render a volume to a picture")
    render.add_argument(
        "input", help="DICOM folder or file, .nrrd .nhdr .nii .nii.gz .mha .mhd .vti"
    )
    render.add_argument("-o", "--output", required=True, help="picture: .png .exr .vti .npz")
    _render_options(render)
    render.set_defaults(command=_render)
    info = commands.add_parser("info", help="what a volume holds and what the reader noticed")
    info.add_argument("input")
    info.add_argument("--series", help="series UID or number, where a folder holds several")
    info.add_argument("--json", metavar="FILE", help="the same as JSON")
    info.set_defaults(command=_info)
    presets = commands.add_parser("presets", help="list the looks")
    presets.set_defaults(command=_presets)
    return parser


def _render_options(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--preset", help="look; see `vtkmcvr presets`. Default: chosen from the values")
    add("--size", type=_size, default=(800, 600), metavar="WxH", help="pixels, default 800x600")
    add("--samples", type=int, help="samples per pixel, default 64")
    add("--seconds", type=float, help="time to render; with --samples, whichever is met first")
    add("--seed", type=int, default=0)
    add("--threads", type=int, help="default: all CPUs of the process")
    add(
        "--view", default="front", help="front back left right top bottom: side of the patient seen"
    )
    add("--azimuth", type=float, default=0.0, help="degrees around the volume, to the right")
    add("--elevation", type=float, default=0.0, help="degrees up")
    add("--roll", type=float, default=0.0, help="degrees clockwise")
    add("--zoom", type=float, default=1.0)
    add("--exposure", type=float, help="stops; default: the look's")
    add(
        "--background",
        type=_background,
        default="preset",
        metavar="COLOUR",
        help="transparent, or sRGB as #rrggbb",
    )
    add(
        "--flip",
        metavar="AXES",
        help="index axes that run backwards, such as k; for files that "
        "do not say which way they were stored",
    )
    add("--shift", type=float, help="added to the values to get HU; default: detected")
    add("--series", help="series UID or number, where a DICOM folder holds several")
    add("--environment", metavar="MAP", help="light by this .hdr or .exr panorama instead")
    add("--aperture", type=float, default=0.0, help="lens radius in world units; 0: all is sharp")
    add("--json", metavar="FILE", help="what was measured")
    add("--quiet", action="store_true", help="no progress and no report")


def _size(text: str) -> tuple[int, int]:
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


def _demo(args: argparse.Namespace) -> int:
    if args.input is not None:
        return _picture_of(_read(args.input, args.series), args, explain=True)
    from .phantom import head_phantom
    from .scene import Volume

    say = _say(args)
    say("synthetic CT head phantom (no patient), 192 x 192 x 192")
    if args.preset is None:
        args.preset = "ct-bone"
    if args.azimuth == 0 and args.elevation == 0 and args.view == "front":
        args.azimuth, args.elevation = -28.0, 6.0
    return _picture_of(Volume.from_grid(*head_phantom(192)), args, explain=True)


def _render(args: argparse.Namespace) -> int:
    from .picture import check_suffix

    check_suffix(args.output)
    return _picture_of(_read(args.input, args.series), args)


def _read(path: str, series: str | None) -> Any:
    from .readers import read_vtk

    number = int(series) if series is not None and series.isdigit() else series
    return read_vtk(path, series=number)


def _picture_of(data: Any, args: argparse.Namespace, *, explain: bool = False) -> int:
    """Render, save, report."""
    from .front import BACKDROP, render
    from .picture import check_suffix

    check_suffix(args.output)
    say = _say(args)
    data = _flipped(data, args.flip)
    options = _scene_options(data, args)
    background = {"preset": BACKDROP, "transparent": None}.get(args.background, args.background)
    stop = _Interrupt()
    with stop, _Bar(args.quiet) as bar:
        picture = render(
            data, samples=args.samples, seconds=args.seconds, seed=args.seed, threads=args.threads,
            exposure=args.exposure, background=background, progress=bar, abort=stop.is_set,
            **options,
        )  # fmt: skip
    picture.save(args.output)
    if explain:
        say(picture.plan.explain())
    for note in picture.recipe["notes"]:
        say(f"note: {note}")
    say(_cost(picture))
    say(f"picture: {Path(args.output).resolve()}")
    _write_json(args.json, _facts(picture))
    return 0


def _flipped(data: Any, axes: str | None) -> Any:
    if axes is None:
        return data
    from .scene import Volume
    from .vtk_scene import volume_of

    return (data if isinstance(data, Volume) else volume_of(data)).flipped(axes)


def _scene_options(data: Any, args: argparse.Namespace) -> dict[str, Any]:
    from .front import View, scene_of

    options: dict[str, Any] = {
        "preset": args.preset,
        "size": args.size,
        "shift": args.shift,
        "view": View(args.view, args.azimuth, args.elevation, args.roll, args.zoom),
    }
    if args.environment:
        from .environment_files import read_environment
        from .lights import EnvironmentMap

        options["lights"] = [EnvironmentMap(read_environment(args.environment))]
    if args.aperture:
        from dataclasses import replace

        from .scene import Lens

        camera = scene_of(data, **options).scene.camera
        options["camera"] = replace(camera, lens=Lens(args.aperture))
    return options


def _facts(picture: Picture) -> dict[str, Any]:
    return {
        **picture.facts(),
        "volume": picture.recipe["volume"],
        "preset": picture.recipe["preset"],
        "version": __version__,
        "notes": picture.recipe["notes"],
    }


def _cost(picture: Picture) -> str:
    width, height = picture.size
    return (
        f"{width} x {height}, {picture.samples} samples per pixel in {picture.seconds:.2f} s on "
        f"{picture.threads} threads ({picture.paths_per_second / 1e6:.2f} M paths/s), "
        f"stopped by {picture.stopped_by}; estimated error (NRMS) {picture.nrms:.2%}"
    )


def _info(args: argparse.Namespace) -> int:
    from .volume_info import format_info, volume_info

    info = volume_info(_read(args.input, args.series))
    print(format_info(info))
    _write_json(args.json, info)
    return 0


def _presets(args: argparse.Namespace) -> int:
    from .presets import LOOKS

    for look in LOOKS.values():
        print(f"{look.name:<10} {look.about}")
    return 0


def _write_json(path: str | None, facts: dict[str, Any]) -> None:
    if path is None:
        return
    from .safe_files import replacing

    with replacing(path, Path(path).suffix.lower()) as temporary:
        temporary.write_text(json.dumps(facts, indent=2, allow_nan=False) + "\n", encoding="utf-8")


def _say(args: argparse.Namespace) -> Callable[[str], None]:
    return (lambda text: None) if args.quiet else print


class _Interrupt:
    """Ctrl-C ends the render and keeps its picture; pressed again, it ends the program."""

    def __init__(self) -> None:
        self.pressed = False

    def is_set(self) -> bool:
        return self.pressed

    def __enter__(self) -> _Interrupt:
        if threading.current_thread() is threading.main_thread():
            self.before = signal.signal(signal.SIGINT, self._press)
        return self

    def __exit__(self, *_: object) -> None:
        if hasattr(self, "before"):
            signal.signal(signal.SIGINT, self.before)

    def _press(self, *_: object) -> None:
        if self.pressed:
            raise KeyboardInterrupt
        self.pressed = True


class _Bar:
    """Progress on a terminal: rich's bar, or a plain line without rich; nothing elsewhere."""

    def __init__(self, quiet: bool):
        self.on = not quiet and sys.stderr.isatty()
        self.rich: Any = None
        self.last = 0.0

    def __enter__(self) -> _Bar:
        if self.on:
            try:
                from rich.console import Console
                from rich.progress import Progress
            except ImportError:
                return self
            self.rich = Progress(console=Console(stderr=True), transient=True)
            self.rich.start()
            self.task = self.rich.add_task("rendering", total=1.0)
        return self

    def __exit__(self, *_: object) -> None:
        if self.rich is not None:
            self.rich.stop()
        elif self.on:
            print(file=sys.stderr)

    def __call__(self, progress: Any) -> None:
        if self.rich is not None:
            text = f"{progress.samples} samples"
            self.rich.update(self.task, completed=progress.fraction, description=text)
        elif self.on and time.monotonic() - self.last > 0.2:
            self.last = time.monotonic()
            print(f"\rrendering {progress.fraction:4.0%}", end="", file=sys.stderr, flush=True)


if __name__ == "__main__":
    sys.exit(main())
