"""Canonical surfaces that emit. Area lights are made of them, and kernels know only them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Size = tuple[float, float, float]


class Patch(NamedTuple):
    """One canonical surface, turned and moved.

    Attributes
    ----------
    kind : str
        In the frame (u, v, w) around the centre. "rectangle": w = 0, normal w, size (half width
        along u, half height along v, 0). "disk": w = 0, normal w, size (radius, inner radius, 0).
        "sphere": size (radius, 0, 0). "cylinder": open tube around w, size (radius, 0, half
        height).
    centre : array (3,)
        World coordinates.
    axes : array (3, 3)
        Rows u, v, w, right-handed unit vectors.
    size : 3 floats
        World units.
    """

    kind: str
    centre: NDArray
    axes: NDArray
    size: Size

    @property
    def area(self) -> float:
        """Area of one side."""
        a, b, h = self.size
        if self.kind == "rectangle":
            return 4 * a * b
        if self.kind == "disk":
            return math.pi * (a * a - b * b)
        return 4 * math.pi * a * (a if self.kind == "sphere" else h)

    @property
    def face(self) -> float:
        """Area as seen from far away, from where it is largest."""
        a, _, h = self.size
        if self.kind == "sphere":
            return math.pi * a * a
        return 4 * a * h if self.kind == "cylinder" else self.area

    @property
    def radius(self) -> float:
        """Radius of the sphere around it."""
        a, b, h = self.size
        if self.kind == "rectangle":
            return math.hypot(a, b)
        return math.hypot(a, h)

    @property
    def flat(self) -> bool:
        """Whether it has one normal."""
        return self.kind in ("rectangle", "disk")

    def quadrature(self, n: int = 64) -> tuple[NDArray, NDArray, NDArray]:
        """Points (n^2, 3), normals (n^2, 3) and areas (n^2,) of a midpoint rule over the patch."""
        middles = (np.arange(n) + 0.5) / n
        s, t = np.tile(middles, n), np.repeat(middles, n)
        a, b, h = self.size
        phi = 2 * math.pi * s
        up: NDArray = np.tile((0.0, 0.0, 1.0), (n * n, 1))
        round_ = np.stack([np.cos(phi), np.sin(phi), 0 * phi], 1)
        if self.kind == "rectangle":
            local, normal = np.stack([(2 * s - 1) * a, (2 * t - 1) * b, 0 * s], 1), up
        elif self.kind == "disk":
            local, normal = round_ * np.sqrt(b * b + t * (a * a - b * b))[:, None], up
        elif self.kind == "sphere":
            normal = round_ * np.sqrt(1 - (2 * t - 1) ** 2)[:, None] + up * (2 * t - 1)[:, None]
            local = a * normal
        else:
            local, normal = a * round_ + up * ((2 * t - 1) * h)[:, None], round_
        area = np.full(n * n, self.area / (n * n))
        return self.centre + local @ self.axes, normal @ self.axes, area
