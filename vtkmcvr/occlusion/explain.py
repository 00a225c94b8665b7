"""What a picture by directional occlusion simulates, and where it is biased."""

from __future__ import annotations

from ..effects import Effect
from ..plan import Plan
from ..scene import Scene
from .raster import Raster
from .settings import MOST_SLICES, Occlusion

# Optical depth of a pixel of the raster above which surfaces come out darker than they are
HARD = 2.0


def effects_of(
    scene: Scene, plan: Plan, occlusion: Occlusion, raster: Raster, fine: int
) -> tuple[tuple[Effect, ...], tuple[str, ...]]:
    """Effects with reasons, and notes."""
    toward = occlusion.toward_light
    axis = "each pixel's view ray" if toward is None else f"the direction {toward}"
    kept = [e for e in plan.effects if e.name in ("medium", "gradient classification")]
    effects = (
        Effect(
            "directional occlusion", True,
            f"cone of {occlusion.half_angle:g} degrees around {axis}; {_mode(occlusion)}",
        ),
        Effect(
            "slices", raster.count > 0,
            f"{raster.count} of {raster.thickness:.3g} world units "
            f"on {raster.columns} x {raster.rows} pixels, {fine} to a side of the film's",
        ),
        *kept,
        Effect(
            "coloured light", occlusion.bleeding > 0,
            f"{occlusion.bleeding:g} of the scattered light goes on in its colour",
        ),
        _shading(scene, occlusion),
        Effect("depth of field", False, "slices are seen through a pinhole"),
    )  # fmt: skip
    return effects, (*plan.notes, *_notes(plan, raster, occlusion))


def _mode(occlusion: Occlusion) -> str:
    if occlusion.mode == "fast":
        return "one buffer, blurred"
    if occlusion.mode == "paper":
        algorithm = 2 if occlusion.exact_distance else 3
        return f"as published, Algorithm {algorithm}, {occlusion.grid} x {occlusion.grid} samples"
    return f"{occlusion.directions} directions"


def _shading(scene: Scene, occlusion: Occlusion) -> Effect:
    if not occlusion.shaded:
        return Effect("surface shading", False, "not asked for")
    return Effect("surface shading", True, "Lambert and Blinn along the cone's axis, times light")


def _notes(plan: Plan, raster: Raster, occlusion: Occlusion) -> tuple[str, ...]:
    notes = ["directional occlusion is biased: compare with the cone phase function by Monte Carlo"]
    pixel = raster.pitch
    if not raster.parallel:
        pixel *= (raster.near + raster.far) / 2
    depth = float(plan.packed.transfer.sigma_t.max()) * pixel
    if occlusion.mode == "default" and depth > HARD:
        notes.append(
            f"a pixel of light is up to {depth:.1f} optical depths wide: oblique surfaces come out "
            f"too dark; more detail than {occlusion.detail:g} helps"
        )
    if occlusion.slices is None and raster.count >= MOST_SLICES:
        notes.append(f"slices are {raster.count}, thicker than half a voxel")
    return tuple(notes)
