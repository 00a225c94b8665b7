"""Scene -> packed scene: which effects run, with reasons. Only this builds packed tuples."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import packed
from .effects import Effect, EffectCost, table
from .pack import f32
from .phases import Phase
from .planning.camera import pack_backdrop, pack_camera, pack_lens
from .planning.lights import pack_lights
from .planning.receivers import pack_receivers
from .planning.sampling import pack_sobol, sampling_effect
from .planning.scatterers import pack_scatterers
from .planning.surface import pack_normal_map
from .planning.transport import estimator_words, pack_marching
from .planning.volume import (
    MORE,
    PackedVolume,
    coat,
    pack_layers,
    pack_volume,
    packed_layer,
)
from .scene import Scene
from .tables import DEEPEST_VOLUME, DEEPEST_VOXEL, Tables
from .voxels import Voxels

# Transmittance below which Russian roulette may end a shadow ray; 1 would be delta tracking, which
# takes 1.4 times as long at equal error on a CT head (tests/bench/bench_looks.py).
ROULETTE = 0.3
# Fields of a scene on which packed volumes do not depend
VIEW = ("camera", "lights", "size", "pixel_filter", "receivers", "backdrop", "aovs", "sampler")


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
    corners : array (n, 3)
        World corners of the boxes outside of which the volumes are empty.
    volumes : tuple
        Packed volumes, for the plan of another view of them.
    """

    scene: Scene
    packed: packed.Scene
    effects: tuple[Effect, ...]
    notes: tuple[str, ...]
    corners: NDArray[np.float64]
    volumes: tuple[PackedVolume, ...] = ()

    def explain(self, costs: Sequence[EffectCost] = ()) -> str:
        """Every effect, on or off, with its reason; then the notes.

        Parameters
        ----------
        costs : sequence of EffectCost, optional
            From `vtkmcvr.effect_costs(plan.scene)`: adds what leaving an effect out would save, and
            how much it would change the picture.
        """
        return "\n".join([*table(self.effects, costs), *(f"note: {note}" for note in self.notes)])

    @property
    def empty(self) -> bool:
        """Whether nothing in the volumes can scatter or absorb."""
        return not len(self.corners)


def plan(scene: Scene, like: Plan | None = None) -> Plan:
    """Pack a scene and give every effect its reason.

    Parameters
    ----------
    scene : Scene
    like : Plan, optional
        Of another view: where only what `VIEW` names differs, its volumes are taken as they are.

    Returns
    -------
    Plan
    """
    volumes, more_effect = _volumes(scene, like)
    packed_volumes = tuple(volumes)
    centre = scene.volume.centre
    receivers, mesh, receiver_effect = pack_receivers(scene.receivers, centre)
    lights = pack_lights(scene)
    lit = lights.any
    scatterers = pack_scatterers(scene, volumes, receivers, lit)
    coated = scatterers.coated
    first, *others = scatterers.volumes
    lens, lens_why = pack_lens(scene.camera)
    backdrop, backdrop_effect = pack_backdrop(scene)
    shadows = (
        packed.Shadows(f32(min(scene.shadow_reach, 1e30))) if lit and scene.shadow_reach else None
    )
    ratio = packed.RatioTracking(f32(ROULETTE)) if shadows and scene.ratio_tracking else None
    result = packed.Scene(
        first.medium, first.transfer, pack_camera(scene), lens, first.surface,
        coat(first.gloss, coated), scatterers.phase, scatterers.scattering, pack_marching(scene),
        shadows, ratio,
        lights.ambient, lights.environment, lights.area_lights, lights.delta_lights,
        lights.all_lights,
        lights.choice,
        np.bool_(scene.environment_visible and bool(lights.ambient or lights.environment)),
        pack_normal_map(scene),
        pack_sobol(scene),
        receivers, mesh,
        tuple(packed_layer(v, centre, coated) for v in others) or None,
        backdrop,
    )  # fmt: skip
    effects = (
        _empty_space(scene, first),
        *first.effects,
        more_effect,
        receiver_effect,
        *scatterers.effects,
        *lights.effects,
        _shadow_effect(scene, lit, ratio),
        Effect("depth of field", lens is not None, lens_why),
        _background_effect(scene, result),
        backdrop_effect,
        _aov_effect(scene),
        sampling_effect(result.sobol),
    )
    corners = np.concatenate([v.corners for v in volumes])
    notes = dict.fromkeys(note for v in volumes for note in _notes(v.voxels, v.tables))
    return Plan(scene, result, effects, (*notes, *lights.notes), corners, packed_volumes)


def _volumes(scene: Scene, like: Plan | None) -> tuple[list[PackedVolume], Effect]:
    """Packed volumes, the first one first, and whether there are several."""
    if like is not None and _same_volumes(scene, like.scene):
        return list(like.volumes), next(e for e in like.effects if e.name == MORE)
    more, more_effect = pack_layers(scene)
    return [pack_volume(scene), *more], more_effect


def _same_volumes(one: Scene, other: Scene) -> bool:
    names = [field.name for field in dataclasses.fields(Scene) if field.name not in VIEW]
    return all(_same(getattr(one, name), getattr(other, name)) for name in names)


def _same(one: object, other: object) -> bool:
    """Whether two fields are the same objects, or plainly equal: arrays are not compared."""
    if isinstance(one, tuple) and isinstance(other, tuple) and len(one) == len(other):
        return all(map(_same, one, other))
    return one is other or (isinstance(one, str | int | float | Phase) and one == other)


def _empty_space(scene: Scene, volume: PackedVolume) -> Effect:
    if volume.empty:
        cuts = scene.clip or scene.crop or scene.mask is not None
        who = "the transfer function and the cuts make" if cuts else "the transfer function makes"
        return Effect("medium", False, f"{who} the whole volume transparent")
    return Effect("medium", True, estimator_words(scene, volume.medium))


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
    if voxels.unit != 1:
        notes.append(f"values are kept in units of {voxels.unit:g} to fit float32")
    if tables.capped:
        notes.append(
            f"extinction was cut off at {DEEPEST_VOXEL:g} optical depths per smallest voxel edge, "
            f"or {DEEPEST_VOLUME:g} per diagonal of the volume"
        )
    if tables.too_fine:
        notes.append(
            f"transfer function nodes lie closer than the table resolves ({tables.pitch:g})"
        )
    return tuple(notes)
