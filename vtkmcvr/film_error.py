"""Variance of the mean of a pixel, from independent samples or from independent batches of samples.

Sobol points of a batch depend on each other, so that the variance between samples says too much
about the error of their mean. That between the means of batches, which are independent, says it
without bias, but from few batches it is a noisy estimate for one pixel.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import packed

Plane = NDArray[np.float64]

# Neighbourhood over which the gain of even samples is averaged: from 4 batches of 25 pixels it is
# known to some 15 %, and 95 % intervals cover the truth as often as those of independent samples
RADIUS = 2


def variance(film: packed.Film) -> Plane:
    """Variance of the mean radiance, (H, W, 3), unbiased; inf below two samples.

    Below two batches it is that of as many independent samples: an upper estimate.
    """
    if film.batches is None:
        return _between_samples(film)
    known = _batches(film)[..., None] > 1
    return np.where(known, _between_batches(film), _between_samples(film))


def smooth_variance(film: packed.Film) -> Plane:
    """`variance`, with less noise where it comes from batches.

    That of independent samples, times the ratio of both in the neighbourhood of the pixel.
    """
    samples = _between_samples(film)
    if film.batches is None:
        return samples
    # The unknown, on either side of the ratio, would make all around it unknown
    within = _box_sum(np.where(np.isfinite(samples), samples, 0.0).sum(axis=-1))
    exact = variance(film)
    between = _box_sum(np.where(np.isfinite(exact), exact, 0.0).sum(axis=-1))
    ratio = np.divide(between, within, out=np.ones_like(within), where=within > 0)
    known = np.isfinite(samples)
    return np.where(known, np.where(known, samples, 0.0) * ratio[..., None], np.inf)


def _between_samples(film: packed.Film) -> Plane:
    n = film.count[..., None]
    return np.where(n > 1, film.m2 / np.maximum(n - 1, 1) / np.maximum(n, 1), np.inf)


def _between_batches(film: packed.Film) -> Plane:
    """Variance of a batch mean, over the number of batches; the last one may be incomplete."""
    assert film.batches is not None
    whole = _batches(film)[..., None]
    batches = film.count[..., None] / packed.BATCH
    return film.batches.m2 / np.maximum(whole - 1, 1) / np.maximum(batches, 1)


def _batches(film: packed.Film) -> NDArray[np.int64]:
    """Number of complete batches, (H, W)."""
    return film.count // packed.BATCH


def _box_sum(plane: Plane) -> Plane:
    """Sum over a square of 2 RADIUS + 1 pixels; beyond the edge as at the edge."""
    size = 2 * RADIUS + 1
    padded = np.pad(plane, RADIUS, mode="edge")
    rows = np.lib.stride_tricks.sliding_window_view(padded, size, axis=0).sum(axis=-1)
    return np.lib.stride_tricks.sliding_window_view(rows, size, axis=1).sum(axis=-1)
