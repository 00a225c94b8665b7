"""The scene that the command line describes."""

from __future__ import annotations

import argparse
from typing import Any

from .camera_options import camera_options
from .cutting import cutting_options
from .inputs import read_input
from .transport_options import transport_options


def demo_volume() -> Any:
    """The synthetic CT head."""
    from ..phantom import head_phantom
    from ..scene import Volume

    return Volume.from_grid(*head_phantom(192))


def flipped(data: Any, axes: str | None) -> Any:
    """The volume with some axes backwards."""
    if axes is None:
        return data
    from ..scene import Volume
    from ..vtk_bridge.scene import volume_of

    return (data if isinstance(data, Volume) else volume_of(data)).flipped(axes)


def scene_options(data: Any, args: argparse.Namespace) -> dict[str, Any]:
    """Arguments as options of `vtkmcvr.scene_of`."""
    from ..front import View

    options: dict[str, Any] = {
        "preset": args.preset,
        "size": args.size,
        "shift": args.shift,
        "whole": args.whole,
    }
    turns = {
        name: getattr(args, name)
        for name in ("view", "azimuth", "elevation", "roll", "zoom")
        if getattr(args, name) is not None
    }
    if turns:
        options["view"] = View(**turns)
    if args.overlay:
        options["overlay"] = read_input(args.overlay, None)
        options["overlay_preset"] = args.overlay_preset
    if getattr(args, "aovs", False) or getattr(args, "denoise", None) == "oidn":
        options["aovs"] = ("albedo", "normal")
    if args.environment:
        from ..environment_files import read_environment
        from ..lights import EnvironmentMap

        options["lights"] = [EnvironmentMap(read_environment(args.environment))]
    options = transport_options(data, options, args)
    return cutting_options(data, camera_options(data, options, args), args)
