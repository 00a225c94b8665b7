"""Scene -> packed scene: which effects run, with reasons. Only this builds packed tuples."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from . import packed
from .effects import Effect
from .pack import f32
from .plan_camera import pack_camera, pack_lens
from .plan_lights import pack_lights
from .plan_medium import pack_medium
from .plan_phase import pack_phase
from .plan_sampling import pack_sobol, sampling_effect
from .plan_surface import pack_normal_map, pack_surface
from .plan_transfer import pack_transfer, transfer_effects
from .plan_transport import estimator_words, pack_marching, pack_scattering, scattering_effect
from .scene import Scene
from .tables import DEEPEST_VOXEL, Tables, build_tables
from .voxels import Voxels, voxels_of

# Transmittance below which Russian roulette may end a shadow ray; 1 would be delta tracking, which
# takes 1.4 times as long at equal error on a CT head (tests/bench/bench_looks.py).
ROULETTE = 0.3


@dataclass(frozen=True, eq=False)
class Plan:
    """What will be simulated, ready for kernels.

    Attributes
    ----------
    scene : Scene
    packed : vtkmcvr.packed.Scene
    effects : tuple of Effect
    notes : tuple of str
        What was changed or limited on the way, never silently.
    """

    scene: Scene
    packed: packed.Scene
    effects: tuple[Effect, ...]
    notes: tuple[str, ...]

    def explain(self) -> str:
        """Every effect, on or off, with its reason; then the notes."""
        width = max(len(effect.name) for effect in self.effects)
        lines = [f"{e.name:<{width}}  {'on ' if e.on else 'off'}  {e.reason}" for e in self.effects]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    @property
    def empty(self) -> bool:
        """Whether nothing in the volume can scatter or absorb."""
        return not bool((self.packed.medium.majorant > 0).any())


def plan(scene: Scene) -> Plan:
    """Pack a scene and give every effect its reason.

    Parameters
    ----------
    scene : Scene

    Returns
    -------
    Plan
    """
    voxels = voxels_of(scene.volume)
    tables = build_tables(scene.transfer, voxels, float(scene.volume.spacing.min()))
    surface, gloss, surface_why, gloss_why = pack_surface(scene, voxels, tables)
    transfer = pack_transfer(scene, voxels, tables, gloss is not None)
    medium = pack_medium(scene, voxels, tables, transfer)
    lens, lens_why = pack_lens(scene.camera)
    phase, phase_effect = pack_phase(scene.phase, tables.g)
    scattering, marching = pack_scattering(scene), pack_marching(scene)
    lights = pack_lights(scene)
    lit = lights.any
    shadows = (
        packed.Shadows(f32(min(scene.shadow_reach, 1e30))) if lit and scene.shadow_reach else None
    )
    ratio = packed.RatioTracking(f32(ROULETTE)) if shadows and scene.ratio_tracking else None
    result = packed.Scene(
        medium, transfer, pack_camera(scene), lens, surface, gloss, phase, scattering, marching,
        shadows, ratio,
        lights.ambient, lights.environment, lights.area_lights, lights.delta_lights, lights.tree,
        lights.choice,
        np.bool_(scene.environment_visible and bool(lights.ambient or lights.environment)),
        pack_normal_map(scene),
        pack_sobol(scene),
    )  # fmt: skip
    effects = (
        _empty_space(scene, medium),
        *transfer_effects(scene, transfer),
        Effect("surface shading", surface is not None, surface_why),
        Effect("specular coat", gloss is not None, gloss_why),
        phase_effect,
        scattering_effect(scattering),
        *lights.effects,
        _shadow_effect(scene, lit, ratio),
        Effect("depth of field", lens is not None, lens_why),
        _background_effect(scene, result),
        _aov_effect(scene),
        sampling_effect(result.sobol),
    )
    return Plan(scene, result, effects, (*_notes(voxels, tables), *lights.notes))


def _empty_space(scene: Scene, medium: packed.Medium) -> Effect:
    if bool((medium.majorant <= 0).all()):
        return Effect("medium", False, "the transfer function makes the whole volume transparent")
    return Effect("medium", True, estimator_words(scene, medium))


def _shadow_effect(scene: Scene, lit: bool, ratio: packed.RatioTracking | None) -> Effect:
    if not lit:
        return Effect("shadows", False, "no lights: no shadow rays")
    if scene.shadow_reach == 0:
        return Effect("shadows", False, "shadow reach is 0")
    how = "ratio tracking" if ratio else "delta tracking, seen or not"
    if scene.estimator == "ray-march":
        how = "optical depth by steps" if ratio else "steps, seen or not"
    reach = "" if math.isinf(scene.shadow_reach) else f", up to {scene.shadow_reach:g}"
    return Effect("shadows", True, how + reach)


def _background_effect(scene: Scene, result: packed.Scene) -> Effect:
    if result.environment_visible:
        return Effect("visible environment", True, "camera rays that miss the volume see it")
    why = "no environment" if scene.environment_visible else "the scene hides it: transparent there"
    return Effect("visible environment", False, why)


def _aov_effect(scene: Scene) -> Effect:
    if not scene.aovs:
        return Effect("first-hit AOVs", False, "nobody asked for albedo or normal")
    return Effect("first-hit AOVs", True, " and ".join(scene.aovs))


def _notes(voxels: Voxels, tables: Tables) -> tuple[str, ...]:
    notes = []
    if voxels.not_finite:
        notes.append(f"{voxels.not_finite} voxels are NaN or infinite: transparent")
    if voxels.offset:
        notes.append(f"values are kept relative to {voxels.offset:g} to fit float32")
    if tables.capped:
        notes.append(
            f"extinction was cut off at {DEEPEST_VOXEL:g} optical depths per smallest voxel edge"
        )
    if tables.too_fine:
        notes.append(
            f"transfer function nodes lie closer than the table resolves ({tables.pitch:g})"
        )
    return tuple(notes)
