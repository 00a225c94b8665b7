"""Options of light transport, and of the display that needs no ray."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any


def add_transport_options(parser: argparse.ArgumentParser) -> None:
    """How light goes through the volume."""
    add = parser.add_argument
    add("--scattering", help="single (the default, as in Exposure Render) or multiple")
    add("--g", type=float, metavar="G", help="Henyey-Greenstein phase function of this mean cosine")
    add("--gradient-factor", type=float, metavar="F", help="0: no surfaces, to 1; else the look's")
    add("--coat", help="microfacets of surfaces: blinn, as in Exposure Render, or ggx")
    add("--shadow-reach", type=float, metavar="LENGTH", help="world units; 0: no shadows")
    add("--estimator", help="majorant-grid (the default), woodcock, or ray-march (biased)")


def add_display_options(parser: argparse.ArgumentParser) -> None:
    """How the film is shown."""
    add = parser.add_argument
    add("--gamma", type=float, help="encode by the power 1/gamma; default: sRGB")
    add("--film-filter", help="gaussian-5x5: that of Exposure Render, over the film; default: none")


def transport_options(
    data: Any, options: dict[str, Any], args: argparse.Namespace
) -> dict[str, Any]:
    """`options` of `scene_of` with those of the command line added."""
    given = {name: getattr(args, name) for name in ("scattering", "shadow_reach", "estimator")}
    options = {**options, **{name: value for name, value in given.items() if value is not None}}
    if args.g is not None:
        from ..scene import HenyeyGreenstein

        options["phase"] = HenyeyGreenstein(args.g)
    surface = {
        name: value
        for name, value in (("gradient_factor", args.gradient_factor), ("coat", args.coat))
        if value is not None
    }
    if surface:
        from ..front import scene_of
        from ..scene import Surface

        look = scene_of(data, **options).scene.surface or Surface()
        options["surface"] = replace(look, **surface)
    return options


def displayed(picture: Any, args: argparse.Namespace) -> Any:
    """The picture under the display that is asked for; traces no ray."""
    given = {"gamma": args.gamma, "film_filter": args.film_filter}
    changes = {name: value for name, value in given.items() if value is not None}
    return picture.with_display(**changes) if changes else picture
