"""Adaptive sampling: where samples go, that nothing is starved, and that no mean is shifted."""

import dataclasses
import logging
import math

import numpy as np
import pytest
from scenes import blob, everything, medium, noise, render, scene, slab
from scipy.stats import chi2

from vtkmcvr import adaptive, packed, schedule
from vtkmcvr.cli import main
from vtkmcvr.film.merge import merge
from vtkmcvr.film.moments import new_film
from vtkmcvr.front import render as front_render
from vtkmcvr.lights import ConstantEnvironment, EnvironmentMap
from vtkmcvr.recipes.recipe import recipe_of
from vtkmcvr.recipes.replaying import replay
from vtkmcvr.scene import Camera

LIT = (ConstantEnvironment(1.0),)
# A soft ball in a corner of the film: noise in it, none around
CORNER = scene(
    blob(), camera=Camera((1, -9, 1), (1, 0, 1), view_angle=24), lights=LIT, size=(60, 44)
)


@pytest.fixture(scope="module")
def picture():
    return render(CORNER, 64, seed=5, adaptive=True, threads=2)


def assert_same(a, b):
    for name in ("count", "mean", "m2", "hits", "depth", "rejected"):
        np.testing.assert_array_equal(getattr(a.film, name), getattr(b.film, name))


def nrms_against(picture, truth):
    off = picture.film.mean - truth.film.mean
    return math.sqrt((off**2).mean() / (truth.film.mean**2).mean())


# Where samples go


def test_goals_and_levels_are_inverse():
    density = np.random.default_rng(1).integers(1, 33, (7, 5))
    for level in (0, 1, 2, 3, 17, 64, 1000):
        goal = adaptive.goals(level, density.shape, density)
        assert adaptive.level_of(goal, density) == level
        assert (goal >= density * level / 4).all() and (goal < density * level / 4 + 1).all()
        short = goal.copy()
        short[3, 2] -= 1
        if level:
            assert adaptive.level_of(short, density) < level
    assert (adaptive.goals(64, density.shape, density) % packed.BATCH == 0).all()
    assert adaptive.goals(adaptive.level_with(16, density), density.shape, density).min() >= 16


def test_samples_go_where_the_noise_is(picture):
    density = picture.density
    noisy = picture.alpha > 0.2
    assert density[noisy].mean() > 2 * density[~noisy].mean()
    assert picture.samples == 64
    # Blocks share a density
    assert (density[:8, :8] == density[0, 0]).all() and (density[40:, 56:] == density[-1, -1]).all()


def test_no_pixel_starves_and_the_mean_is_kept(picture):
    assert picture.density.min() == adaptive.LEAST
    assert picture.film.count.min() == 64 // 4
    # The nearest multiples of a quarter: the mean of 48 blocks is off by less than one of them
    assert 0.97 * 64 <= picture.film.count.mean() <= 64


def test_density_follows_the_square_root_of_the_variance():
    # Variances of 1 and 9 in two halves, far from their border: densities of 2 and 6 quarters
    pilot = new_film(128, 64)
    pilot.count[:] = 4
    pilot.m2[:, :64], pilot.m2[:, 64:] = 3 * 1.0, 3 * 9.0
    density = adaptive.density_of(pilot)
    assert (density[:, :48] == 2).all() and (density[:, 80:] == 6).all()


def test_pilot_without_noise_spreads_samples_evenly():
    pilot = new_film(20, 10)
    pilot.count[:] = 4
    assert (adaptive.density_of(pilot) == adaptive.QUARTERS).all()
    assert (adaptive.density_of(new_film(1, 1)) == adaptive.QUARTERS).all()


def test_one_bright_path_takes_no_more_than_eight_times_the_mean():
    pilot = new_film(160, 160)
    pilot.count[:] = 4
    pilot.m2[:] = 1e-12
    pilot.m2[77, 80] = 1e30
    density = adaptive.density_of(pilot)
    assert density.max() == adaptive.MOST and density.min() >= adaptive.LEAST


# The same bits


def test_a_pixel_has_the_bits_of_an_even_picture_with_as_many_samples(picture):
    # The pilot leaves no trace but the counts
    for n in np.unique(picture.film.count):
        even = render(CORNER, int(n), seed=5)
        here = picture.film.count == n
        np.testing.assert_array_equal(picture.film.mean[here], even.film.mean[here])


