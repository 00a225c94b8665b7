"""Patterns on area lights: images, or functions that are sampled once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import checks

Pattern = Callable[[NDArray, NDArray], NDArray]


@dataclass(frozen=True, eq=False)
class Texture:
    """Factors of the radiance over a light's surface, bilinear between texel centres.

    Parameters
    ----------
    pixels : array (rows, columns, 3) or (rows, columns)
        Linear RGB factors, finite and >= 0; row 0 on top.
    """

    pixels: NDArray[np.float32]

    def __post_init__(self) -> None:
        pixels = np.asarray(self.pixels, np.float32)
        if pixels.ndim == 2:
            pixels = np.repeat(pixels[..., None], 3, axis=2)
        if pixels.ndim != 3 or pixels.shape[2] != 3 or min(pixels.shape[:2]) < 1:
            raise ValueError(f"a texture has shape (rows, columns, 3), got {pixels.shape}")
        if not np.isfinite(pixels).all() or pixels.min() < 0:
            raise ValueError("a texture must be finite and not negative")
        object.__setattr__(self, "pixels", np.ascontiguousarray(pixels))

    @classmethod
    def of(cls, pattern: Pattern, size: tuple[int, int] = (256, 256)) -> Texture:
        """Texture of a function, sampled at texel centres.

        Parameters
        ----------
        pattern : callable
            Takes arrays s (from left to right) and t (upward), both in [0, 1]; returns factors of
            shape (...) or (..., 3).
        size : (columns, rows)
        """
        columns = checks.whole("texture columns", size[0], least=1)
        rows = checks.whole("texture rows", size[1], least=1)
        s = (np.arange(columns) + 0.5) / columns
        t = 1 - (np.arange(rows) + 0.5) / rows
        return cls(np.asarray(pattern(*np.meshgrid(s, t)), np.float32))

    @property
    def mean(self) -> NDArray[np.float64]:
        """Mean factor over the texels, linear RGB."""
        return self.pixels.mean(axis=(0, 1), dtype=np.float64)


def checkerboard(columns: int, rows: int, dark: float = 0.0) -> Pattern:
    """Fields of factor 1 and `dark` in turn, the lower left one bright."""

    def pattern(s: NDArray, t: NDArray) -> NDArray:
        odd = (np.floor(s * columns) + np.floor(t * rows)) % 2
        return np.where(odd == 1, dark, 1.0)

    return pattern


def softbox(edge: float = 0.3) -> Pattern:
    """1 in the middle, falling smoothly to 0 over `edge` of the half width at each border."""
    checks.number("softbox edge", edge, above=0.0, most=1.0)

    def pattern(s: NDArray, t: NDArray) -> NDArray:
        inside = np.minimum(1 - np.abs(2 * s - 1), 1 - np.abs(2 * t - 1))
        x = np.clip(inside / edge, 0, 1)
        return x * x * (3 - 2 * x)

    return pattern
