"""`vtkmcvr demo` and `vtkmcvr render`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..memory import peak_memory
from .inputs import read_as_asked
from .options import MEASURED, add_render_options
from .scenes import demo_volume, flipped, scene_options
from .technique_options import technique_options
from .terminal import Bar, Interrupt, say_to, write_json
from .transport_options import displayed

if TYPE_CHECKING:
    from ..effects import EffectCost
    from ..pictures.noiseless import NoiselessPicture
    from ..pictures.picture import Picture
    from ..scene import Scene

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
    data = _demo_head(args) if args.input is None else read_as_asked(args.input, args)
    return _predict(data, args) if args.dry_run else make_picture(data, args, explain=True)


def _demo_head(args: argparse.Namespace) -> Any:
    """The synthetic head, with its look and view where none is asked for."""
    say_to(args)("synthetic CT head phantom (no patient), 192 x 192 x 192")
    if args.preset is None:
        args.preset = "ct-bone"
    if args.azimuth is None and args.elevation is None and args.view is None:
        args.azimuth, args.elevation = -28.0, 6.0
    return demo_volume()


def _render(args: argparse.Namespace) -> int:
    from ..pictures.picture import check_suffix

    if args.dry_run:
        return _predict(read_as_asked(args.input, args), args)
    if args.output is None:
        raise ValueError("where to write the picture? Give -o FILE, or --dry-run for its cost")
    if args.time == "all":
        from .sequence import make_sequence

        return make_sequence(args)
    check_suffix(args.output)
    return make_picture(read_as_asked(args.input, args), args)


def make_picture(data: Any, args: argparse.Namespace, *, explain: bool = False) -> int:
    """Render, save, report; returns the exit status."""
    from ..pictures.picture import check_suffix
    from ..report import check_report, write_report

    check_suffix(args.output)
    check_report(args.report)
    if args.explain == MEASURED and args.technique == "occlusion":
        raise ValueError("--explain measured is not for --technique occlusion")
    say = say_to(args)
    picture: Any = picture_of(data, args)
    picture.save(args.output, bits=args.bits)
    costs = _measured(picture, args)
    if explain or args.explain:
        say(picture.plan.explain(costs if args.explain == MEASURED else ()))
    for note in picture.recipe["notes"]:
        say(f"note: {note}")
    say(_cost(picture) + _memory())
    say(f"picture: {Path(args.output).resolve()}")
    write_json(args.json, picture_facts(picture))
    if args.report:
        path = write_report(picture, args.report, costs)
        say(f"report: {path.resolve()}")
    return 0


def picture_of(
    data: Any, args: argparse.Namespace, like: Scene | None = None
) -> Picture | NoiselessPicture:
    """Render as the arguments say, with transfer function, camera and lights of `like`."""
    from ..front import BACKDROP, render

    data = flipped(data, args.flip)
    options = scene_options(data, args)
    if like is not None:
        options |= {"transfer": like.transfer, "camera": like.camera, "lights": like.lights}
    background = {"preset": BACKDROP, "transparent": None}.get(args.background, args.background)
    stop = Interrupt()
    with stop, Bar(args.quiet) as bar:
        picture = render(
            data, samples=args.samples, seconds=args.seconds, nrms=args.nrms,
            adaptive=args.adaptive, seed=args.seed, threads=args.threads, backend=args.backend,
            exposure=args.exposure, background=background, progress=bar, abort=stop.is_set,
            **technique_options(args), **options,
        )  # fmt: skip
    picture = displayed(picture, args)
    return picture.denoised(args.denoise) if args.denoise else picture


def _predict(data: Any, args: argparse.Namespace) -> int:
    """What the picture would cost."""
    from ..front import scene_of
    from ..prediction import estimate

    if args.adaptive:
        raise ValueError("--dry-run predicts evenly spread samples: leave --adaptive out")
    data = flipped(data, args.flip)
    scene = scene_of(data, **scene_options(data, args)).scene
    predicted = estimate(scene, args.nrms or PREDICTED_NRMS, threads=args.threads)
    print(predicted)
    write_json(args.json, predicted.facts())
    return 0


def _measured(picture: Picture, args: argparse.Namespace) -> list[EffectCost]:
    """What each effect costs, where somebody asks for it."""
    from ..costs.effects import effect_costs

    if not (args.report or args.explain == MEASURED):
        return []
    seconds = min(max(REPORT_SHARE * picture.seconds, 0.2), 10.0)
    return effect_costs(picture.plan.scene, seconds, args.threads)


def picture_facts(picture: Picture | NoiselessPicture) -> dict[str, Any]:
    """What was measured, ready for JSON."""
    return {
        **picture.facts(),
        "volume": picture.recipe["volume"],
        "preset": picture.recipe["preset"],
        "version": __version__,
        "notes": picture.recipe["notes"],
        "peak_memory": peak_memory(),
    }


def _memory() -> str:
    peak = peak_memory()
    return "" if peak is None else f"; {peak / 2**20:.0f} MiB of memory at most"


def _cost(picture: Picture | NoiselessPicture) -> str:
    from ..pictures.noiseless import NoiselessPicture

    if isinstance(picture, NoiselessPicture):
        return str(picture)
    width, height = picture.size
    adaptive = "adaptive " if picture.density is not None else ""
    error = f"estimated error (NRMS) {picture.nrms:.2%}"
    if picture.denoiser is not None:
        error = f"denoised by {picture.denoiser['method']}, error not known"
    return (
        f"{width} x {height}, {picture.samples} {adaptive}samples per pixel in "
        f"{picture.seconds:.2f} s on {picture.rendered_on} "
        f"({picture.paths_per_second / 1e6:.2f} M paths/s), stopped by "
        f"{picture.stopped_by}; {error}"
    )
