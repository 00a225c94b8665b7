import math

import numpy as np
import pytest
from compiled import compiled
from scenes import noise, render, scene

from vtkmcvr import packed
from vtkmcvr.film import error as film_error
from vtkmcvr.film import moments as film
from vtkmcvr.kernels.sample import accumulate
from vtkmcvr.lights import ConstantEnvironment

f32 = np.float32
add_sample = compiled(accumulate)


def filled(samples, hits=None, depths=None):
    """Film of one pixel with the given grey samples."""
    one = film.new_film(1, 1)
    for i, x in enumerate(samples):
        hit = True if hits is None else hits[i]
        depth = 2.0 if depths is None else depths[i]
        add_sample(one, 0, 0, (f32(x), f32(2 * x), f32(0)), hit, depth)
    return one


def test_moments_are_those_of_numpy():
    x = np.random.default_rng(1).exponential(size=500).astype(f32).astype(float)
    one = filled(x)
    assert one.count[0, 0] == 500
    assert one.mean[0, 0] == pytest.approx([x.mean(), 2 * x.mean(), 0], rel=1e-12)
    error = film.standard_error(one)[0, 0]
    assert error[:2] == pytest.approx(np.array((1, 2)) * x.std(ddof=1) / math.sqrt(500), rel=1e-6)
    assert error[2] == 0


def test_many_identical_samples_stay_exact():
    # HC-53: a running mean in float32 would stall
    one = filled([0.1] * 100_000)
    assert one.mean[0, 0, 0] == float(f32(0.1))
    assert film.standard_error(one)[0, 0, 0] == 0


def test_tiny_variance_on_a_large_mean_survives():
    x = 1e4 + np.tile([0.0, 1.0], 500)
    assert film.standard_error(filled(x))[0, 0, 0] == pytest.approx(
        x.std(ddof=1) / math.sqrt(1000), rel=1e-6
    )


def test_samples_that_are_not_finite_count_as_black():
    one = filled([1.0, np.nan, 3.0, np.inf, -np.inf])
    assert one.rejected[0, 0] == 3
    assert one.count[0, 0] == 5
    assert one.mean[0, 0, 0] == pytest.approx(0.8)


def test_alpha_and_depth():
    one = filled([1, 0, 0, 1], [True, False, False, True], [2.0, 0.0, 0.0, 5.0])
    assert film.alpha(one)[0, 0] == 0.5
    assert film.depth(one)[0, 0] == 3.5
    missed = filled([0], [False])
    assert film.alpha(missed)[0, 0] == 0
    assert film.depth(missed)[0, 0] == np.inf


def test_error_is_unknown_below_two_samples():
    assert np.isinf(film.standard_error(filled([1.0]))).all()
    assert film.nrms(filled([1.0])) == np.inf
    empty = film.new_film(2, 2)
    assert np.isinf(film.standard_error(empty)).all()
    assert not film.alpha(empty).any()
    assert film.nrms(empty) == np.inf


def batched(samples):
    """Film of one pixel with the given grey samples in batches."""
    one = film.new_film(1, 1, packed.Sobol(0, 0, 16))
    for x in samples:
        add_sample(one, 0, 0, (f32(x), f32(2 * x), f32(0)), True, 1.0)
    return one


def test_error_of_batches_is_that_of_their_means():
    # Samples of a batch depend on each other: all of them are equal, and 1000 away from nought
    batches = (1000 + np.random.default_rng(3).normal(size=9)).astype(f32).astype(float)
    one = batched(np.repeat(batches, packed.BATCH))
    error = film.standard_error(one)[0, 0]
    assert error[:2] == pytest.approx(np.array((1, 2)) * batches.std(ddof=1) / 3, rel=1e-6)
    assert error[2] == 0
    # An incomplete batch counts by its samples, here as a quarter
    more = batched(np.append(np.repeat(batches, packed.BATCH), np.full(packed.BATCH // 4, 1000.0)))
    expected = batches.std(ddof=1) / math.sqrt(9.25)
    assert film_error.variance(more)[0, 0, 0] == pytest.approx(expected**2, rel=1e-6)


def test_error_in_batches_is_unknown_below_two_samples_and_never_nan():
    for samples in ([], [1.0], [0.0] * 40, [3.0] * 40, [0.0, 1.0] * 20):
        error = film.standard_error(batched(samples))
        assert not np.isnan(error).any()
        assert np.isinf(error).all() == (len(samples) < 2)
    assert film.nrms(batched([1.0])) == np.inf
    assert film.nrms(batched([0.0] * 40)) == 0


def test_nrms_of_black_is_zero_and_of_certainty():
    assert film.nrms(filled([0.0, 0.0])) == 0
    assert film.nrms(filled([3.0, 3.0])) == 0


def test_nrms_is_the_error_over_the_truth():
    # 200 x 200 pixels of exponential samples: mean = standard deviation = 1, so NRMS = 1 / sqrt(n);
    # its own error is about 1 / sqrt(40000 x 3)
    n = 16
    x = np.random.default_rng(2).exponential(size=(n, 200, 200, 3))
    many = film.new_film(200, 200)
    many.count[:] = n
    many.mean[:] = x.mean(axis=0)
    many.m2[:] = x.var(axis=0) * n
    assert film.nrms(many) == pytest.approx(1 / math.sqrt(n), rel=0.02)


@pytest.mark.parametrize("sampler", ["independent", "sobol"])
def test_estimated_nrms_is_the_true_one(sampler):
    # Against a picture with 32 times the samples, whose own error adds 1/64 of the square
    lit = scene(noise(), lights=(ConstantEnvironment(1.0),), sampler=sampler)
    picture, truth = render(lit, 32, seed=1), render(lit, 1024, seed=2)
    true = np.sqrt(np.mean((picture.radiance - truth.radiance) ** 2) / np.mean(truth.radiance**2))
    # RMS over 1024 grey pixels: a relative error of 1 / sqrt(2048) = 2.2 % for Gaussian errors, of
    # the estimate too where it comes from the difference of two batches
    assert picture.nrms == pytest.approx(true, rel=0.1)


def test_one_batch_gives_an_upper_estimate():
    # Two batches: the variance of their mean, known to 3 %. One: as if samples were independent,
    # which on this scene is 1.6 times the variance
    lit = scene(noise(), lights=(ConstantEnvironment(1.0),))
    one, two = (float(film_error.variance(render(lit, n).film).mean()) for n in (16, 32))
    assert 1.3 < one / (2 * two) < 2.0


@pytest.mark.slow
@pytest.mark.parametrize("sampler", ["independent", "sobol"])
def test_standard_error_covers_the_truth(sampler):
    # 95 % intervals over 60 seeds x 1024 pixels. Promise: 93 to 97 %.
    lit = scene(noise(), lights=(ConstantEnvironment(1.0),), sampler=sampler)
    truth = render(lit, 20_000, seed=0).radiance[..., 0]
    covered = []
    for seed in range(1, 61):
        picture = render(lit, 64, seed=seed)
        error = picture.standard_error[..., 0]
        covered.append(np.abs(picture.radiance[..., 0] - truth) <= 1.96 * error)
    assert 0.93 < np.mean(covered) < 0.97
