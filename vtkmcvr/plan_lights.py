"""Lights of a scene -> packed lights, with the distribution that chooses among them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import packed
from .effects import Effect
from .lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    PointLight,
    RectangleLight,
)
from .pack import f32, matrix, vector
from .scene import Scene

# Share of the choice among lights that ignores their estimated contribution
EVEN_SHARE = 0.1
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class PackedLights:
    """Packed lights and the effects that they are."""

    ambient: packed.Ambient | None
    environment: packed.Environment | None
    rectangles: packed.Rectangles | None
    delta_lights: packed.DeltaLights | None
    choice: packed.LightChoice | None
    effects: tuple[Effect, ...]

    @property
    def any(self) -> bool:
        """Whether any light shines."""
        return bool(self.ambient or self.choice)


def pack_lights(scene: Scene) -> PackedLights:
    """Pack the lights of a scene; black ones are left out, but rectangles still block light."""
    ambient = _ambient(scene)
    maps = [light for light in scene.lights if isinstance(light, EnvironmentMap)]
    environment = _environment(maps[0]) if maps and maps[0].scale and maps[0].pixels.any() else None
    rectangles = [light for light in scene.lights if isinstance(light, RectangleLight)]
    deltas = [
        light
        for light in scene.lights
        if (isinstance(light, DirectionalLight) and any(_rgb(light.irradiance)))
        or (isinstance(light, PointLight) and any(_rgb(light.intensity)))
    ]
    weights = [_rectangle_weight(light, scene) for light in rectangles]
    weights += [_delta_weight(light, scene) for light in deltas]
    anchors = [_anchor(light, scene) for light in (*rectangles, *deltas)]
    if environment is not None:
        mean = float((maps[0].pixels.mean(axis=(0, 1)) @ LUMINANCE) * maps[0].scale)
        weights.append(math.pi * max(mean, 1e-30))
        anchors.append((0.0, 0.0, 0.0, -1.0))
    choice = _choice(weights, anchors, environment is not None, scene.light_sampling)
    effects = (
        Effect(
            "constant environment", ambient is not None, _why(ambient, "drawn by the scattering")
        ),
        Effect("environment map", environment is not None, _why(environment, "drawn by radiance")),
        Effect(
            "area lights",
            bool(rectangles),
            f"{len(rectangles)} rectangles" if rectangles else "none",
        ),
        Effect("point and directional lights", bool(deltas), _delta_reason(deltas)),
        _mis_effect(scene, choice, environment, rectangles),
    )
    return PackedLights(
        ambient,
        environment,
        _rectangles(rectangles, scene),
        _deltas(deltas, scene),
        choice,
        effects,
    )


def _why(part: object, how: str) -> str:
    return how if part is not None else "none, or black"


def _delta_reason(deltas: list) -> str:
    return f"{len(deltas)}, one shadow ray each time" if deltas else "none, or black"


def _mis_effect(scene: Scene, choice: object, environment: object, rectangles: list) -> Effect:
    name = "multiple importance sampling"
    if choice is None or (environment is None and not rectangles):
        return Effect(name, False, "no light can be found by two strategies")
    if scene.light_sampling != "mis":
        return Effect(name, False, f"directions are drawn by {scene.light_sampling} only")
    return Effect(name, True, "power heuristic over lights and scattering function")


def _ambient(scene: Scene) -> packed.Ambient | None:
    for light in scene.lights:
        if isinstance(light, ConstantEnvironment) and any(_rgb(light.radiance)):
            return packed.Ambient(vector(np.array(_rgb(light.radiance))))
    return None


def _rgb(value: object) -> tuple[float, float, float]:
    """Return a validated colour of a light, which is three numbers by now."""
    return value  # type: ignore[return-value]


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


def _rectangles(lights: list[RectangleLight], scene: Scene) -> packed.Rectangles | None:
    if not lights:
        return None
    frames = [light.frame for light in lights]
    u = np.array([frame[0] * light.size[0] for frame, light in zip(frames, lights, strict=True)])
    v = np.array([frame[1] * light.size[1] for frame, light in zip(frames, lights, strict=True)])
    centre = np.array([light.centre for light in lights]) - scene.volume.centre
    return packed.Rectangles(
        _table(centre - u / 2 - v / 2),
        _table(u),
        _table(v),
        _table([frame[2] for frame in frames]),
        _table([light.size[0] * light.size[1] for light in lights]),
        _table([light.radiance for light in lights]),
        np.array([light.two_sided for light in lights], np.bool_),
        np.array([light.visible for light in lights], np.bool_),
    )


def _table(rows: object) -> NDArray[np.float32]:
    return np.ascontiguousarray(rows, f32)


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
        _table([light.irradiance if far else light.intensity for far, light in pairs]),
        _table([nowhere if far else light.attenuation for far, light in pairs]),
        _table([(-2.0, 0.0) if far else _cone(light) for far, light in pairs]),
    )


def _cone(light: PointLight) -> tuple[float, float]:
    # A full cone must not lose the one direction whose cosine rounds to below -1
    cosine = -2.0 if light.cone_angle >= 180 else math.cos(math.radians(light.cone_angle))
    return cosine, light.exponent


def _rectangle_weight(light: RectangleLight, scene: Scene) -> float:
    """Estimated irradiance at the volume's centre, at least as seen at a grazing angle."""
    toward = scene.volume.centre - np.array(light.centre)
    distance = max(float(np.linalg.norm(toward)), 1e-30)
    cosine = float(light.frame[2] @ toward) / distance
    cosine = max(abs(cosine) if light.two_sided else cosine, 0.1)
    area = light.size[0] * light.size[1]
    return float(np.dot(light.radiance, LUMINANCE)) * min(area * cosine / distance**2, math.pi)


def _delta_weight(light: DirectionalLight | PointLight, scene: Scene) -> float:
    """Irradiance at the volume's centre on a facing plane, without the cone."""
    if isinstance(light, DirectionalLight):
        return float(np.dot(light.irradiance, LUMINANCE))
    distance = float(np.linalg.norm(np.subtract(light.position, scene.volume.centre)))
    distance = max(distance, 1e-3 * scene.volume.radius)
    falloff = np.dot(light.attenuation, (1.0, distance, distance**2))
    return float(np.dot(light.intensity, LUMINANCE) / falloff)


def _choice(
    weights: list[float], anchors: list[tuple], has_map: bool, light_sampling: str
) -> packed.LightChoice | None:
    w = np.array(weights, np.float64)
    shining = w > 0
    if not shining.any():
        return None
    even = shining / shining.sum()
    return packed.LightChoice(
        _table(EVEN_SHARE * even + (1 - EVEN_SHARE) * w / w.sum()),
        _table(anchors),
        np.int32(len(weights) - 1 if has_map else -1),
        np.bool_(light_sampling != "scatter"),
        np.bool_(light_sampling != "light"),
    )


def _anchor(light: RectangleLight | DirectionalLight | PointLight, scene: Scene) -> tuple:
    """Where the light is seen: its position, or the direction to it."""
    if isinstance(light, DirectionalLight):
        return (*np.negative(light.direction), 0.0)
    place = light.centre if isinstance(light, RectangleLight) else light.position
    return (*np.subtract(place, scene.volume.centre), 1.0)
