"""How a picture is displayed: settings that trace no ray."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import checks, packed
from .film.filter import GAUSSIAN, gaussian_5x5
from .pack import f32, vector
from .pictures.display import decode, to_rgba8, to_rgba16

Colour = tuple[float, float, float]
FILM_FILTERS = ("none", "gaussian-5x5")
CURVES = ("film", "none")
TO_RGBA: dict[int, Callable[..., NDArray[Any]]] = {8: to_rgba8, 16: to_rgba16}


@dataclass(frozen=True)
class Display:
    """How radiance becomes pixels; changing it traces no ray.

    Parameters
    ----------
    exposure : float
        Stops; +1 doubles the brightness before tone mapping.
    background : (r, g, b), optional
        Display colour from 0 to 1 behind the volume. None: transparent.
    gamma : float, optional
        Encode by the power 1 / gamma, as in Exposure Render, > 0. None: sRGB.
    film_filter : {"none", "gaussian-5x5"}
        "gaussian-5x5" blurs the film before tone mapping, as Exposure Render does with samples of
        `PixelFilter("box", 0.5)`.
    curve : {"film", "none"}
        Tone curve of Exposure Render, or none: light above 1 is cut off. With gamma 1 as well,
        numbers are displayed as they are.
    """

    exposure: float = 0.0
    background: Colour | None = None
    gamma: float | None = None
    film_filter: str = "none"
    curve: str = "film"

    def __post_init__(self) -> None:
        checks.number("exposure", self.exposure)
        if self.gamma is not None:
            checks.number("gamma", self.gamma, above=0.0, most=10.0)
        if self.film_filter not in FILM_FILTERS:
            raise ValueError(
                f"film_filter is one of {', '.join(FILM_FILTERS)}; got {self.film_filter!r}"
            )
        checks.choice("curve", self.curve, CURVES)
        if self.background is not None:
            behind = checks.colour("background", self.background)
            if max(behind) > 1:
                raise ValueError(f"background must be (r, g, b) in 0..1, got {self.background!r}")
            object.__setattr__(self, "background", behind)


def shown(radiance: NDArray, alpha: NDArray | None, display: Display, bits: int = 8) -> NDArray:
    """Display picture of a film; see `vtkmcvr.pictures.display.to_rgba8` and `to_rgba16`."""
    if bits not in TO_RGBA:
        raise ValueError(f"a picture has 8 or 16 bits, got {bits!r}")
    if display.film_filter == "gaussian-5x5":
        radiance = gaussian_5x5(radiance)
        alpha = None if alpha is None else gaussian_5x5(alpha)
    return TO_RGBA[bits](
        radiance, alpha,
        exposure=display.exposure, background=display.background, gamma=display.gamma,
        curve=display.curve,
    )  # fmt: skip


def packed_screen(display: Display) -> packed.Screen:
    """The same for a film on a device. Exposures beyond 126 stops are 126 there."""
    window = np.array(GAUSSIAN, f32) if display.film_filter == "gaussian-5x5" else None
    background = display.background
    return packed.Screen(
        scale=f32(2.0 ** min(max(display.exposure, -126.0), 126.0)),
        film_like=np.bool_(display.curve == "film"),
        power=f32(0 if display.gamma is None else 1 / display.gamma),
        window=window,
        background=None if background is None else vector(decode(background, display.gamma)),
    )
