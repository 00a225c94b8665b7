"""Constant radiance in place of a scene's lights."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..lights import ConstantEnvironment, DirectionalLight, EnvironmentMap, PointLight
from ..lights import RectangleLight as Rectangle
from ..scene import Scene

# Mean cosine of the light over a hemisphere of surfaces
FACING = 0.5


def ambient_radiance(scene: Scene) -> NDArray[np.float64]:
    """Radiance that gives surfaces at the volume's centre the irradiance of all lights together.

    Lights that are not all around count half: the mean over surfaces turned away from them by up to
    90 degrees. Without lights, radiance 1. Linear RGB.
    """
    if not scene.lights:
        return np.ones(3)
    return np.sum([_radiance(light, scene.volume.centre) for light in scene.lights], axis=0)


def _radiance(light: object, centre: NDArray) -> NDArray[np.float64]:
    if isinstance(light, ConstantEnvironment):
        return np.array(light.radiance)
    if isinstance(light, EnvironmentMap):
        rows = len(light.pixels)
        edges = np.cos(np.linspace(0, math.pi, rows + 1))
        weight = (edges[:-1] - edges[1:]) / 2
        return light.scale * np.einsum("rcx,r->x", light.pixels, weight) / light.pixels.shape[1]
    if isinstance(light, DirectionalLight):
        return np.array(light.irradiance) * FACING / math.pi
    if isinstance(light, PointLight):
        r = float(np.linalg.norm(np.subtract(centre, light.position)))
        a, b, c = light.attenuation
        return np.array(light.intensity) / (a + b * r + c * r * r) * FACING / math.pi
    assert isinstance(light, Rectangle)
    apart = np.subtract(centre, light.centre)
    square = float(apart @ apart)
    cosine = abs(float(light.frame[2] @ apart)) / math.sqrt(square)
    share = light.size[0] * light.size[1] * cosine / (square * math.pi)
    return np.array(light.radiance) * min(share, 1.0) * FACING
