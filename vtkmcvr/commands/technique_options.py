"""The technique, and the options of those that are not light transport."""

from __future__ import annotations

import argparse
from typing import Any

# Option, or field of the settings where its name differs, of each technique
OCCLUSION = {
    "theta": "half_angle", "mode": "mode", "slices": "slices", "directions": "directions",
    "detail": "detail", "grid": "grid", "bleeding": "bleeding", "toward_light": "toward_light",
    "shaded": "shaded", "exact_distance": "exact_distance",
}  # fmt: skip
EMISSION_ABSORPTION = {
    "step_size": "step", "sample_distance": "sample_distance", "rays": "rays", "shading": "shading",
}  # fmt: skip
FIELDS = {"occlusion": OCCLUSION, "emission-absorption": EMISSION_ABSORPTION}
UNUSED = ("denoise", "report", "dry_run", "samples", "seconds", "nrms")


def add_technique_options(parser: argparse.ArgumentParser) -> None:
    """The technique, and what only some take."""
    add = parser.add_argument
    add(
        "--technique",
        default="monte-carlo",
        choices=("monte-carlo", *FIELDS),
        help="monte-carlo, the default; occlusion: quick, smooth, biased; emission-absorption: as "
        "VTK's own volume rendering",
    )
    _add_occlusion(add)
    add("--step-size", type=float, metavar="VOXELS",
        help="emission-absorption: longest way of a step, default 0.5")  # fmt: skip
    add("--sample-distance", type=float, metavar="LENGTH",
        help="emission-absorption: length of a step in world units instead")  # fmt: skip
    add("--rays", type=int, help="emission-absorption: n of the n x n rays of a pixel, default 1")
    add("--shading", choices=("scene", "none"), help="emission-absorption: by gradients, or not")


def _add_occlusion(add: Any) -> None:
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


def technique_options(args: argparse.Namespace) -> dict[str, Any]:
    """Arguments of `vtkmcvr.render` for the technique."""
    given = {name: _given(args, fields) for name, fields in FIELDS.items()}
    for name, values in given.items():
        if values and name != args.technique:
            raise ValueError(f"{', '.join(sorted(values))}: only with --technique {name}")
    if args.technique == "monte-carlo":
        return {}
    for name in UNUSED:
        if getattr(args, name, None):
            raise ValueError(f"--{name.replace('_', '-')} is not for --technique {args.technique}")
    from ..emission_absorption import EmissionAbsorption
    from ..occlusion import Occlusion

    own = given[args.technique]
    if args.technique == "occlusion":
        return {"technique": "occlusion", "occlusion": Occlusion(**own)}
    return {"technique": args.technique, "emission_absorption": EmissionAbsorption(**own)}


def _given(args: argparse.Namespace, fields: dict[str, str]) -> dict[str, Any]:
    """Fields of a technique's settings that were asked for."""
    found = {field: getattr(args, name) for name, field in fields.items()}
    found = {field: value for field, value in found.items() if value not in (None, False)}
    return {
        field: tuple(value) if isinstance(value, list) else value for field, value in found.items()
    }
