"""Variance of the mean of a pixel, from independent samples or from independent batches of samples.

Sobol points of a batch depend on each other, so that the variance between samples says too much
about the error of their mean. That between the means of batches, which are independent, says it
without bias, but from few batches it is a noisy estimate for one pixel.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import packed

Plane = NDArray[np.float64]

# Neighbourhood over which variances are pooled: weights that fall linearly over 9 x 9 pixels, as a
# mean over 5 x 5 taken twice has
RADIUS = 2
# Samples that the neighbourhood counts for beside a pixel's own. On a CT head, an engine and a CT
# thorax, intervals of 8 samples cover the truth in 53 to 72 % of the pixels by their own variance
# alone, in 94 to 95 % by that of the neighbourhood alone, in 95 to 96 % by both; and in as many at
# 128 samples, where the neighbourhood alone falls to 94 %
PRIOR = 32.0


def variance(film: packed.Film) -> Plane:
    """Variance of the mean radiance, (H, W, 3), unbiased; inf below two samples.

    Below two batches it is that of as many independent samples: an upper estimate.
    """
    if film.batches is None:
        return _between_samples(film)
    known = _batches(film)[..., None] > 1
    return np.where(known, _between_batches(film), _between_samples(film))


def smooth_variance(film: packed.Film) -> Plane:
    """`variance`, drawn toward that of the neighbourhood of each pixel, (H, W, 3).

    The variance that few samples show is a poor one: a pixel that is lit by one path in twenty
    shows none at all in eight samples more often than not, and its interval of no width misses the
    truth. Neighbours are alike; with their mean as `PRIOR` samples (empirical Bayes) 95 % intervals
    cover the truth in 95 % of the pixels, on average, from eight samples on. Variances are those of
    one sample: pixels count alike, however many samples they have, so that a quiet one beside a
    noisy one that was sampled more does not take over its variance.
    """
    n = film.count[..., None].astype(np.float64)
    own, around = _own_and_around(film.m2, film.count - 1)
    single = ((n - 1) * own + PRIOR * around) / np.maximum(n - 1 + PRIOR, 1)
    between_samples = np.where(n > 1, single / np.maximum(n, 1), np.inf)
    if film.batches is None:
        return between_samples
    # How many times less a batch varies than as many independent samples: few batches know it only
    # together with their neighbours
    _, batches = _own_and_around(film.batches.m2, _batches(film) - 1)
    gain = np.divide(batches * packed.BATCH, around, out=np.ones_like(around), where=around > 0)
    # Below two batches as if samples were independent: an upper estimate
    known = (_batches(film) > 1)[..., None]
    return np.where(known, between_samples * np.where(known, gain, 1.0), between_samples)


def _own_and_around(squares: Plane, freedom: NDArray[np.int64]) -> tuple[Plane, Plane]:
    """Variance of one value: by a pixel's own values, and by those near it that have any."""
    known = freedom > 0
    own = np.where(known[..., None], squares / np.maximum(freedom, 1)[..., None], 0.0)
    weights = _smooth(known.astype(np.float64))[..., None]
    sums = np.stack([_smooth(own[..., c]) for c in range(3)], axis=-1)
    return own, np.divide(sums, weights, out=np.zeros_like(sums), where=weights > 0)


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


def _smooth(plane: Plane) -> Plane:
    """Weighted mean over a neighbourhood; beyond the edge as at the edge."""
    return _box_mean(_box_mean(plane))


def _box_mean(plane: Plane) -> Plane:
    """Mean over a square of 2 RADIUS + 1 pixels."""
    size = 2 * RADIUS + 1
    padded = np.pad(plane, RADIUS, mode="edge")
    rows = np.lib.stride_tricks.sliding_window_view(padded, size, axis=0).mean(axis=-1)
    return np.lib.stride_tricks.sliding_window_view(rows, size, axis=1).mean(axis=-1)
