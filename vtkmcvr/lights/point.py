"""Light from one point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from .. import checks
from .base import Light, Vector


@dataclass(frozen=True)
class PointLight(Light):
    """Point or spot light.

    Parameters
    ----------
    position : 3 floats
        World coordinates.
    intensity : colour
        Power per steradian.
    attenuation : (a, b, c)
        The intensity arrives divided by a + b r + c r^2 at distance r; (0, 0, 1) is physically
        right.
    direction : 3 floats, optional
        Axis of the cone of a spot light.
    cone_angle : float
        Half angle of the cone in degrees, (0, 180]; 180 is no cone.
    exponent : float
        Falloff inside the cone, cosine to this power, >= 0.
    """

    position: Vector
    intensity: Vector | float = (1.0, 1.0, 1.0)
    attenuation: Vector = (0.0, 0.0, 1.0)
    direction: Vector = (0.0, 0.0, -1.0)
    cone_angle: float = 180.0
    exponent: float = 0.0

    quantity: ClassVar = "intensity"
    points: ClassVar = ("position",)
    directions: ClassVar = ("direction",)

    def __post_init__(self) -> None:
        self._check(checks.vector, "position")
        self._check(checks.colour, "intensity")
        attenuation = checks.colour("light.attenuation", self.attenuation)
        if max(attenuation) == 0:
            raise ValueError("light.attenuation must not be (0, 0, 0)")
        self._check(checks.direction, "direction")
        checks.number("light.cone_angle", self.cone_angle, above=0.0, most=180.0)
        checks.number("light.exponent", self.exponent, least=0.0)
