"""The error falls as the inverse square root of the number of samples."""

import dataclasses

import numpy as np
import pytest
from real_volumes import real_volume
from scenes import noise, render, scene

from vtkmcvr.costs.fit import fit_power
from vtkmcvr.front import scene_of
from vtkmcvr.lights import ConstantEnvironment

SAMPLERS = ("independent", "sobol")
LIT = scene(noise(), lights=(ConstantEnvironment(1.0),), size=(40, 32))


def error_of(lit, samples):
    """Root mean square error from two pictures that share nothing: no truth is needed.

    The mean square difference is twice the variance. Of P pixels its standard error is the spread
    of their square differences over the root of P; it is an upper bound, since pixels differ.
    """
    a, b = (render(lit, samples, seed=2 * samples + k).film.mean for k in (0, 1))
    square = ((a - b) ** 2).mean(-1) / 2
    error = np.sqrt(square.mean())
    relative = square.std() / square.mean() / np.sqrt(square.size)
    return error, 1.96 * error * relative / 2


def convergence(lit, most):
    """Samples, errors and half widths at 1, 2, 4 ... samples, independent of each other."""
    samples = 2 ** np.arange(int(np.log2(most)) + 1)
    errors, spreads = np.array([error_of(lit, int(n)) for n in samples]).T
    return samples, errors, spreads


def test_fit_finds_the_power_within_its_confidence():
    # 400 series of errors that are known to 5 %: 95 % of the intervals hold the exponent, with
    # fewer than 366 or more than 392 having a probability below 1e-3 (binomial)
    rng = np.random.default_rng(1)
    n = 2.0 ** np.arange(9)
    hits = 0
    for _ in range(400):
        errors = 0.8 * n**-0.5 * np.exp(0.05 * rng.normal(size=9))
        power = fit_power(n, errors, 1.96 * 0.05 * errors)
        assert power.factor == pytest.approx(0.8, rel=0.25)
        hits += abs(power.exponent + 0.5) <= power.spread
    assert 366 <= hits <= 392


def test_fit_would_tell_a_slower_fall():
    n = 2.0 ** np.arange(9)
    power = fit_power(n, n**-0.45, 0.05 * n**-0.45)
    assert power.exponent == pytest.approx(-0.45)
    assert power.exponent - power.spread > -0.5


def check_fall(lit, most, resolution):
    found = {}
    for sampler in SAMPLERS:
        found[sampler] = convergence(dataclasses.replace(lit, sampler=sampler), most)
    power = fit_power(*found["independent"])
    assert power.spread < resolution
    # 1.96 standard errors are a spread; 3.3 are passed by chance once in a thousand times
    widest = 3.3 / 1.96
    assert abs(power.exponent + 0.5) <= widest * power.spread
    even = fit_power(*found["sobol"])
    assert even.exponent <= -0.5 + widest * even.spread
    # At no number of samples worse than independent ones, by four standard errors of the ratio
    (_, errors, spreads), (_, evens, even_spreads) = found["independent"], found["sobol"]
    worst = np.hypot(spreads / errors, even_spreads / evens) * 4 / 1.96
    assert (evens / errors <= 1 + worst).all()


def test_error_falls_as_the_root_of_the_number_of_samples():
    check_fall(LIT, 256, 0.02)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "flip", "preset"),
    [
        ("scivis/cthead/CThead.nhdr", "k", "ct-bone"),
        ("scivis/engine.nhdr", "", "solid"),
        ("dicom/ct_thorax_lidc0314", "", "ct-bone"),
    ],
    ids=["CT-head", "engine", "CT-thorax"],
)
def test_error_of_a_real_volume_falls_so_up_to_4096_samples(file, flip, preset):
    volume = real_volume(file)
    volume = volume.flipped(flip) if flip else volume
    check_fall(scene_of(volume, preset=preset, size=(40, 30)).scene, 4096, 0.02)
