"""Point and directional lights -> packed ones."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..lights import DirectionalLight, Light, PointLight
from ..pack import f32
from ..scene import Scene
from .light_tree import DECAYING, DISTANT, LUMINANCE, STEADY, Leaf


def merged(lights: list[Light]) -> list[Light]:
    """Lights that differ in brightness alone become one."""
    sums: dict[Light, NDArray] = {}
    for light in lights:
        unit = light.with_brightness(1.0)
        sums[unit] = sums.get(unit, np.zeros(3)) + light.brightness
    return [unit.with_brightness(total) for unit, total in sums.items()]


def pack_delta_lights(lights: list, scene: Scene) -> packed.DeltaLights | None:
    """Pack them, None where there are none."""
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


def delta_leaf(light: Light, scene: Scene) -> Leaf:
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
