"""Phase functions of the volume: how light is spread where it scatters."""

from __future__ import annotations

from dataclasses import dataclass

from . import checks

MOST_FORWARD = 0.9999


@dataclass(frozen=True)
class Isotropic:
    """Equal in all directions."""


@dataclass(frozen=True)
class HenyeyGreenstein:
    """Henyey and Greenstein 1941.

    Parameters
    ----------
    g : float
        Mean cosine between the directions of propagation, -0.9999 to 0.9999.
    """

    g: float = 0.0

    def __post_init__(self) -> None:
        checks.number("g", self.g, least=-MOST_FORWARD, most=MOST_FORWARD)


@dataclass(frozen=True)
class Schlick:
    """Schlick's approximation (1 - k^2) / (4 pi (1 - k cos)^2) (Blasi, Le Saec, Schlick 1993).

    Parameters
    ----------
    k : float
        -0.9999 to 0.9999; k = 1.55 g - 0.55 g^3 comes close to Henyey and Greenstein's g.
    """

    k: float = 0.0

    def __post_init__(self) -> None:
        checks.number("k", self.k, least=-MOST_FORWARD, most=MOST_FORWARD)


@dataclass(frozen=True)
class Rayleigh:
    """Particles much smaller than the wavelength: 3 (1 + cos^2) / (16 pi)."""


@dataclass(frozen=True)
class Cone:
    """Constant where light comes from within a cone around the way back to the viewer.

    Directional Occlusion Shading (2009), Eq. 6.

    Parameters
    ----------
    angle : float
        Half angle, degrees, 0.01 to 180.
    """

    angle: float

    def __post_init__(self) -> None:
        checks.number("angle", self.angle, least=0.01, most=180.0)


Phase = Isotropic | HenyeyGreenstein | Schlick | Rayleigh | Cone
