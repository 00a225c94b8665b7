"""Lights of a scene -> packed lights, and the set to choose from."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..effects import Effect
from ..lights import AreaLight, DirectionalLight, EnvironmentMap, Light, PointLight
from ..scene import Scene
from ..volume import Volume
from .area_lights import Emitter, area_leaf, emitters_of, pack_area_lights
from .delta_lights import delta_leaf, merged, pack_delta_lights
from .environment import map_leaf, pack_ambient, pack_map
from .light_tree import Leaf, pack_set

# Of the volume along each axis
PLACES = 3


@dataclass(frozen=True)
class PackedLights:
    """Packed lights and the effects that they are."""

    ambient: packed.Ambient | None
    environment: packed.Environment | None
    area_lights: packed.AreaLights | None
    delta_lights: packed.DeltaLights | None
    all_lights: packed.LightSet | None
    choice: packed.LightChoice | None
    effects: tuple[Effect, ...]
    notes: tuple[str, ...]

    @property
    def any(self) -> bool:
        """Whether any light shines."""
        return bool(self.ambient or self.choice)


def pack_lights(scene: Scene) -> PackedLights:
    """Pack the lights of a scene.

    Black lights are left out, but area lights still block light. Lights that coincide, which could
    not all be seen, are one that is as bright as they are together.
    """
    lights = [light.seen_by(scene.camera) for light in scene.lights]
    ambient = pack_ambient(lights)
    maps = [light for light in lights if isinstance(light, EnvironmentMap)]
    environment = pack_map(maps[0]) if maps and maps[0].scale and maps[0].pixels.any() else None
    emitters = emitters_of([light for light in lights if isinstance(light, AreaLight)])
    given = [light for light in lights if isinstance(light, (DirectionalLight, PointLight))]
    deltas = merged([light for light in given if any(light.brightness)])
    added = sum(emitter.merged for emitter in emitters)
    added += sum(any(light.brightness) for light in given) - len(deltas)

    centre = scene.volume.centre
    leaves = [area_leaf(emitter, centre) for emitter in emitters]
    leaves += [delta_leaf(light, scene) for light in deltas]
    if environment is not None:
        leaves.append(map_leaf(maps[0]))
    choice = _choice(leaves, environment is not None, scene.light_sampling)
    return PackedLights(
        ambient,
        environment,
        pack_area_lights(emitters, scene.volume),
        pack_delta_lights(deltas, scene),
        pack_set(leaves, _places(scene.volume)) if emitters or choice else None,
        choice,
        _effects(scene, lights, ambient, environment, emitters, deltas, choice),
        (f"{added} lights coincide with another and were added to it",) if added else (),
    )


def _places(volume: Volume) -> NDArray[np.float64]:
    """Places spread over the volume, relative to its centre."""
    steps = (np.arange(PLACES) + 0.5) / PLACES - 0.5
    corner, *ends = volume.corners[[0, 1, 2, 4]]
    grid = np.stack(np.meshgrid(steps, steps, steps), -1).reshape(-1, 3)
    return grid @ (ends - corner)


def _effects(
    scene: Scene,
    lights: list[Light],
    ambient: packed.Ambient | None,
    environment: packed.Environment | None,
    emitters: list[Emitter],
    deltas: list[Light],
    choice: packed.LightChoice | None,
) -> tuple[Effect, ...]:
    gradient = ambient is not None and ambient.gradient is not None
    kinds = Counter(emitter.patch.kind for emitter in emitters)
    shapes = ", ".join(f"{n} {kind}{'s' * (n > 1)}" for kind, n in sorted(kinds.items()))
    drawn = "drawn by the scattering"
    return (
        Effect("constant environment", ambient is not None and not gradient, _why(ambient, drawn)),
        Effect("gradient environment", gradient, drawn if gradient else "none, or black"),
        Effect("environment map", environment is not None, _why(environment, "drawn by radiance")),
        Effect("area lights", bool(emitters), shapes or "none"),
        _texture_effect(emitters),
        Effect("point and directional lights", bool(deltas), _delta_reason(deltas)),
        _mis_effect(scene, choice, environment, emitters),
    )


def _why(part: object, how: str) -> str:
    return how if part is not None else "none, or black"


def _texture_effect(emitters: list[Emitter]) -> Effect:
    count = sum(emitter.texture is not None for emitter in emitters)
    why = f"on {count} of {len(emitters)} surfaces" if count else "no area light has one"
    return Effect("light textures", bool(count), why)


def _delta_reason(deltas: list[Light]) -> str:
    return f"{len(deltas)}, one shadow ray each time" if deltas else "none, or black"


def _mis_effect(scene: Scene, choice: object, environment: object, emitters: list) -> Effect:
    name = "multiple importance sampling"
    if choice is None or (environment is None and not emitters):
        return Effect(name, False, "no light can be found by two strategies")
    if scene.light_sampling != "mis":
        return Effect(name, False, f"directions are drawn by {scene.light_sampling} only")
    return Effect(name, True, "power heuristic over lights and scattering function")


def _choice(leaves: list[Leaf], has_map: bool, light_sampling: str) -> packed.LightChoice | None:
    if not any(leaf.flux > 0 for leaf in leaves):
        return None
    return packed.LightChoice(
        np.int32(len(leaves) - 1 if has_map else -1),
        np.bool_(light_sampling != "scatter"),
        np.bool_(light_sampling != "light"),
    )
