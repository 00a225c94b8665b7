"""The error that a picture claims, against the error that it has."""

import dataclasses
import math

import numpy as np
import pytest
from scenes import blob, everything, medium, render, scene, slab, volume
from test_film import filled

from vtkmcvr import packed
from vtkmcvr.accuracy import image_error, samples_for
from vtkmcvr.film.moments import new_film
from vtkmcvr.lights import ConstantEnvironment, EnvironmentMap
from vtkmcvr.scene import Camera

LIT = (ConstantEnvironment(1.0),)


def synthetic(rng, truth, sigma, n):
    """Film of n samples: truth plus noise of standard deviation sigma, each (H, W, 3)."""
    height, width, _ = truth.shape
    film = new_film(width, height)
    film.count[:] = n
    film.mean[:] = truth + sigma / math.sqrt(n) * rng.normal(size=truth.shape)
    film.m2[:] = sigma**2 * rng.chisquare(n - 1, size=truth.shape)
    return film


def test_interval_of_the_error_covers_it():
    # 300 films whose error is known: 95 % or more are covered (the interval is conservative). With
    # a coverage of 95 % fewer than 270 hits have a probability below 1e-3 (binomial)
    rng = np.random.default_rng(1)
    truth = 1 + rng.random((12, 10, 3))
    sigma = 0.2 + rng.exponential(size=truth.shape)
    hits = 0
    expected = math.sqrt((sigma**2).mean() / 16 / (truth**2).mean())
    for _ in range(300):
        error = image_error(synthetic(rng, truth, sigma, 16))
        hits += error.low <= expected <= error.high
        assert error.low <= error.nrms <= error.high
    assert hits >= 270


def test_estimate_of_the_error_has_no_bias():
    # Mean square of 200 estimates against what was put in: relative deviation of one estimate is
    # below sqrt(2 / 15 / 360) = 2 %, of the mean 0.14 %; five of those
    rng = np.random.default_rng(2)
    truth = 1 + rng.random((12, 10, 3))
    sigma = np.full(truth.shape, 0.7)
    found = [image_error(synthetic(rng, truth, sigma, 16)).nrms ** 2 for _ in range(200)]
    assert np.mean(found) == pytest.approx(0.49 / 16 / (truth**2).mean(), rel=0.01)


def test_one_pixel_with_all_the_noise_leaves_the_error_open():
    rng = np.random.default_rng(3)
    truth = np.ones((40, 40, 3))
    even = image_error(synthetic(rng, truth, np.full(truth.shape, 0.1), 16))
    assert even.high < 1.1 * even.nrms
    film = synthetic(rng, truth, np.full(truth.shape, 1e-4), 16)
    film.m2[3, 4] = 1e3
    firefly = image_error(film)
    assert firefly.high > 1.7 * firefly.nrms
    assert firefly.low == 0


def test_black_and_unknown_films_do_not_pretend():
    black = image_error(filled([0.0] * 8))
    assert (black.nrms, black.high, black.bright) == (0.0, math.inf, False)
    once = image_error(filled([1.0]))
    assert (once.nrms, once.high, once.bright) == (math.inf, math.inf, True)
    assert image_error(filled([0.5] * 8)).high == 0


def test_noise_larger_than_the_picture_is_no_error_of_a_few_percent():
    # Mean of the squares smaller than their noise: the truth may be black
    rng = np.random.default_rng(4)
    film = synthetic(rng, np.full((8, 8, 3), 1e-3), np.ones((8, 8, 3)), 4)
    assert image_error(film).high == math.inf


def test_samples_for_an_error_grow_with_its_inverse_square():
    assert samples_for(0.1, 16, 0.05) == pytest.approx(64)


# Stop rules


@pytest.mark.parametrize("target", [0.03, 0.1])
def test_render_stops_at_the_error_asked_for_and_has_it(target):
    lit = scene(lights=LIT, size=(48, 40))
    truth = render(lit, samples=8000, seed=99)
    picture = render(lit, samples=None, nrms=target)
    assert picture.stopped_by == "nrms"
    assert picture.samples * 48 * 40 >= 2**20 or picture.nrms <= target
    wrong = np.sqrt(np.mean((picture.radiance - truth.radiance) ** 2) / np.mean(truth.radiance**2))
    # The error of 5760 independent values is known to 2 %; five of those
    assert wrong <= 1.1 * target


def test_whichever_rule_is_met_first_ends_the_render():
    lit = scene(lights=LIT)
    assert render(lit, samples=20, nrms=1e-6).stopped_by == "samples"
    assert render(lit, samples=None, seconds=0.2, nrms=1e-6).stopped_by == "seconds"
    assert render(lit, samples=None, nrms=0.5).stopped_by == "nrms"


def test_refining_to_an_error_continues_the_same_picture():
    lit = scene(lights=LIT)
    first = render(lit, samples=None, nrms=0.05)
    finer = first.refine(nrms=0.02)
    assert finer.stopped_by == "nrms" and finer.samples > first.samples
    again = render(lit, samples=finer.samples)
    np.testing.assert_array_equal(again.radiance, finer.radiance)