@pytest.mark.parametrize("threads", [1, 3])
def test_bits_do_not_depend_on_threads_or_tiles(picture, monkeypatch, threads):
    monkeypatch.setattr(schedule, "PASS_SECONDS", 2e-3)
    monkeypatch.setattr(schedule, "LARGEST_TILE", 11)
    assert_same(render(CORNER, 64, seed=5, adaptive=True, threads=threads), picture)


def test_continued_picture_is_the_uninterrupted_one(picture, monkeypatch):
    assert_same(render(CORNER, 10, seed=5, adaptive=True).refine(64), picture)
    monkeypatch.setattr(schedule, "POLL_SECONDS", 1e-4)
    calls = []
    first = render(CORNER, 20, seed=5, adaptive=True)
    cut = first.refine(64, abort=lambda: calls.append(1) or len(calls) > 3)
    assert cut.stopped_by == "user" and cut.samples >= 20
    assert_same(cut.refine(64), picture)


def test_saved_picture_is_made_again_and_goes_on(picture, tmp_path):
    again, identical, _ = replay(picture.save(tmp_path / "p.png"), CORNER.volume, threads=2)
    assert identical
    np.testing.assert_array_equal(again.density, picture.density)
    assert again.samples == 64
    assert_same(again.refine(80), picture.refine(80))


def test_recipe_without_samples_for_a_pixel_is_refused(picture):
    recipe = recipe_of(picture)
    recipe["replay"]["density"] = 0
    with pytest.raises(ValueError, match="no samples"):
        replay(recipe, CORNER.volume)


# No bias


SEEDS = 200


@pytest.mark.parametrize("sampler", ["independent", "sobol"])
def test_mean_over_seeds_is_the_truth(sampler):
    # Blocks of 4 x 4 pixels of the mean over 200 seeds, each with its own pilot, in units of its
    # standard error from the spread over seeds: chi-squared, its variance widened by 199 / 197
    lit = dataclasses.replace(CORNER, size=(40, 32), sampler=sampler)
    truth = render(lit, 8000, seed=10**6).film
    means = np.array(
        [blocks(render(lit, 8, seed=s, adaptive=True).film.mean[..., 0]) for s in range(SEEDS)]
    )
    variance = means.var(axis=0, ddof=1) / SEEDS
    truth_variance = blocks(truth.m2[..., 0] / truth.count**2) / 16
    shown = variance > 0
    z = (means.mean(axis=0) - blocks(truth.mean[..., 0]))[shown]
    error = np.sqrt((variance + truth_variance) * 199 / 197)[shown]
    bound = chi2.ppf(0.999, shown.sum())
    assert ((z / error) ** 2).sum() < bound
    # Two percent less light would be seen
    darker = z - 0.02 * means.mean(axis=0)[shown]
    assert ((darker / error) ** 2).sum() > bound


