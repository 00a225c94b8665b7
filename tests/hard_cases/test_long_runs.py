"""Films after very many samples, and put together from parts (HC-53, HC-54, HC-55)."""

import itertools
import math

import numpy as np
import pytest
from scenes import blob, noise, render, scene
from techniques import SKY

from vtkmcvr import packed, schedule
from vtkmcvr.film.merge import merge
from vtkmcvr.film.moments import new_film
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.sample import accumulate

f32 = np.float32
MILLION = 1_000_000


@entry_point
def add_samples(film, samples, repeats):
    """Feed samples to pixel (0, 0), over and over."""
    for _ in range(repeats):
        for x in samples:
            accumulate(film, 0, 0, (x, x, x), True, x)


def samples_film(samples, repeats=1, batched=True):
    film = new_film(1, 1, packed.Sobol(0, 0, 16) if batched else None)
    add_samples(film, np.asarray(samples, f32), repeats)
    return film


@pytest.mark.parametrize("constant", [0.1, 1e-20, 1e20])
def test_hc53_a_million_samples_of_a_constant(record, constant):
    # A running mean in float32 stalls; here it is the constant to the bit
    film = samples_film([constant], MILLION)
    exact = float(f32(constant))
    what = f"mean of 1e6 samples of {constant:g}"
    record("HC-53", what, "film", exact, film.mean[0, 0, 0], 1e-12 * exact)
    record("HC-53", f"their spread, {constant:g}", "film", 0, film.m2[0, 0, 0], 1e-12 * exact**2)


def test_hc53_a_million_samples_of_two_values(record):
    film = samples_film([0.0, 1.0], MILLION // 2)
    record("HC-53", "mean of 5e5 zeros and 5e5 ones", "film", 0.5, film.mean[0, 0, 0], 1e-6)
    variance = film.m2[0, 0, 0] / (MILLION - 1)
    record("HC-53", "their variance", "film", 0.25 * MILLION / (MILLION - 1), variance, 1e-9)


def test_hc55_variance_of_a_large_mean(record):
    # The mean of squares less the square of the mean would leave no digit in float32
    x = (1e4 + np.random.default_rng(1).normal(size=4096)).astype(f32)
    got = samples_film(x).m2[0, 0, 0] / (len(x) - 1)
    record("HC-55", "variance 1 on a mean of 1e4", "film", x.astype(float).var(ddof=1), got, 1e-9)


def test_hc55_welford_is_float64(record):
    # Heavy tails, a sample in 10^4 worth 10^4 others
    rng = np.random.default_rng(3)
    x = rng.exponential(size=200_000).astype(f32)
    x[rng.random(len(x)) < 1e-4] *= f32(1e4)
    film = samples_film(x)
    wide = x.astype(float)
    n = len(x) // packed.BATCH * packed.BATCH
    means = wide[:n].reshape(-1, packed.BATCH).mean(axis=1)
    for what, expected, got in (
        ("mean", wide.mean(), film.mean[0, 0, 0]),
        ("sum of squares", ((wide - wide.mean()) ** 2).sum(), film.m2[0, 0, 0]),
        (
            "sum of squares of batches",
            ((means - means.mean()) ** 2).sum(),
            film.batches.m2[0, 0, 0],
        ),
    ):
        record("HC-55", f"{what} of 2e5 samples", "film", expected, got, 1e-10 * expected)


def test_hc54_one_sample_that_is_not_finite(record):
    film = samples_film([2.0, math.nan, 4.0, math.inf, -math.inf, 6.0], batched=False)
    record("HC-54", "rejected of NaN, inf and -inf", "film", 3, film.rejected[0, 0], 0)
    record("HC-54", "mean with them as black", "film", 2, film.mean[0, 0, 0], 1e-15)
    assert film.violations[0, 0] == 1


def parts():
    """Films of one scene by three seeds, of different numbers of samples."""
    lit = scene(blob(), lights=SKY, size=(8, 8), aovs=("albedo", "normal"))
    return [render(lit, n, seed).film for seed, n in enumerate((16, 48, 32))]


def test_merged_films_are_those_of_all_samples(record):
    whole = merge(*parts())
    films = parts()
    n = np.array([16, 48, 32.0])
    mean = sum(k * film.mean for k, film in zip(n, films, strict=True)) / n.sum()
    record("merge", "mean", "film", 0, np.abs(whole.mean - mean).max(), 1e-14)
    squares = sum(f.m2 + k * (f.mean - mean) ** 2 for k, f in zip(n, films, strict=True))
    worst = np.abs(whole.m2 - squares).max()
    record("merge", "sum of squares", "film", 0, worst, 1e-12 * squares.max())
    hits = sum(film.hits for film in films)
    depth = sum(f.hits * f.depth for f in films) / np.maximum(hits, 1)
    record("merge", "depth", "film", 0, np.abs(whole.depth - depth).max(), 1e-13 * depth.max())
    assert (whole.count == 96).all()
    assert (whole.hits == hits).all()


def test_films_are_merged_in_any_order(record):
    films = parts()
    first, *others = (merge(*order) for order in itertools.permutations(films))
    for name in ("mean", "m2", "depth", "albedo", "normal"):
        a = getattr(first, name)
        worst = max(np.abs(getattr(other, name) - a).max() for other in others)
        record("merge", f"{name} by other orders", "film", 0, worst, 1e-13 * np.abs(a).max())
    worst = max(np.abs(o.batches.m2 - first.batches.m2).max() for o in others)
    record("merge", "batches by other orders", "film", 0, worst, 1e-13 * first.batches.m2.max())


def test_merged_films_have_the_error_of_a_longer_run():
    lit = scene(noise(), lights=SKY)
    from vtkmcvr.film.moments import nrms

    whole = merge(*(render(lit, 64, seed).film for seed in range(4)))
    assert nrms(whole) == pytest.approx(render(lit, 256, 9).nrms, rel=0.1)


def test_films_that_do_not_fit_are_refused():
    lit = scene(blob(), lights=SKY, size=(4, 4))
    film = render(lit, 16).film
    with pytest.raises(ValueError, match=r"of one size"):
        merge(film, new_film(5, 4, packed.Sobol(0, 0, 16)))
    with pytest.raises(ValueError, match=r"only one of the films .* batches"):
        merge(film, new_film(4, 4))
    with pytest.raises(ValueError, match=r"whole batches of 16"):
        merge(*(render(lit, 8, seed).film for seed in (1, 2)))


@pytest.mark.parametrize("seconds", [1e-3, 0.02])
def test_no_drift_between_sizes_of_passes(record, monkeypatch, seconds):
    lit = scene(blob(), lights=SKY)
    usual = render(lit, 300)
    monkeypatch.setattr(schedule, "PASS_SECONDS", seconds)
    other = render(lit, 300)
    difference = np.abs(usual.film.mean - other.film.mean).max()
    record("passes", f"mean by passes of {seconds:g} s", "film", 0, difference, 0)
