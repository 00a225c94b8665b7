"""Options of the camera: projection, eyes, lens, sampler."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ..scene import Camera

# Of the volume's radius
PANORAMA_REACH = 0.1


def add_camera_options(parser: argparse.ArgumentParser) -> None:
    """How the picture is taken, from where the view options put the camera."""
    add = parser.add_argument
    add("--aperture", type=float, default=0.0, help="lens radius in world units; 0: all is sharp")
    add("--blades", type=int, default=0, help="corners of the aperture; 0: circular")
    add("--focus", type=_pixel, metavar="X,Y", help="pixel that shall be sharp, from top left")
    add("--projection", default="perspective", help="perspective, parallel, panorama (from inside)")
    add("--eyes", help="stereo view: left, right, or both side by side")
    add("--sampler", default="sobol", help="sobol (even samples) or independent")


def camera_options(data: Any, options: dict[str, Any], args: argparse.Namespace) -> dict[str, Any]:
    """Options of `scene_of`, with a camera where the arguments ask for more than the view."""
    from ..front import scene_of
    from ..scene import Stereo
    from ..studio import projected

    options = {**options, "sampler": args.sampler}
    if args.focus and not args.aperture:
        raise ValueError("--focus needs a lens: give its radius by --aperture")
    if not args.aperture and not args.eyes and args.projection == "perspective":
        return options
    scene = scene_of(data, **options).scene
    camera = projected(scene.camera, args.projection)
    if camera.panorama and scene.scattering == "single":
        # Light from outside does not get to where the camera is: only what is near casts shadows
        options.setdefault("shadow_reach", scene.volume.radius * PANORAMA_REACH)
    if args.eyes:
        camera = replace(camera, stereo=Stereo(args.eyes))
    options["camera"] = camera
    if args.aperture:
        options["camera"] = _with_lens(data, camera, options, args)
    return options


def _with_lens(
    data: Any, camera: Camera, options: dict[str, Any], args: argparse.Namespace
) -> Camera:
    from ..focus import autofocus
    from ..front import scene_of
    from ..scene import Lens

    distance = autofocus(scene_of(data, **options).scene, args.focus) if args.focus else None
    return replace(camera, lens=Lens(args.aperture, distance, args.blades))


def _pixel(text: str) -> tuple[int, int]:
    try:
        column, row = (int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"focus is COLUMN,ROW in pixels, got {text!r}") from None
    return column, row
