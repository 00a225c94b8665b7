"""What a picture by emission and absorption simulates, and what it leaves out."""

from __future__ import annotations

import numpy as np

from ..effects import Effect
from ..plan import Plan
from ..scene import Scene
from .settings import EmissionAbsorption

# Effects of the plan that steps have too
SHARED = (
    "gradient classification", "colour by point", "emission", "clipping", "cropping",
    "mask", "labels", "more volumes", "backdrop",
)  # fmt: skip


def effects_of(
    scene: Scene, plan: Plan, settings: EmissionAbsorption
) -> tuple[tuple[Effect, ...], tuple[str, ...]]:
    """Effects with reasons, and notes."""
    kept = [effect for effect in plan.effects if effect.name in SHARED]
    effects = (
        Effect("emission and absorption", True, f"{_steps(settings)}; {_rays(settings)}"),
        _medium(plan),
        *kept,
        _shading(plan, settings),
        Effect("scattering", False, "the colour is emitted: no light arrives, none is scattered"),
        Effect("shadows", False, "emission and absorption knows none"),
        _lights(scene),
        Effect("depth of field", False, "rays go through a pinhole"),
        _aovs(scene),
    )
    notes = (
        "emission and absorption is no light transport: for light compare with monte-carlo",
        *plan.notes,
    )
    return effects, notes


def _medium(plan: Plan) -> Effect:
    found = next(effect for effect in plan.effects if effect.name == "medium")
    if not found.on:
        return found
    cells = plan.packed.medium.majorant
    share = np.count_nonzero(cells <= 0) / cells.size
    return Effect("medium", True, f"{share:.0%} of the macrocells are empty and leapt over")


def _steps(settings: EmissionAbsorption) -> str:
    if settings.sample_distance is not None:
        return f"steps of {settings.sample_distance:g} world units"
    return f"steps of {settings.step:g} voxels"


def _rays(settings: EmissionAbsorption) -> str:
    n = settings.rays
    return "a ray through the centre of each pixel" if n == 1 else f"{n} x {n} rays a pixel"


def _shading(plan: Plan, settings: EmissionAbsorption) -> Effect:
    name = "shading"
    found = [volume.phong for volume in plan.volumes]
    if settings.shading == "none":
        return Effect(name, False, "not asked for: pure colour")
    first = next((phong for phong in found if phong is not None), None)
    if first is None:
        return Effect(name, False, "the scene has no surface: pure colour")
    return Effect(
        name, True,
        f"a lamp at the eye: ambient {first.ambient:g}, diffuse {first.diffuse:g}, specular "
        f"{first.specular:g}, power {first.power:g}",
    )  # fmt: skip


def _lights(scene: Scene) -> Effect:
    why = f"the scene's {len(scene.lights)} are left out" if scene.lights else "none are needed"
    return Effect("lights", False, why)


def _aovs(scene: Scene) -> Effect:
    if not scene.aovs:
        return Effect("first-hit AOVs", False, "nobody asked for albedo or normal")
    return Effect("first-hit AOVs", True, " and ".join(scene.aovs))
