"""Lights that follow the camera."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..camera import Camera
from .area import AreaLight
from .base import Light
from .distant import DirectionalLight
from .point import PointLight


@dataclass(frozen=True)
class CameraLight(Light):
    """Light fixed to the camera.

    Its coordinates are those of VTK's camera lights: the camera is at (0, 0, 1), the focal point at
    (0, 0, 0), y is up and x to the right; one unit is the distance between camera and focal point.
    Sizes and radii scale with it; radiance, irradiance and intensity are those of the world.

    Parameters
    ----------
    light : AreaLight, DirectionalLight or PointLight
    """

    light: Light

    def __post_init__(self) -> None:
        if not isinstance(self.light, (AreaLight, DirectionalLight, PointLight)):
            raise ValueError(
                "a camera light holds an area, directional or point light, "
                f"got {type(self.light).__name__}"
            )

    def seen_by(self, camera: Camera) -> Light:
        """Return the light in world coordinates."""
        right, up, forward = camera.frame
        rotation = np.stack([right, up, -forward], axis=1)
        return self.light.moved(rotation, np.array(camera.focal_point), camera.distance)


def headlight(irradiance: Any = 1.0) -> CameraLight:
    """Return parallel light along the view, as VTK's headlight."""
    return CameraLight(DirectionalLight((0.0, 0.0, -1.0), irradiance))
