"""Adaptive sampling: more samples where a pilot saw more noise, and no pixel starved.

The pilot is a film of few samples with a seed of its own; it decides the share of each block of
pixels and is thrown away. Given the pilot, the number of samples of a pixel is a number that does
not depend on any of them, so their mean is as unbiased as with equal numbers. (Shares that follow
the very samples they average are not: a pixel that looks dark by chance would be left too dark.)

The mean square error of a picture is the mean over pixels of variance / samples. For a given
number of samples in all it is least where samples go as the standard deviation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import packed

# Samples of a pixel for four samples of the mean pixel, (H, W); 0: the pixel is left out
Density = NDArray[np.int64]
QUARTERS = 4
# A quarter of the mean is the least that a pixel gets, eight times the mean the most
LEAST, MOST = 1, 8 * QUARTERS

BLOCK = 8
PILOT_SAMPLES = 4
# Changes the seed of a picture into that of its pilot
PILOT_SEED = 0x61646170746976
# Share of a time limit that the pilot may take
PILOT_SHARE = 0.25


def pilot_seed(seed: int) -> int:
    """Seed of the pilot of a picture, which shares no random number with it."""
    return seed ^ PILOT_SEED


def goals(level: int, shape: tuple[int, ...], density: Density | None) -> NDArray[np.int64]:
    """Samples of each pixel, (H, W), where the mean pixel has `level`."""
    if density is None:
        return np.full(shape, level, np.int64)
    return -(-density * level // QUARTERS)


def level_of(count: NDArray[np.int64], density: Density | None) -> int:
    """Largest level of which all pixels have their samples."""
    if density is None:
        return int(count.min())
    taken = density > 0
    return int((QUARTERS * count[taken] // density[taken]).min())


def level_with(samples: int, density: Density | None) -> int:
    """Least level at which every pixel has so many samples."""
    return samples if density is None else -(-samples * QUARTERS // int(density[density > 0].min()))


def density_of(pilot: packed.Film) -> Density:
    """Where samples should go, by the noise of a pilot film.

    In blocks of 8 x 8 pixels, whose variances are averaged with those of the blocks around, so that
    one bright path by chance does not decide. Multiples of a quarter of the mean, which leave whole
    batches of Sobol points.
    """
    height, width = pilot.count.shape
    noise = np.sqrt(_smooth(_block_variance(pilot)))
    rows, columns = np.arange(height) // BLOCK, np.arange(width) // BLOCK
    size = np.outer(np.bincount(rows), np.bincount(columns))
    return np.ascontiguousarray(_normalised(noise, size)[np.ix_(rows, columns)])


def _block_variance(pilot: packed.Film) -> NDArray[np.float64]:
    """Mean variance of one sample, summed over channels, of each block of pixels."""
    freedom = np.maximum(pilot.count - 1, 1)
    variance = pilot.m2.sum(-1) / freedom
    return _block_sums(variance) / _block_sums(np.ones_like(variance))


def _block_sums(plane: NDArray[np.float64]) -> NDArray[np.float64]:
    height, width = plane.shape
    rows = np.add.reduceat(plane, np.arange(0, height, BLOCK), axis=0)
    return np.add.reduceat(rows, np.arange(0, width, BLOCK), axis=1)


def _smooth(plane: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights 1 2 1 along both axes; beyond the edge as at the edge."""
    for axis in (0, 1):
        padding = [(1, 1) if a == axis else (0, 0) for a in (0, 1)]
        padded = np.moveaxis(np.pad(plane, padding, mode="edge"), axis, 0)
        plane = np.moveaxis((padded[:-2] + 2 * padded[1:-1] + padded[2:]) / 4, 0, axis)
    return plane


def _normalised(noise: NDArray[np.float64], size: NDArray[np.int64]) -> Density:
    """Density in proportion to the noise, within its bounds, of a mean as near to 1 as can be."""
    if not noise.any():
        return np.full(noise.shape, QUARTERS, np.int64)

    def scaled(factor: float) -> Density:
        return np.clip(np.rint(factor * noise), LEAST, MOST).astype(np.int64)

    # The mean rises with the factor: bisection in its logarithm, down to the resolution of floats
    low = np.log(LEAST) - np.log(noise.max()) - 1
    high = np.log(MOST) - np.log(noise[noise > 0].min()) + 1
    for _ in range(60):
        middle = (low + high) / 2
        if (scaled(np.exp(middle)) * size).sum() <= QUARTERS * size.sum():
            low = middle
        else:
            high = middle
    return scaled(float(np.exp(low)))