def blocks(plane):
    height, width = plane.shape
    return plane.reshape(height // 4, 4, width // 4, 4).mean(axis=(1, 3))


# Errors


def test_error_is_smaller_than_of_as_many_even_samples(picture):
    # Of the film a sixth is noisy: the even picture wastes the rest. Both errors are known to 3 %
    even = render(CORNER, 64, seed=6)
    assert picture.nrms < 0.75 * even.nrms
    truth = render(CORNER, 8000, seed=99)
    assert nrms_against(picture, truth) < 0.8 * nrms_against(even, truth)


@pytest.mark.parametrize("sampler", ["independent", "sobol"])
def test_errors_that_uneven_pixels_claim_are_those_they_have(sampler):
    # 24 seeds x 600 lit values; floors of 32 samples, so that Sobol points have their batches
    lit = everything(*LIT, camera=CORNER.camera, size=(40, 32), sampler=sampler)
    truth = render(lit, samples=12_000, seed=10**6)
    shown = truth.film.mean > 1e-3
    hits, claimed, wrong = [], [], []
    for seed in range(24):
        picture = render(lit, samples=128, seed=seed, adaptive=True)
        assert np.unique(picture.film.count).size > 2
        off = picture.film.mean - truth.film.mean
        hits.append((np.abs(off) <= 1.96 * picture.standard_error)[shown].mean())
        claimed.append(picture.nrms**2)
        wrong.append((off**2).mean() / (truth.film.mean**2).mean())
    assert 0.93 <= np.mean(hits) <= 0.975
    assert math.sqrt(np.mean(claimed) / np.mean(wrong)) == pytest.approx(1, abs=0.1)


def test_render_stops_at_the_error_asked_for_and_has_it():
    truth = render(CORNER, 8000, seed=99)
    picture = render(CORNER, None, nrms=0.03, adaptive=True)
    assert picture.stopped_by == "nrms"
    assert picture.film.count.min() >= schedule.LEAST_SAMPLES
    # Error of some 400 pixels x 3 alike channels: known to 4 %; five of those
    assert nrms_against(picture, truth) <= 1.2 * 0.03


def test_a_light_that_the_pilot_missed_does_not_fool_the_stop_rule():
    # As in test_accuracy: one path in 9000 finds nearly all the light
    pixels = np.full((64, 128, 3), 1e-3)
    pixels[32, 64] = 200.0
    rare = scene(
        slab(points=3), medium(2.0), lights=(EnvironmentMap(pixels),), light_sampling="scatter"
    )
    assert render(rare, samples=2000, nrms=0.05, adaptive=True).stopped_by == "samples"


def test_a_dark_picture_ends_and_says_so():
    away = scene(camera=Camera((0, -5, 0), (0, -9, 0)), lights=LIT)
    picture = render(away, samples=None, nrms=0.01, adaptive=True)
    assert picture.stopped_by == "dark"


# Merging


@pytest.mark.parametrize("sampler", ["independent", "sobol"])
def test_merged_films_are_the_film_of_all_samples(sampler):
    lit = scene(noise(), lights=LIT, size=(9, 8), sampler=sampler, aovs=("albedo",))
    lit = dataclasses.replace(lit, aovs=())
    first, second = render(lit, 40, seed=1, adaptive=True), render(lit, 32, seed=2)
    film = merge(first.film, second.film)
    n, more = (f.count[..., None] for f in (first.film, second.film))
    assert np.unique(n).size > 1 or (n == 40).all()
    expected = (n * first.film.mean + more * second.film.mean) / (n + more)
    np.testing.assert_allclose(film.mean, expected, rtol=1e-12, atol=1e-15)
    # Squared deviations from the common mean, by the sum of squares of each
    squares = sum(
        f.m2 + f.count[..., None] * (f.mean - expected) ** 2 for f in (first.film, second.film)
    )
    np.testing.assert_allclose(film.m2, squares, rtol=1e-9, atol=1e-15)
    assert (film.count == first.film.count + 32).all()
    np.testing.assert_array_equal(merge(second.film, new_film_like(second)).mean, second.film.mean)


def new_film_like(picture):
    return new_film(*picture.size, picture.plan.packed.sobol)


def test_errors_of_merged_films_cover_the_truth():
    lit = scene(noise(), lights=LIT)
    truth = render(lit, 6000, seed=0).film.mean
    covered = []
    for seed in range(12):
        parts = [render(lit, 32, seed=2 * seed + k, adaptive=k == 1) for k in (1, 2)]
        film = merge(*(p.film for p in parts))
        error = dataclasses.replace(parts[0], film=film, density=None).standard_error
        covered.append((np.abs(film.mean - truth) <= 1.96 * error).mean())
    assert 0.93 <= np.mean(covered) <= 0.98


def test_films_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="3 x 2 and 2 x 3"):
        merge(new_film(3, 2), new_film(2, 3))
    with pytest.raises(ValueError, match="albedo"):
        merge(new_film(2, 2, aovs=("albedo",)), new_film(2, 2))
    half = render(scene(noise(), lights=LIT, size=(4, 4)), 8)
    with pytest.raises(ValueError, match="whole batches of 16"):
        merge(half.film, half.film)


# Asking for it


def test_too_little_time_for_a_pilot_spreads_samples_evenly_and_says_so(caplog):
    large = dataclasses.replace(CORNER, size=(800, 600))
    with caplog.at_level(logging.WARNING, "vtkmcvr"):
        picture = render(large, None, seconds=0.02, adaptive=True)
    assert picture.density is None and not picture.facts()["adaptive"]
    assert "evenly" in caplog.text


def test_other_techniques_and_predictions_refuse_it(tmp_path, capsys):
    with pytest.raises(ValueError, match="technique occlusion has no adaptive"):
        front_render(CORNER, technique="occlusion", adaptive=True)
    arguments = ["demo", "--size", "16x12", "-o", str(tmp_path / "p.png"), "--adaptive"]
    assert main([*arguments, "--dry-run"]) != 0
    assert "--adaptive" in capsys.readouterr().err


def test_command_line_asks_for_it(tmp_path, capsys):
    arguments = ["demo", "--size", "16x12", "-o", str(tmp_path / "p.png"), "--samples", "4"]
    assert main([*arguments, "--adaptive"]) == 0
    assert "4 adaptive samples per pixel" in capsys.readouterr().out
