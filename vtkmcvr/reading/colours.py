"""Colours of segments."""

from __future__ import annotations

import colorsys
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

GOLDEN_RATIO = 0.618033988749895
WHITE_D50 = np.array([0.96422, 1.0, 0.82521])
# XYZ of illuminant D50 to linear sRGB, adapted after Bradford.
LINEAR_FROM_XYZ = np.array(
    [
        [3.1338561, -1.6168667, -0.4906146],
        [-0.9787684, 1.9161415, 0.0334540],
        [0.0719453, -0.2289914, 1.4052427],
    ]
)


def spread_colour(value: int) -> tuple[float, float, float]:
    """Return an sRGB colour for a label without one, far from those of its neighbours."""
    hue = value * GOLDEN_RATIO % 1.0
    return colorsys.hsv_to_rgb(hue, 0.45 + 0.25 * (value % 3) / 2, 0.95 - 0.2 * (value % 2))


def rgb_of_dicom_lab(stored: Sequence[float]) -> tuple[float, float, float]:
    """Return the sRGB colour of a DICOM CIELab triplet.

    Parameters
    ----------
    stored : sequence of 3 numbers
        L*, a* and b* scaled to 0 .. 65535, relative to D50 (PS3.3 section C.10.7.1.1).
    """
    lightness = stored[0] / 65535 * 100
    a, b = (value / 65535 * 255 - 128 for value in stored[1:])
    y = (lightness + 16) / 116
    roots = np.array([y + a / 500, y, y - b / 200])
    delta = 6 / 29
    xyz = np.where(roots > delta, roots**3, 3 * delta**2 * (roots - 4 / 29)) * WHITE_D50
    linear = np.clip(LINEAR_FROM_XYZ @ xyz, 0.0, 1.0)
    curved = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    red, green, blue = (float(x) for x in curved)
    return red, green, blue
