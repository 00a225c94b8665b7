"""Options of technique "occlusion"."""

from __future__ import annotations

import argparse
from typing import Any

FIELDS = {
    "theta": "half_angle", "mode": "mode", "slices": "slices", "directions": "directions",
    "detail": "detail", "grid": "grid", "bleeding": "bleeding",
}  # fmt: skip


def add_occlusion_options(parser: argparse.ArgumentParser) -> None:
    """The technique, and what only occlusion takes."""
    add = parser.add_argument
    add(
        "--technique",
        default="monte-carlo",
        choices=("monte-carlo", "occlusion"),
        help="monte-carlo, the default, or directional occlusion shading: quick, smooth, biased",
    )
    add("--theta", type=float, metavar="DEGREES", help="occlusion: half angle of the cone of light")
    add("--mode", choices=("default", "fast", "paper"), help="occlusion: how it is computed")
    add("--slices", type=int, help="occlusion: default, about two for each voxel")
    add("--directions", type=int, help="occlusion: beams of light in the cone, default 40")
    add("--detail", type=float, help="occlusion: 2 is twice as fine in all directions")
    add("--grid", type=int, help="occlusion: n of the n x n samples of --mode paper")
    add("--bleeding", type=float, help="occlusion: share of light that goes on in colour, 0 to 1")
    add("--toward-light", nargs=3, type=float, metavar=("X", "Y", "Z"),
        help="occlusion: world direction of the cone's axis; default, the view ray")  # fmt: skip
    add("--exact-distance", action="store_true", help="occlusion: --mode paper by Algorithm 2")
    add("--shaded", action="store_true", help="occlusion: surfaces shaded by their gradients")


def occlusion_options(args: argparse.Namespace) -> dict[str, Any]:
    """Arguments of `vtkmcvr.render` for the technique."""
    given = {
        field: getattr(args, name)
        for name, field in FIELDS.items()
        if getattr(args, name) is not None
    }
    if args.toward_light is not None:
        given["toward_light"] = tuple(args.toward_light)
    given |= {name: True for name in ("shaded", "exact_distance") if getattr(args, name)}
    if args.technique != "occlusion":
        if given:
            raise ValueError(f"{', '.join(sorted(given))}: only with --technique occlusion")
        return {}
    for name in ("denoise", "report", "dry_run", "samples", "seconds", "nrms"):
        if getattr(args, name, None):
            raise ValueError(f"--{name.replace('_', '-')} is not for --technique occlusion")
    from ..occlusion import Occlusion

    return {"technique": "occlusion", "occlusion": Occlusion(**given)}
