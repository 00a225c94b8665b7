"""Sobol points of a batch: nets, each point uniform, sets and batches independent.

Chance fails a right sampler in less than 1e-3 of all choices of seeds (Bonferroni over the p-values
of this file). The seeds are fixed.
"""

import itertools

import numpy as np
import pytest
from scipy import stats

from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.rng import (
    exponential,
    start,
    start_path,
    stratified,
    stratified_exponential,
    stratified_pair,
    uniform,
)
from vtkmcvr.packed import BATCH, Sobol

SETS = 3
SOBOL = Sobol(np.uint64(0), np.uint64(0), np.int64(SETS))
LEVEL = 1e-3 / 60
# Columns: two pairs, one single, one past the sets of points
PAIRS = ((0, 1), (2, 3))


@entry_point
def draw(sobol, seed, pixel, first, n):
    out = np.empty((n, 6))
    for i in range(n):
        rng = start_path(sobol, seed, pixel, first + i)
        rng, out[i, 0], out[i, 1] = stratified_pair(rng)
        rng, out[i, 2], out[i, 3] = stratified_pair(rng)
        rng, out[i, 4] = stratified(rng)
        rng, out[i, 5] = stratified(rng)
    return out


@entry_point
def draw_exponentials(sobol, seed, n):
    out = np.empty((n, 2))
    for i in range(n):
        rng = start_path(sobol, seed, 0, i)
        rng, out[i, 0] = stratified_exponential(rng)
        rng, out[i, 1] = exponential(rng)
    return out


@entry_point
def draw_plain(seed, pixel, first, n):
    out = np.empty((n, 6))
    for i in range(n):
        rng = start(seed, pixel, first + i)
        for c in range(6):
            rng, out[i, c] = uniform(rng)
    return out


@pytest.fixture(scope="module")
def points():
    """Points of many batches, (batches, BATCH, 6)."""
    return draw(SOBOL, np.int64(5), 7, 0, 20_000 * BATCH).reshape(-1, BATCH, 6)


def test_every_batch_is_a_net(points):
    # Every elementary interval of area 1/16 holds one point of each pair
    for x, y in PAIRS:
        for columns in (1, 2, 4, 8, 16):
            rows = BATCH // columns
            cell = np.floor(points[..., x] * columns) * rows + np.floor(points[..., y] * rows)
            np.testing.assert_array_equal(np.sort(cell, axis=1), np.tile(range(16), (20_000, 1)))
    single = np.floor(points[..., 4] * BATCH)
    np.testing.assert_array_equal(np.sort(single, axis=1), np.tile(range(16), (20_000, 1)))


def test_past_the_sets_points_are_independent(points):
    # Like 16 balls in 16 boxes, of which a share of (1 - 1/16)^16 = 0.356 stays empty
    boxes = np.floor(points[..., 5] * BATCH).astype(int)
    empty = BATCH - np.array([len(set(row)) for row in boxes[:5000]])
    assert abs(empty.mean() / BATCH - (1 - 1 / BATCH) ** BATCH) < 4.5 * 0.08 / np.sqrt(5000)


@pytest.mark.parametrize("index", range(BATCH))
def test_each_point_of_a_batch_is_uniform(points, index):
    # 20,000 batches over 8 x 8 cells of each pair: this point alone falls anywhere alike
    for x, y in PAIRS:
        cells = np.histogram2d(points[:, index, x], points[:, index, y], 8, [[0, 1], [0, 1]])[0]
        assert stats.chisquare(cells.ravel()).pvalue > LEVEL


def test_digits_below_the_net_are_uniform(points):
    # Position inside its sixteenth, of all points: by Kolmogorov and Smirnov
    for c in range(5):
        below = (points[:2000, :, c] * BATCH % 1).ravel()
        assert stats.kstest(below, "uniform").pvalue > LEVEL


@pytest.mark.parametrize(("x", "y"), [(0, 2), (1, 2), (0, 4), (3, 4), (1, 3)])
def test_sets_of_points_are_independent_of_each_other(points, x, y):
    # One number a batch would suffice for independence: a point in one set, another in the other
    for i, j in itertools.product((0, 5), (0, 9)):
        cells = np.histogram2d(points[:, i, x], points[:, j, y], 8, [[0, 1], [0, 1]])[0]
        assert stats.chisquare(cells.ravel()).pvalue > LEVEL


def test_batches_and_pixels_and_seeds_are_independent(points):
    column = points[:, 3, 0]
    other_pixel = draw(SOBOL, np.int64(5), 8, 0, 20_000 * BATCH)[3::BATCH, 0]
    other_seed = draw(SOBOL, np.int64(6), 7, 0, 20_000 * BATCH)[3::BATCH, 0]
    for a, b in ((column[:-1], column[1:]), (column, other_pixel), (column, other_seed)):
        cells = np.histogram2d(a, b, 8, [[0, 1], [0, 1]])[0]
        assert stats.chisquare(cells.ravel()).pvalue > LEVEL


def test_a_sample_does_not_depend_on_where_drawing_began(points):
    np.testing.assert_array_equal(draw(SOBOL, np.int64(5), 7, 37, 20), points.reshape(-1, 6)[37:57])


def test_without_a_sampler_all_numbers_are_the_counter_based_ones():
    np.testing.assert_array_equal(
        draw(None, np.int64(5), 7, 3, 40), draw_plain(np.int64(5), 7, 3, 40)
    )


def test_exponentials_are_spread_and_exponential():
    x = draw_exponentials(SOBOL, np.int64(5), 2000 * BATCH)
    assert (x > 0).all()
    for c in range(2):
        assert stats.kstest(x[:16_000, c], "expon").pvalue > LEVEL
    spread = np.sort(np.floor(np.exp(-x[:, 0]) * BATCH).reshape(-1, BATCH), axis=1)
    # float32 rounding may move a point over a border
    assert (spread == np.arange(BATCH)).mean() > 0.999


def test_means_of_smooth_functions_vary_less(points):
    # The variance of the mean of 16 independent points over that of a batch. Known: u v of a net in
    # two dimensions gains more than 16; a sum over four dimensions gains in each
    def gain(values):
        return values.var(axis=1, ddof=1).mean() / BATCH / values.mean(axis=1).var()

    assert gain(points[..., 0] * points[..., 1]) > 16
    assert gain(points[..., :4].sum(axis=-1)) > 16
    assert gain((points[..., 0] + 0.7 * points[..., 1] > 0.6).astype(float)) > 3
    # The worst of all functions of a pair loses a factor of 2 (Pan and Owen, 2023), of one number
    # nothing
    worst = (points[..., 0] * 32).astype(int) + (points[..., 1] * 2).astype(int)
    assert gain((worst % 2).astype(float)) > 0.45
    assert gain(((points[..., 4] * 32).astype(int) % 2).astype(float)) > 0.9
