"""How wrong a picture still is, with how much confidence; what a target error needs.

NRMS: RMS over pixels and channels of (estimate - truth) in linear radiance, over the RMS of the
truth. Its estimate needs no truth: the film knows the variance of each pixel's mean. Pixels are
independent, because their samples are drawn from the pixel filter instead of being splatted over
neighbours, so sums over pixels have the variances that textbooks give them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .film.error import variance
from .packed import Film, FilmTotals

# Two-sided 95 % of the normal distribution
Z95 = 1.959964


@dataclass(frozen=True)
class ImageError:
    """Estimated error of a picture.

    Attributes
    ----------
    nrms : float
        Estimate; inf where it is unknown, 0 for a picture that is black so far.
    low, high : float
        Ends of a 95 % confidence interval of the NRMS that such a picture has on average. It is
        conservative: wide where a few pixels carry most of the noise, because the next such pixel
        may not have shown yet.
    power : float
        Mean square of the true radiance, estimated, over pixels and channels.
    bright : bool
        Whether any sample brought light.
    """

    nrms: float
    low: float
    high: float
    power: float
    bright: bool


def image_error(film: Film) -> ImageError:
    """Error of a film, estimated from its own moments."""
    return error_of(totals_of(film), film.mean.size)


def totals_of(film: Film) -> FilmTotals:
    """Sums over the pixels of a film, which say what its error is."""
    v = variance(film)
    unknown = np.count_nonzero(~np.isfinite(v).all(-1))
    counts = (
        float(film.count.sum()), float(film.count.min()), float(np.count_nonzero(film.mean)),
        float(unknown),
    )  # fmt: skip
    if unknown:
        return FilmTotals(*counts, 0.0, 0.0, 0.0, 0.0, 0.0)
    noise, squares = v.sum(-1), film.mean * film.mean
    return FilmTotals(
        *counts,
        noise=float(noise.sum()),
        noise_squares=float((noise * noise).sum()),
        squares=float(squares.sum()),
        crossed=float((squares * v).sum()),
        variance_squares=float((v * v).sum()),
    )


def error_of(totals: FilmTotals, size: int) -> ImageError:
    """Error of a film of `size` means, pixels times channels, by its totals.

    The mean square of the estimate exceeds that of the truth by the noise, which is taken off.
    """
    bright = totals.bright > 0
    if totals.unknown:
        return ImageError(math.inf, 0.0, math.inf, 0.0, bright)
    if not bright:
        return ImageError(0.0, 0.0, math.inf, 0.0, bright)
    noise, noise_spread = _mean_and_spread(totals, size)
    power, power_spread = _power(totals, size)
    return ImageError(
        _ratio(noise, power),
        _ratio(max(noise - Z95 * noise_spread, 0.0), power + Z95 * power_spread),
        _ratio(noise + Z95 * noise_spread, power - Z95 * power_spread),
        power,
        bright,
    )


def _mean_and_spread(totals: FilmTotals, size: int) -> tuple[float, float]:
    """Mean of the variances of pixels, per channel, and a bound of its standard error.

    With independent pixels Var(sum v) = sum Var(v) <= sum E(v^2): one pixel that carries all the
    noise makes the error as large as the estimate (nobody knows how many more there are), n equal
    pixels make it sqrt(n) times smaller.
    """
    return totals.noise / size, math.sqrt(totals.noise_squares) / size


def _power(totals: FilmTotals, size: int) -> tuple[float, float]:
    """Mean square of the truth and its standard error, from means with variances v.

    For a normal mean m of variance v: E(m^2) = truth^2 + v and Var(m^2) = 4 truth^2 v + 2 v^2.
    Channels of a pixel may rise and fall together, hence the factor 3.
    """
    power = (totals.squares - totals.noise) / size
    spread = math.sqrt(3 * (4 * totals.crossed + 2 * totals.variance_squares)) / size
    return power, spread


def _ratio(noise: float, power: float) -> float:
    if power <= 0:
        return math.inf
    return math.sqrt(noise / power)


def samples_for(nrms: float, samples: float, target: float) -> float:
    """Samples per pixel that reach `target`, given the NRMS of some: variance falls as 1 / n."""
    return samples * (nrms / target) ** 2