def test_a_picture_without_light_ends_and_says_so():
    away = Camera((0, -5, 0), (0, -9, 0))
    picture = render(scene(camera=away, lights=LIT), samples=None, nrms=0.01)
    assert picture.stopped_by == "dark"
    assert not picture.radiance.any()


def test_an_almost_empty_picture_is_judged_by_its_few_pixels():
    # A ball of 2 % of the film's area
    small = scene(blob(9), camera=Camera((0, -40, 0), (0, 0, 0), view_angle=20), lights=LIT)
    truth = render(small, samples=6000, seed=99)
    picture = render(small, samples=None, nrms=0.04)
    wrong = np.sqrt(np.mean((picture.radiance - truth.radiance) ** 2) / np.mean(truth.radiance**2))
    lit = (truth.radiance > 0).any(-1).mean()
    assert lit < 0.05
    # Error of some 40 pixels: known to about 12 %; three of those
    assert wrong <= 1.4 * 0.04


def test_light_through_a_pinhole_does_not_fool_the_stop_rule():
    # Nearly all light comes from one texel that one scattered ray in 9000 finds. Without the rays
    # that found it the picture looks converged: 1 % error of the rest
    pixels = np.full((64, 128, 3), 1e-3)
    pixels[32, 64] = 200.0
    sky = EnvironmentMap(pixels)
    rare = scene(slab(points=3), medium(2.0), lights=(sky,), light_sampling="scatter")
    easy = render(dataclasses.replace(rare, light_sampling="mis"), samples=4000, seed=99)
    picture = render(rare, samples=3000, nrms=0.05)
    assert picture.stopped_by == "samples"
    wrong = np.sqrt(np.mean((picture.radiance - easy.radiance) ** 2) / np.mean(easy.radiance**2))
    # 1024 pixels see 0.1 to 0.3 hits each: the square error is that of 100 hits or more, 20 %
    assert picture.nrms == pytest.approx(wrong, rel=0.35)
    assert wrong > 0.5


def test_light_through_a_small_gap_does_not_fool_the_stop_rule():
    # A room of opaque walls with fog inside, seen from within; the sky shines through a hole that
    # one shadow ray in 1000 finds. Most pixels see no light for the first hundred samples
    z, y, x = np.mgrid[-1:1:17j, -1:1:17j, -1:1:17j]
    inside = np.maximum(np.maximum(abs(x), abs(y)), abs(z)) < 0.8
    hole = (z > 0) & (np.maximum(abs(x), abs(y)) < 0.2)
    room = volume(np.where(inside | hole, 0.004, 1.0).astype(np.float32), (0.125,) * 3)
    eye = Camera((0, -0.7, 0), (0, 0.5, 0), view_angle=60)
    dim = scene(room, medium(100.0), eye, lights=LIT, size=(12, 9))
    early = render(dim, samples=64)
    assert 0 < (early.radiance > 0).any(-1).mean() < 0.5
    pictures = [render(dim, samples=2**17, seed=s, nrms=0.4) for s in range(5)]
    assert all(p.stopped_by == "nrms" for p in pictures)
    # Error from the spread of 5 pictures, 430 values of heavy tails: known to 7 %; three of those
    means = np.array([p.film.mean for p in pictures])
    wrong = math.sqrt(means.var(axis=0, ddof=1).mean() / (means.mean(axis=0) ** 2).mean())
    assert wrong <= 1.2 * 0.4


def test_bad_targets_are_refused():
    for bad in (0, -0.1, math.nan, "1%"):
        with pytest.raises((ValueError, TypeError), match="nrms"):
            render(scene(lights=LIT), nrms=bad)


# Intervals of pixels


@pytest.mark.parametrize("sampler", ["independent", "sobol"])
@pytest.mark.parametrize("samples", [8, 32, 128])
def test_intervals_of_pixels_cover_the_truth(sampler, samples):
    # 24 seeds x 1000 lit values: the coverage is known to some 0.5 %, seeds being independent
    lit = dataclasses.replace(everything(*LIT, size=(20, 16)), sampler=sampler)
    truth = render(lit, samples=12_000, seed=10**6)
    shown = truth.film.mean > 1e-3
    hits = []
    for seed in range(24):
        picture = render(lit, samples=samples, seed=seed)
        off = np.abs(picture.film.mean - truth.film.mean)
        hits.append((off <= 1.96 * picture.standard_error)[shown].mean())
    assert 0.93 <= np.mean(hits) <= 0.975


def test_pooled_errors_are_those_of_the_film_where_all_pixels_are_alike():
    rng = np.random.default_rng(5)
    film = synthetic(rng, np.ones((30, 30, 3)), np.full((30, 30, 3), 2.0), 9)
    from vtkmcvr.film.moments import standard_error

    # A fifth from 8 degrees of freedom, the rest from those of 54 pixels: 5.8 % each
    np.testing.assert_allclose(standard_error(film), 2 / 3, rtol=0.5)
    assert np.std(standard_error(film)) < 0.05
    half = synthetic(rng, np.ones((4, 4, 3)), np.ones((4, 4, 3)), 9)
    half.count[:2] = 0
    assert np.isinf(standard_error(half)[:2]).all()
    assert isinstance(half, packed.Film)
