"""`vtkmcvr demo` and `vtkmcvr render`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from .inputs import demo_volume, flipped, read_input, scene_options
from .occlusion_options import occlusion_options
from .options import add_render_options
from .terminal import Bar, Interrupt, say_to, write_json

if TYPE_CHECKING:
    from ..occlusion import OcclusionPicture
    from ..picture import Picture

DEMO_PICTURE = "vtkmcvr-demo.png"
PREDICTED_NRMS = 0.01
# Time to measure what an effect costs, as a share of the picture's
REPORT_SHARE = 0.2


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
    render.add_argument("-o", "--output", help="picture: .png .exr .vti .npz")
    add_render_options(render)
    render.set_defaults(command=_render)


def _demo(args: argparse.Namespace) -> int:
    if args.input is not None:
        return make_picture(read_input(args.input, args.series), args, explain=True)
    say = say_to(args)
    say("synthetic CT head phantom (no patient), 192 x 192 x 192")
    if args.preset is None:
        args.preset = "ct-bone"
    if args.azimuth == 0 and args.elevation == 0 and args.view == "front":
        args.azimuth, args.elevation = -28.0, 6.0
    return make_picture(demo_volume(), args, explain=True)


def _render(args: argparse.Namespace) -> int:
    from ..picture import check_suffix

    if args.output is None and not args.dry_run:
        raise ValueError("where to write the picture? Give -o FILE, or --dry-run for its cost")
    if args.output is not None:
        check_suffix(args.output)
    return make_picture(read_input(args.input, args.series), args)


def make_picture(data: Any, args: argparse.Namespace, *, explain: bool = False) -> int:
    """Render, save, report; returns the exit status."""
    from ..front import BACKDROP, render
    from ..picture import check_suffix
    from ..report import check_report

    technique = occlusion_options(args)
    data = flipped(data, args.flip)
    options = scene_options(data, args)
    if args.dry_run:
        return _predict(data, options, args)
    check_suffix(args.output)
    check_report(args.report)
    say = say_to(args)
    background = {"preset": BACKDROP, "transparent": None}.get(args.background, args.background)
    stop = Interrupt()
    with stop, Bar(args.quiet) as bar:
        picture = render(
            data, samples=args.samples, seconds=args.seconds, nrms=args.nrms, seed=args.seed,
            threads=args.threads, exposure=args.exposure, background=background, progress=bar,
            abort=stop.is_set,
            **technique, **options,
        )  # fmt: skip
    if args.denoise:
        picture = picture.denoised(args.denoise)
    picture.save(args.output, bits=args.bits)
    if explain:
        say(picture.plan.explain())
    for note in picture.recipe["notes"]:
        say(f"note: {note}")
    say(_cost(picture))
    say(f"picture: {Path(args.output).resolve()}")
    write_json(args.json, _facts(picture))
    if args.report:
        _report(picture, args)
    return 0


def _predict(data: Any, options: dict[str, Any], args: argparse.Namespace) -> int:
    """What the picture would cost."""
    from ..front import scene_of
    from ..prediction import estimate

    scene = scene_of(data, **options).scene
    predicted = estimate(scene, args.nrms or PREDICTED_NRMS, threads=args.threads)
    print(predicted)
    write_json(args.json, predicted.facts())
    return 0


def _report(picture: Any, args: argparse.Namespace) -> None:
    from ..costs.effects import effect_costs
    from ..report import write_report

    seconds = min(max(REPORT_SHARE * picture.seconds, 0.2), 10.0)
    costs = effect_costs(picture.plan.scene, seconds, args.threads)
    path = write_report(picture, args.report, costs)
    say_to(args)(f"report: {path.resolve()}")


def _facts(picture: Picture | OcclusionPicture) -> dict[str, Any]:
    return {
        **picture.facts(),
        "volume": picture.recipe["volume"],
        "preset": picture.recipe["preset"],
        "version": __version__,
        "notes": picture.recipe["notes"],
    }


def _cost(picture: Picture | OcclusionPicture) -> str:
    from ..occlusion import OcclusionPicture

    if isinstance(picture, OcclusionPicture):
        return str(picture)
    width, height = picture.size
    error = f"estimated error (NRMS) {picture.nrms:.2%}"
    if picture.denoiser is not None:
        error = f"denoised by {picture.denoiser['method']}, error not known"
    return (
        f"{width} x {height}, {picture.samples} samples per pixel in {picture.seconds:.2f} s on "
        f"{picture.threads} threads ({picture.paths_per_second / 1e6:.2f} M paths/s), "
        f"stopped by {picture.stopped_by}; {error}"
    )
