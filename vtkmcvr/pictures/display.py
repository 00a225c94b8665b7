"""From linear radiance to what a screen shows: tone curve, sRGB transfer, 8 and 16-bit pictures.

The tone curve is that of Exposure Render (Kroes, Post, Botha 2012, PLOS ONE 7(7): e38586) in its
corrected form: brighter exposure makes the picture brighter, and the sRGB transfer comes after it
instead of a plain gamma.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.floating]

# Stops at which volumes that only scatter, and those with surfaces, are about as bright as VTK's
EXPOSURE, SHADED_EXPOSURE = 2.5, 1.5

# IEC 61966-2-1: the straight part near black and where it ends
SRGB_SLOPE = 12.92
SRGB_LINEAR_END = 0.0031308
_ENCODED_END = 0.04045


def tone_map(radiance: ArrayLike, exposure: float = 0.0) -> Floats:
    """Return 1 - exp(-radiance * 2**exposure), the film-like curve of Exposure Render.

    Parameters
    ----------
    radiance : array_like
        Linear radiance of any shape; negative values (a filter's or denoiser's) count as 0.
    exposure : float
        Stops: each one more doubles the radiance before the curve.

    Returns
    -------
    numpy.ndarray
        Linear display light in [0, 1], 1 only where rounding leaves nothing else. float32 stays
        float32, anything else becomes float64. Dark values keep their relative precision.

    Raises
    ------
    ValueError
        Where the exposure or any radiance is not finite.
    """
    light = _finite("radiance", radiance)
    if not math.isfinite(exposure):
        raise ValueError(f"exposure must be a finite number of stops, got {exposure}")
    # more stops than any float has exponents leave black or white; so does the overflow
    whole = math.floor(min(max(exposure, -4096.0), 4096.0))
    with np.errstate(over="ignore", under="ignore"):
        scaled = np.ldexp(np.maximum(light, 0), whole)
        return -np.expm1(scaled * -(2.0 ** (exposure % 1.0)))


def cut_off(radiance: ArrayLike, exposure: float = 0.0) -> Floats:
    """Return radiance * 2**exposure in [0, 1], without a tone curve; else as `tone_map`."""
    light = _finite("radiance", radiance)
    if not math.isfinite(exposure):
        raise ValueError(f"exposure must be a finite number of stops, got {exposure}")
    with np.errstate(over="ignore", under="ignore"):
        # Cut off before and after, so that no infinity times zero comes in between
        scale = light.dtype.type(2.0 ** min(max(exposure, -126.0), 126.0))
        return np.clip(np.maximum(light, 0) * scale, 0, 1)


CURVES = {"film": tone_map, "none": cut_off}


def srgb_encode(linear: ArrayLike) -> Floats:
    """Encode linear light for an sRGB display (IEC 61966-2-1, exact in both pieces).

    Parameters
    ----------
    linear : array_like
        Linear Rec. 709 light; values outside 0..1 are clamped.

    Returns
    -------
    numpy.ndarray
        Encoded values in 0..1; float32 stays float32, anything else becomes float64.
    """
    light = np.clip(_floats(linear), 0, 1)
    curve = 1.055 * np.maximum(light, SRGB_LINEAR_END) ** (1 / 2.4) - 0.055
    return np.where(light <= SRGB_LINEAR_END, light * SRGB_SLOPE, curve)


def srgb_decode(encoded: ArrayLike) -> Floats:
    """Return the linear light of sRGB values: the inverse of `srgb_encode`.

    Parameters
    ----------
    encoded : array_like
        Display values; those outside 0..1 are clamped.

    Returns
    -------
    numpy.ndarray
        Linear light in 0..1; float32 stays float32, anything else becomes float64.
    """
    value = np.clip(_floats(encoded), 0, 1)
    curve = ((np.maximum(value, _ENCODED_END) + 0.055) / 1.055) ** 2.4
    return np.where(value <= _ENCODED_END, value / SRGB_SLOPE, curve)


def encode(linear: ArrayLike, gamma: float | None = None) -> Floats:
    """Encode linear light for a display: sRGB, or a plain power as in Exposure Render.

    Parameters
    ----------
    linear : array_like
        Linear light; values outside 0..1 are clamped.
    gamma : float, optional
        Encode by the power 1 / gamma, > 0. Default: the sRGB transfer.
    """
    if gamma is None:
        return srgb_encode(linear)
    return np.clip(_floats(linear), 0, 1) ** (1 / gamma)


def decode(encoded: ArrayLike, gamma: float | None = None) -> Floats:
    """Return the linear light of display values: the inverse of `encode`."""
    if gamma is None:
        return srgb_decode(encoded)
    return np.clip(_floats(encoded), 0, 1) ** gamma


def to_rgba8(
    radiance: ArrayLike,
    alpha: ArrayLike | None,
    *,
    exposure: float = 0.0,
    background: ArrayLike | None = None,
    gamma: float | None = None,
    curve: str = "film",
) -> NDArray[np.uint8]:
    """Make the 8-bit picture of a film.

    The picture has straight alpha, as PNG has it: colour times alpha is light. Two pictures are
    composited right in linear light: decode, mix by alpha, encode. Programs that mix encoded values
    make edges too dark; `background` mixes in linear light.

    Parameters
    ----------
    radiance : array_like
        (H, W, 3) linear radiance, premultiplied by the coverage `alpha`.
    alpha : array_like or None
        (H, W) coverage, clamped to 0..1; None for an opaque picture.
    exposure : float
        Stops, see `tone_map`.
    background : array_like, optional
        Display colour (r, g, b) in 0..1 behind the picture, or (H, W, 3) of them, mixed in linear
        display light. Without it the picture keeps its coverage: straight alpha, colour 0 where
        nothing is covered.
    gamma : float, optional
        See `encode`.
    curve : {"film", "none"}
        `tone_map`, or only the exposure, cut off at 1.

    Returns
    -------
    numpy.ndarray
        uint8 (H, W, 4) with straight alpha, rounded to nearest; alpha 255 on a background.

    Raises
    ------
    ValueError
        Where shapes do not fit, or radiance, alpha, exposure or background are not finite or,
        for the background, outside 0..1.
    """
    return _rounded(_shown(radiance, alpha, exposure, background, gamma, curve), np.uint8)


def to_rgba16(
    radiance: ArrayLike,
    alpha: ArrayLike | None,
    *,
    exposure: float = 0.0,
    background: ArrayLike | None = None,
    gamma: float | None = None,
    curve: str = "film",
) -> NDArray[np.uint16]:
    """Make the 16-bit picture of a film: as `to_rgba8`, white and opaque are 65535."""
    return _rounded(_shown(radiance, alpha, exposure, background, gamma, curve), np.uint16)


def _shown(
    radiance: ArrayLike,
    alpha: ArrayLike | None,
    exposure: float,
    background: ArrayLike | None,
    gamma: float | None,
    curve: str,
) -> Floats:
    light = _finite("radiance", radiance)
    if light.ndim != 3 or light.shape[2] != 3:
        raise ValueError(f"radiance must be (rows, columns, 3), got shape {light.shape}")
    coverage = _coverage(alpha, light)
    colour = CURVES[curve](_straight(light, coverage), exposure)
    if background is not None:
        behind = decode(_background(background, light.shape), gamma).astype(light.dtype)
        colour = colour * coverage + (1 - coverage) * behind
        coverage = np.ones_like(coverage)
    return np.concatenate([encode(colour, gamma), coverage], axis=2)


def _coverage(alpha: ArrayLike | None, light: Floats) -> Floats:
    if alpha is None:
        return np.ones((*light.shape[:2], 1), light.dtype)
    coverage = _finite("alpha", alpha)
    if coverage.shape != light.shape[:2]:
        raise ValueError(
            f"alpha must have the rows and columns of radiance, {light.shape[:2]}, "
            f"got shape {coverage.shape}"
        )
    return np.clip(coverage, 0, 1).astype(light.dtype)[..., None]


def _straight(light: Floats, coverage: Floats) -> Floats:
    # a coverage near the smallest float may send the quotient past the largest: the curve is at 1
    most = np.finfo(light.dtype).max
    with np.errstate(over="ignore"):
        quotient = light / np.where(coverage > 0, coverage, 1)
    return np.where(coverage > 0, np.clip(quotient, 0, most), 0)


def _background(background: ArrayLike, shape: tuple[int, ...]) -> Floats:
    behind = _finite("background", background)
    if behind.shape not in ((3,), shape) or behind.min() < 0 or behind.max() > 1:
        raise ValueError(
            f"background must be (r, g, b) in 0..1, or of shape {shape}, got {background!r}"
        )
    return behind


def _rounded(values: Floats, kind: type) -> NDArray[Any]:
    white = np.iinfo(kind).max
    # float32 cannot add a half to 65535 without rounding
    return np.floor(values * np.float64(white) + 0.5).astype(kind)


def _floats(values: ArrayLike) -> Floats:
    array = np.asarray(values)
    return array if array.dtype == np.float32 else array.astype(np.float64)


def _finite(name: str, values: ArrayLike) -> Floats:
    array = _floats(values)
    bad = array.size - np.count_nonzero(np.isfinite(array))
    if bad:
        raise ValueError(f"{name} has {bad} values that are not finite")
    return array
