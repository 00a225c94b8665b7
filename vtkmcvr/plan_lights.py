"""Lights of a scene -> packed lights, with the tree that chooses among them."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import packed
from .effects import Effect
from .lights import (
    AreaLight,
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    GradientEnvironment,
    Light,
    PointLight,
)
from .pack import f32, matrix, vector
from .plan_area_lights import Emitter, area_leaf, emitters_of, pack_area_lights
from .plan_light_tree import AROUND, DECAYING, DISTANT, STEADY, Leaf, build_tree
from .scene import Scene

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class PackedLights:
    """Packed lights and the effects that they are."""

    ambient: packed.Ambient | None
    environment: packed.Environment | None
    area_lights: packed.AreaLights | None
    delta_lights: packed.DeltaLights | None
    tree: packed.LightTree | None
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
    ambient = _ambient(lights)
    maps = [light for light in lights if isinstance(light, EnvironmentMap)]
    environment = _environment(maps[0]) if maps and maps[0].scale and maps[0].pixels.any() else None
    emitters = emitters_of([light for light in lights if isinstance(light, AreaLight)])
    given = [light for light in lights if isinstance(light, (DirectionalLight, PointLight))]
    deltas = _merged([light for light in given if any(light.brightness)])
    merged = sum(emitter.merged for emitter in emitters)
    merged += sum(any(light.brightness) for light in given) - len(deltas)

    centre = scene.volume.centre
    leaves = [area_leaf(emitter, centre) for emitter in emitters]
    leaves += [_delta_leaf(light, scene) for light in deltas]
    if environment is not None:
        leaves.append(_map_leaf(maps[0]))
    choice = _choice(leaves, environment is not None, scene.light_sampling)
    return PackedLights(
        ambient,
        environment,
        pack_area_lights(emitters, scene.volume),
        _deltas(deltas, scene),
        build_tree(leaves) if emitters or choice else None,
        choice,
        _effects(scene, lights, ambient, environment, emitters, deltas, choice),
        (f"{merged} lights coincide with another and were added to it",) if merged else (),
    )


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


# Environments


def _ambient(lights: list[Light]) -> packed.Ambient | None:
    """Constant and gradient together: the constant is a gradient of one colour."""
    constant, rise = np.zeros(3), np.zeros((3, 3))
    up = (0.0, 0.0, 1.0)
    for light in lights:
        if isinstance(light, ConstantEnvironment):
            constant = constant + light.brightness
        elif isinstance(light, GradientEnvironment):
            rise, up = light.scale * np.array([light.top, light.middle, light.bottom]), light.up
    top, middle, bottom = rise + constant
    if not (top.any() or middle.any() or bottom.any()):
        return None
    even = np.array_equal(top, middle) and np.array_equal(middle, bottom)
    gradient = packed.Gradient(vector(np.array(up)), vector(top), vector(bottom))
    return packed.Ambient(vector(middle), None if even else gradient)


def _environment(light: EnvironmentMap) -> packed.Environment:
    """Distribution over texels: exact mean of the bilinear interpolant times solid angle."""
    pixels = np.ascontiguousarray(light.pixels * f32(light.scale), f32)
    rows = len(pixels)
    luminance = pixels.astype(np.float64) @ LUMINANCE
    tall = np.pad(luminance, ((1, 1), (0, 0)), mode="edge")
    blurred = (tall[:-2] + 6 * tall[1:-1] + tall[2:]) / 8
    blurred = (np.roll(blurred, 1, 1) + 6 * blurred + np.roll(blurred, -1, 1)) / 8
    edges = np.cos(np.pi * np.arange(rows + 1) / rows)
    weight = blurred * (edges[:-1] - edges[1:])[:, None]
    local_from_world = np.asarray(light.rotation).T
    return packed.Environment(
        pixels,
        _cdf(weight.sum(axis=1)),
        np.ascontiguousarray([_cdf(row) for row in weight], f32),
        matrix(local_from_world),
        matrix(local_from_world.T),
    )


def _cdf(weight: NDArray) -> NDArray[np.float32]:
    """Cumulative distribution from 0 to exactly 1; even where all weights are 0."""
    total = weight.sum()
    steps = weight / total if total > 0 else np.full(len(weight), 1 / len(weight))
    cdf = np.concatenate([[0.0], np.cumsum(steps)])
    return np.ascontiguousarray(cdf / cdf[-1], f32)


def _map_leaf(light: EnvironmentMap) -> Leaf:
    mean = float((light.pixels.mean(axis=(0, 1)) @ LUMINANCE) * light.scale)
    return Leaf(AROUND, math.pi * max(mean, 1e-30))


# Point and directional lights


def _merged(lights: list[Light]) -> list[Light]:
    """Lights that differ in brightness alone become one."""
    sums: dict[Light, NDArray] = {}
    for light in lights:
        unit = light.with_brightness(1.0)
        sums[unit] = sums.get(unit, np.zeros(3)) + light.brightness
    return [unit.with_brightness(total) for unit, total in sums.items()]


def _deltas(lights: list, scene: Scene) -> packed.DeltaLights | None:
    if not lights:
        return None
    directional = [isinstance(light, DirectionalLight) for light in lights]
    nowhere = (0.0, 0.0, 0.0)
    positions = [
        nowhere if far else np.subtract(light.position, scene.volume.centre)
        for far, light in zip(directional, lights, strict=True)
    ]
    pairs = list(zip(directional, lights, strict=True))
    return packed.DeltaLights(
        np.array([0 if far else 1 for far in directional], np.int32),
        _table(positions),
        _table([light.direction for light in lights]),
        _table([light.brightness for light in lights]),
        _table([nowhere if far else light.attenuation for far, light in pairs]),
        _table([(-2.0, 0.0) if far else _cone(light) for far, light in pairs]),
    )


def _table(rows: object) -> NDArray[np.float32]:
    return np.ascontiguousarray(rows, f32)


def _cone(light: PointLight) -> tuple[float, float]:
    # A full cone must not lose the one direction whose cosine rounds to below -1
    cosine = -2.0 if light.cone_angle >= 180 else math.cos(math.radians(light.cone_angle))
    return cosine, light.exponent


def _delta_leaf(light: Light, scene: Scene) -> Leaf:
    """Bounds of a point or directional light; a falloff between two laws counts as the nearer."""
    flux = float(np.dot(light.brightness, LUMINANCE))
    if isinstance(light, DirectionalLight):
        return Leaf(DISTANT, flux, axis=np.array(light.direction), spread=0.0)
    assert isinstance(light, PointLight)
    place = np.subtract(light.position, scene.volume.centre)
    a, b, c = light.attenuation
    distance = max(float(np.linalg.norm(place)), 1e-3 * scene.volume.radius)
    falloff = a + b * distance + c * distance**2
    decays = b * distance + 2 * c * distance**2 >= falloff
    flux *= distance**2 / falloff if decays else 1 / falloff
    cone = light.cone_angle < 90
    return Leaf(
        DECAYING if decays else STEADY,
        flux,
        place,
        0.0,
        np.array(light.direction),
        spread=0.0 if cone else math.pi,
        reach=math.radians(light.cone_angle) if cone else math.pi / 2,
    )


def _choice(leaves: list[Leaf], has_map: bool, light_sampling: str) -> packed.LightChoice | None:
    if not any(leaf.flux > 0 for leaf in leaves):
        return None
    return packed.LightChoice(
        np.int32(len(leaves) - 1 if has_map else -1),
        np.bool_(light_sampling != "scatter"),
        np.bool_(light_sampling != "light"),
    )
