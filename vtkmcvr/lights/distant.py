"""Light from infinity: environments and parallel light."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from .. import checks
from ..packed import MOST_TEXELS
from .base import Light, Vector


@dataclass(frozen=True)
class ConstantEnvironment(Light):
    """The same radiance from every direction."""

    radiance: Vector | float = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        object.__setattr__(self, "radiance", checks.colour("environment radiance", self.radiance))


@dataclass(frozen=True)
class GradientEnvironment(Light):
    """Three colours from below to above, linear in the angle of elevation.

    The background light of Exposure Render (2012), with the radiance of the direction that was
    drawn.

    Parameters
    ----------
    top, middle, bottom : colour
        Radiance from straight above, from the horizon, from straight below.
    up : 3 floats
        World direction of above.
    scale : float
        Factor on the radiance, >= 0.
    """

    top: Vector | float
    middle: Vector | float
    bottom: Vector | float
    up: Vector = (0.0, 0.0, 1.0)
    scale: float = 1.0

    directions: ClassVar = ("up",)

    def __post_init__(self) -> None:
        self._check(checks.colour, "top", "middle", "bottom")
        self._check(checks.direction, "up")
        checks.number("environment scale", self.scale, least=0.0)


@dataclass(frozen=True, eq=False)
class EnvironmentMap(Light):
    """High dynamic range panorama at infinity, sampled by its radiance.

    Parameters
    ----------
    pixels : array (rows, columns, 3)
        Radiance in latitude-longitude form, at most 131072 rows and columns; row 0 toward local
        +y, column x of n looks along local (sin phi, 0, -cos phi) with phi = 2 pi (x + 1/2) / n.
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
        if max(pixels.shape[:2]) > MOST_TEXELS:
            raise ValueError(
                f"an environment map has at most {MOST_TEXELS} rows and columns, got "
                f"{pixels.shape[0]} x {pixels.shape[1]}; make it smaller"
            )
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

    quantity: ClassVar = "irradiance"
    directions: ClassVar = ("direction",)

    def __post_init__(self) -> None:
        self._check(checks.direction, "direction")
        self._check(checks.colour, "irradiance")
