"""Constant radiance in place of a scene's lights."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..lights import (
    CameraLight,
    ConstantEnvironment,
    EnvironmentMap,
    GradientEnvironment,
    Light,
    PointLight,
    irradiance_at,
)
from ..scene import Scene

# Mean cosine of the light over a hemisphere of surfaces
FACING = 0.5
# Share of the end colours in a gradient's mean: integral of (2 e / pi) cos(e) over elevations e
ENDS = 1 - 2 / math.pi


def ambient_radiance(scene: Scene) -> NDArray[np.float64]:
    """Radiance that gives surfaces at the volume's centre the irradiance of all lights together.

    Lights that are not all around count half: the mean over surfaces turned away from them by up to
    90 degrees. Without lights, radiance 1. Linear RGB.
    """
    if not scene.lights:
        return np.ones(3)
    lights = [
        light.seen_by(scene.camera) if isinstance(light, CameraLight) else light
        for light in scene.lights
    ]
    return np.sum([_radiance(light, scene.volume.centre) for light in lights], axis=0)


def _radiance(light: Light, centre: NDArray) -> NDArray[np.float64]:
    if isinstance(light, ConstantEnvironment):
        return irradiance_at(light, centre) / math.pi
    if isinstance(light, EnvironmentMap):
        rows, columns, _ = light.pixels.shape
        edges = np.cos(np.linspace(0, math.pi, rows + 1))
        by_row = (edges[:-1] - edges[1:]) / 2
        return light.scale * np.einsum("rcx,r->x", light.pixels, by_row) / columns
    if isinstance(light, GradientEnvironment):
        top, middle, bottom = (np.array(c) for c in (light.top, light.middle, light.bottom))
        return light.scale * (ENDS * (top + bottom) / 2 + (1 - ENDS) * middle)
    if isinstance(light, PointLight) and np.allclose(light.position, centre):
        return np.zeros(3)
    return irradiance_at(light, centre) * FACING / math.pi
