"""Colour of glowing bodies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import checks
from .base import Vector

# Planck's law over wavelength: second radiation constant h c / k in metre kelvin (CODATA 2018)
C2 = 1.438776877e-2
# CIE 1931 colour matching functions as sums of two-sided Gaussians: height, centre, width below and
# above it in nm (Wyman, Sloan and Shirley, JCGT 2(2), 2013)
LOBES = {
    "x": ((1.056, 599.8, 37.9, 31.0), (0.362, 442.0, 16.0, 26.7), (-0.065, 501.1, 20.4, 26.2)),
    "y": ((0.821, 568.8, 46.9, 40.5), (0.286, 530.9, 16.3, 31.1)),
    "z": ((1.217, 437.0, 11.8, 36.0), (0.681, 459.0, 26.0, 13.8)),
}
RGB_OF_XYZ = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)


def blackbody(kelvin: float, luminance: float = 1.0) -> Vector:
    """Colour of a black body, linear Rec. 709, not adapted to any white.

    Parameters
    ----------
    kelvin : float
        Temperature, 1000 to 40000. Below some 1900 K the colour lies outside of Rec. 709: its
        negative blue becomes 0, red and green are scaled to keep the luminance.
    luminance : float
        Luminance 0.2126 R + 0.7152 G + 0.0722 B of the result, >= 0.

    Returns
    -------
    3 floats
        To be used as radiance, irradiance or intensity of a light.
    """
    checks.number("kelvin", kelvin, least=1000.0, most=40000.0)
    checks.number("luminance", luminance, least=0.0)
    rgb = np.maximum(RGB_OF_XYZ @ chromatic_response(kelvin), 0.0)
    rgb *= luminance / (rgb @ (0.2126, 0.7152, 0.0722))
    return float(rgb[0]), float(rgb[1]), float(rgb[2])


def chromatic_response(kelvin: float) -> NDArray[np.float64]:
    """CIE XYZ of a black body, Y = 1."""
    nm = np.arange(360.0, 831.0)
    metres = nm * 1e-9
    spectrum = metres**-5 / np.expm1(C2 / (metres * kelvin))
    xyz = np.array([spectrum @ _matching(nm, LOBES[name]) for name in "xyz"])
    return xyz / xyz[1]


def _matching(nm: NDArray, lobes: tuple[tuple[float, ...], ...]) -> NDArray:
    return np.sum(
        [a * np.exp(-0.5 * ((nm - c) / np.where(nm < c, lo, hi)) ** 2) for a, c, lo, hi in lobes],
        axis=0,
    )
