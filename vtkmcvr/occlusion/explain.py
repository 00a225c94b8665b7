"""What a picture by directional occlusion simulates, and where it is biased."""

from __future__ import annotations

import math

from ..effects import Effect
from ..plan import Plan
from ..scene import Scene
from .beams import narrowest_cone
from .raster import Raster
from .settings import MOST_SLICES, Occlusion

Axis = tuple[float, float, float]
# Optical depths of a slice and of a pixel to which the default mode limits the medium as light
# meets it
DEEPEST_LAYER, DEEPEST_PIXEL = 0.4, 0.75
# Effects of the plan that slices have too
SHARED = (
    "medium", "gradient classification", "colour by point", "clipping", "cropping", "mask",
    "labels", "more volumes",
)  # fmt: skip


def effects_of(
    scene: Scene,
    plan: Plan,
    occlusion: Occlusion,
    raster: Raster,
    fine: int,
    axis: Axis | None,
) -> tuple[tuple[Effect, ...], tuple[str, ...]]:
    """Effects with reasons, and notes."""
    toward = occlusion.toward_light
    around = "each pixel's view ray" if toward is None else f"the direction {toward}"
    kept = [e for e in plan.effects if e.name in SHARED]
    effects = (
        Effect(
            "directional occlusion", True,
            f"cone of {occlusion.half_angle:g} degrees around {around}; {_mode(occlusion)}",
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
        _backdrop(scene),
        _aovs(scene),
        Effect("depth of field", False, "slices are seen through a pinhole"),
    )  # fmt: skip
    return effects, (*plan.notes, *_notes(scene, plan, raster, occlusion, axis))


def most_extinction(raster: Raster) -> float:
    """Largest extinction that slices and pixels resolve, 1/world unit."""
    return min(DEEPEST_LAYER / raster.thickness, DEEPEST_PIXEL / raster.pixel)


def _backdrop(scene: Scene) -> Effect:
    if scene.backdrop is None:
        return Effect("backdrop", False, "no other renderer draws anything around the volume")
    return Effect(
        "backdrop", True,
        "what another renderer drew hides the volume; it neither casts occlusion nor receives it",
    )  # fmt: skip


def _aovs(scene: Scene) -> Effect:
    if not scene.aovs:
        return Effect("first-hit AOVs", False, "nobody asked for albedo or normal")
    return Effect("first-hit AOVs", True, " and ".join(scene.aovs))


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


def _notes(
    scene: Scene, plan: Plan, raster: Raster, occlusion: Occlusion, axis: Axis | None
) -> tuple[str, ...]:
    notes = ["directional occlusion is biased: compare with the cone phase function by Monte Carlo"]
    transfers = [plan.packed.transfer, *(v.transfer for v in plan.packed.more or ())]
    deepest = max(float(transfer.sigma_t.max()) for transfer in transfers)
    most = most_extinction(raster)
    if occlusion.mode == "default" and deepest > most:
        notes.append(
            f"extinction is up to {deepest:.3g}, light meets at most {most:.3g} per world unit, "
            f"which slices resolve; more detail than {occlusion.detail:g} raises that"
        )
    if any(transfer.emission is not None for transfer in transfers):
        notes.append("the medium's own light is left out")
    if axis is not None:
        least = math.degrees(narrowest_cone(raster, occlusion.directions, axis))
        if occlusion.half_angle < least:
            notes.append(
                f"the cone of light is widened from {occlusion.half_angle:g} to {least:.1f} "
                "degrees, to hold enough directions in this perspective view; more directions help"
            )
    if occlusion.slices is None and raster.count >= MOST_SLICES:
        notes.append(f"slices are {raster.count}, thicker than the detail asks for")
    return tuple(notes)
