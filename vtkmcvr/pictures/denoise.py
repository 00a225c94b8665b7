"""Noise reduction: radiance in, smoother radiance out. Every method is biased.

"knn" is Exposure Render's (K nearest neighbours, Kroes, Post, Botha 2012), whose strength follows
the variance of the mean and fades out as samples come in. "oidn" is Intel Open Image Denoise, a
trained network, which does not.
"""

from __future__ import annotations

from importlib.util import find_spec
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from .. import backends
from ..film.filter import window_mean
from .display import SRGB_LINEAR_END, SRGB_SLOPE, srgb_encode, tone_map

Image = NDArray[np.float32]
Denoised = tuple[Image, Image]

METHODS = ("knn", "oidn")

# Noise on the display, as a standard deviation in 0..1, at which half the strength is left
HALF_STRENGTH = 2 / 255
# Squared display differences, in variances of the mean, at which a neighbour's weight is 1/e
TOLERANCE = 8.0
LEAST_VARIANCE = 1e-8
WINDOW = 7
# Weights along rows and columns of the pixels that tell what a pixel looks like
LOOK = (1.0, 2.0, 1.0)


def knn(
    radiance: Image,
    alpha: Image,
    standard_error: NDArray[np.floating],
    exposure: float = 0.0,
    backend: str = "cpu",
) -> Denoised:
    """Reduce noise by a 7x7 window of alike pixels.

    How alike two pixels are is told by what the display shows of them, as in the paper, over 3x3
    pixels as far as there is noise: the paper's single pixel leaves lone dark ones that are like
    nothing around. Averaged is the light itself, premultiplied, with its coverage. The paper
    averages display values, which darkens: tone curve and gamma are concave.

    All follows v, the variance of the mean on the display, averaged over the window (the variance
    of a sample, which the paper names, would not fall). A pixel moves toward its window's mean by
    the share v / (v + v0), v0 = `HALF_STRENGTH` squared: it falls as 1/samples, and so does the
    bias, faster than the noise. Differences count in units of v, where the paper's constant made
    pictures worse than no filter from some 60 samples on.

    Parameters
    ----------
    radiance : array (H, W, 3)
        Linear, premultiplied by alpha.
    alpha : array (H, W)
    standard_error : array (H, W, 3)
        Of the radiance; inf where unknown: full strength.
    exposure : float
        Stops, of the display that tells what is alike.
    backend : {"cpu", "cuda", "auto"}
        Where the window is gone over; both differ by roundings.

    Returns
    -------
    radiance, alpha : arrays of float32
    """
    variance = display_variance(radiance, standard_error, exposure)
    share = strength(variance)
    seen = np.dstack([srgb_encode(tone_map(radiance, exposure)), alpha])
    look = seen + share[..., None] * (window_mean(seen, LOOK) - seen)
    values = np.dstack([radiance, alpha]).astype(np.float32)
    tolerance = (TOLERANCE * np.maximum(variance, LEAST_VARIANCE)).astype(np.float32)
    planes = look.astype(np.float32), values, share, tolerance
    out = backends.attempt(backend, lambda: _knn_on_cuda(*planes), lambda _: _knn_on_cpu(*planes))
    return out[..., :3], out[..., 3]


def _knn_on_cuda(look: Image, values: Image, share: Image, tolerance: Image) -> Image:
    from ..gpu.smoothing import SmoothingDevice

    return SmoothingDevice().knn(look, values, share, tolerance)


def _knn_on_cpu(look: Image, values: Image, share: Image, tolerance: Image) -> Image:
    from ..kernels.knn import knn_filter

    out = np.empty_like(values)
    knn_filter(look, values, share, tolerance, out)
    return out


def strength(variance: NDArray[np.float64]) -> Image:
    """Share of the KNN filter by the variance of the mean on the display, 0 to 1."""
    return (variance / (variance + HALF_STRENGTH**2)).astype(np.float32)


def display_variance(
    radiance: NDArray[np.floating], standard_error: NDArray[np.floating], exposure: float = 0.0
) -> NDArray[np.float64]:
    """Variance of the mean on the display, (H, W): mean of the colours and over the window.

    To first order in the standard error; at most 1, which stands for unknown too.
    """
    light = np.asarray(radiance, np.float64)
    known = np.isfinite(standard_error)
    slope = _display_slope(light, exposure)
    noise = np.where(known, slope * np.where(known, standard_error, 0), 1.0)
    local = window_mean(np.mean(np.minimum(noise, 1.0) ** 2, axis=2), [1.0] * WINDOW)
    return local.astype(np.float64)


def _display_slope(light: NDArray[np.float64], exposure: float) -> NDArray[np.float64]:
    """Derivative of the display value by radiance: slope of sRGB times slope of the tone curve."""
    shown = tone_map(light, exposure)
    power = 1.055 / 2.4 * np.maximum(shown, SRGB_LINEAR_END) ** (1 / 2.4 - 1)
    steep = np.where(shown <= SRGB_LINEAR_END, SRGB_SLOPE, power)
    return steep * (1 - shown) * 2.0**exposure


def oidn(
    radiance: Image, alpha: Image, albedo: Image | None = None, normal: Image | None = None
) -> Denoised:
    """Reduce noise by Intel Open Image Denoise on the CPU.

    Parameters
    ----------
    radiance : array (H, W, 3)
        Linear, premultiplied by alpha.
    alpha : array (H, W)
        Gets a pass of its own, so that both stay premultiplied alike.
    albedo, normal : arrays (H, W, 3), optional
        Guides: means over the samples of the first collision. Open Image Denoise takes no depth,
        and normals only beside albedo.

    Returns
    -------
    radiance, alpha : arrays of float32

    Raises
    ------
    ImportError
        Where the package pyoidn is missing.
    """
    denoise = import_oidn().denoise
    guides = {"albedo": albedo} if albedo is not None else {}
    if guides and normal is not None:
        guides["normal"] = normal
    light = denoise(np.asarray(radiance, np.float32), **guides, hdr=True)
    coverage = denoise(np.repeat(np.asarray(alpha, np.float32)[..., None], 3, axis=2), **guides)
    return light, np.clip(coverage[..., 0], 0, 1)


def available() -> tuple[str, ...]:
    """Methods that can be used here."""
    return METHODS if find_spec("pyoidn") else ("knn",)


def import_oidn() -> ModuleType:
    """Return the pyoidn package, or say what to install."""
    try:
        import pyoidn
    except (ImportError, OSError) as error:
        raise ImportError(
            'Open Image Denoise needs the pyoidn package: pip install "vtkmcvr[denoise]"'
        ) from error
    return pyoidn
