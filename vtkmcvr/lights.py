"""Lights that the user describes. Radiance is linear RGB; one number means grey."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import checks

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Light:
    """Base of all lights."""


@dataclass(frozen=True)
class ConstantEnvironment(Light):
    """The same radiance from every direction."""

    radiance: Vector | float = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "radiance", checks.colour("environment radiance", self.radiance))


@dataclass(frozen=True, eq=False)
class EnvironmentMap(Light):
    """High dynamic range panorama at infinity, sampled by its radiance.

    Parameters
    ----------
    pixels : array (rows, columns, 3)
        Radiance in latitude-longitude form, row 0 toward local +y; column x of n looks along local
        (sin phi, 0, -cos phi) with phi = 2 pi (x + 1/2) / n.
    scale : float
        Factor on the radiance, >= 0.
    rotation : array (3, 3), optional
        World from local directions, a rotation. Default: local +y is world +z (head-up for
        patients).
    """

    pixels: NDArray[np.float32]
    scale: float = 1.0
    rotation: NDArray[np.float64] = field(
        default_factory=lambda: np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
    )

    def __post_init__(self) -> None:
        pixels = np.asarray(self.pixels, np.float32)
        if pixels.ndim != 3 or pixels.shape[2] != 3 or min(pixels.shape[:2]) < 1:
            raise ValueError(f"an environment map has shape (rows, columns, 3), got {pixels.shape}")
        if not np.isfinite(pixels).all() or pixels.min() < 0:
            raise ValueError("an environment map must be finite and not negative")
        checks.number("environment scale", self.scale, least=0.0)
        rotation = np.asarray(self.rotation, np.float64)
        if (
            rotation.shape != (3, 3)
            or not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-6)
            or np.linalg.det(rotation) < 0
        ):
            raise ValueError(f"environment rotation must be a 3x3 rotation, got {self.rotation!r}")
        object.__setattr__(self, "pixels", pixels)
        object.__setattr__(self, "rotation", rotation)


@dataclass(frozen=True)
class RectangleLight(Light):
    """Rectangle that emits evenly from the side that faces its target.

    It blocks light, also with its dark side.

    Parameters
    ----------
    centre, target : 3 floats
        World coordinates; the normal points from centre to target.
    size : (width, height)
        World units, > 0.
    radiance : colour
        Radiance of the emitting side.
    up : 3 floats
        Direction of the height, as far as the normal leaves it.
    two_sided : bool
        Both sides emit.
    visible : bool
        Camera rays see it.
    """

    centre: Vector
    target: Vector
    size: tuple[float, float]
    radiance: Vector | float = (1.0, 1.0, 1.0)
    up: Vector = (0.0, 0.0, 1.0)
    two_sided: bool = False
    visible: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", checks.vector("light.centre", self.centre))
        object.__setattr__(self, "target", checks.vector("light.target", self.target))
        object.__setattr__(self, "radiance", checks.colour("light.radiance", self.radiance))
        checks.direction("light.up", self.up)
        for name, value in zip(("width", "height"), self.size, strict=True):
            checks.number(f"light {name}", value, above=0.0)
        checks.direction("light.target - light.centre", np.subtract(self.target, self.centre))

    @property
    def frame(self) -> tuple[NDArray, NDArray, NDArray]:
        """Unit vectors (along the width, along the height, normal)."""
        normal = np.array(checks.direction("normal", np.subtract(self.target, self.centre)))
        up = np.array(checks.direction("up", self.up))
        if abs(normal @ up) > 1 - 1e-9:
            up = np.eye(3)[int(np.argmin(np.abs(normal)))]
        right = np.cross(up, normal)
        right /= np.linalg.norm(right)
        return right, np.cross(normal, right), normal


@dataclass(frozen=True)
class DirectionalLight(Light):
    """Parallel light.

    Parameters
    ----------
    direction : 3 floats
        Direction in which the light travels.
    irradiance : colour
        Irradiance on a plane that faces the light.
    """

    direction: Vector
    irradiance: Vector | float = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "direction", checks.direction("light.direction", self.direction))
        object.__setattr__(self, "irradiance", checks.colour("light.irradiance", self.irradiance))


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

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", checks.vector("light.position", self.position))
        object.__setattr__(self, "intensity", checks.colour("light.intensity", self.intensity))
        attenuation = checks.colour("light.attenuation", self.attenuation)
        if max(attenuation) == 0:
            raise ValueError("light.attenuation must not be (0, 0, 0)")
        object.__setattr__(self, "direction", checks.direction("light.direction", self.direction))
        checks.number("light.cone_angle", self.cone_angle, above=0.0, most=180.0)
        checks.number("light.exponent", self.exponent, least=0.0)
