"""Closed furnaces: an even environment that nothing absorbs stays even, whatever scatters.

Every path of a white furnace ends in the environment with throughput 1, so each sample is exactly
1 but for float32 rounding: no statistics are needed.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import WHITE, frontal, mean_and_error, medium, noise, render, scene, slab

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.lights import ConstantEnvironment, EnvironmentMap
from vtkmcvr.scene import (
    Camera,
    Cone,
    HenyeyGreenstein,
    Isotropic,
    Rayleigh,
    Schlick,
    Surface,
    TransferFunction,
)

UNIT = (ConstantEnvironment(1.0),)
PHASES = [
    Isotropic(), HenyeyGreenstein(-0.9), HenyeyGreenstein(0.5), HenyeyGreenstein(0.9999),
    Schlick(0.7), Rayleigh(), Cone(30),
]  # fmt: skip
DENSITIES = [1e-3, 0.01, 1.0, 30.0, 1000.0]


def furnace(vol, transfer, **options):
    return scene(
        vol, transfer, frontal(0.9, vol.centre), size=(16, 16), scattering="multiple",
        environment_visible=True, **{"lights": UNIT, **options},
    )  # fmt: skip


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize("phase", PHASES, ids=str)
def test_white_furnace_is_white(record, phase, density):
    # 65 points: no density up to 1e3 is cut off
    lit = furnace(slab(points=65), medium(density), phase=phase)
    picture = render(lit, samples=256 if density < 0.1 else 4)
    assert picture.alpha.max() > 0
    assert not picture.plan.notes
    worst = np.abs(picture.radiance - 1).max()
    what = f"furnace of {phase}, extinction {density:g}"
    record("HC-30", what, "monte-carlo multiple", 0, worst, 1e-3)


def test_white_furnace_of_ten_thousand_mean_free_paths_is_white(record):
    lit = replace(furnace(slab(points=161), medium(1e4)), size=(8, 8))
    picture = render(lit, samples=2)
    assert not picture.plan.notes
    worst = np.abs(picture.radiance - 1).max()
    record("HC-30", "furnace, extinction 10000", "monte-carlo multiple", 0, worst, 1e-3)


@pytest.mark.parametrize("density", DENSITIES)
def test_white_furnace_of_uneven_density_is_white(density):
    picture = render(furnace(noise(), medium(density)), samples=8)
    assert np.abs(picture.radiance - 1).max() < 1e-3


@pytest.mark.parametrize("mode", ["hybrid", "brdf", "threshold"])
def test_white_furnace_with_lambert_surfaces_is_white(record, mode):
    surface = Surface(0.5, mode=mode, specular=0.0)
    picture = render(furnace(noise(), medium(30.0), surface=surface), samples=8)
    worst = np.abs(picture.radiance - 1).max()
    record("HC-31", f"furnace of Lambert surfaces, {mode}", "monte-carlo multiple", 0, worst, 1e-3)


@pytest.mark.parametrize("density", [1e-3, 1.0, 1000.0])
@pytest.mark.parametrize("mode", ["hybrid", "brdf", "threshold"])
@pytest.mark.parametrize("phase", [p for p in PHASES if p != Isotropic()], ids=str)
def test_white_furnace_of_surfaces_and_any_phase_is_white(record, phase, mode, density):
    surface = Surface(0.5, mode=mode, specular=0.0, threshold=0.1)
    vol = noise(17)
    lit = furnace(vol, medium(density), surface=surface, phase=phase)
    worst = np.abs(render(lit, samples=64 if density < 0.1 else 4).radiance - 1).max()
    what = f"furnace of {mode} surfaces in {phase}, extinction {density:g}"
    record("HC-31", what, "monte-carlo multiple", 0, worst, 1e-3)


@pytest.mark.slow
def test_coat_never_makes_a_furnace_brighter():
    # The Fresnel blend loses light at every bounce, up to half of it at grazing angles
    surface = Surface(0.8, specular=0.3, exponent=20.0)
    picture = render(furnace(noise(), medium(30.0), surface=surface), samples=64)
    mean, error = mean_and_error(picture)
    assert 0.2 < mean < 1 - 4.5 * error


@pytest.mark.slow
@pytest.mark.parametrize("sampling", ["mis", "light", "scatter"])
def test_white_furnace_lit_by_a_map_is_white_on_average(sampling):
    # Light sampling makes it a statistical question. Four standard errors: 6e-5 for each
    lights = (EnvironmentMap(np.ones((2, 4, 3))),)
    picture = render(
        furnace(noise(), medium(3.0), lights=lights, light_sampling=sampling, phase=Rayleigh()),
        samples=128,
    )
    mean, error = mean_and_error(picture)
    assert error < 0.008
    assert abs(mean - 1) < 4 * error + 1e-6


# Grey furnaces


def h_function(albedo, mu, n=64):
    """H(mu) of Chandrasekhar (Radiative Transfer, 1950) for isotropic scattering, in float64.

    H(mu) = 1 / (sqrt(1 - w) + w/2 integral of m H(m) / (mu + m) over m from 0 to 1).
    """
    x, weight = np.polynomial.legendre.leggauss(n)
    m, weight = (x + 1) / 2, weight / 2
    h = np.ones(n)
    root = math.sqrt(1 - albedo)
    for _ in range(2000):
        h = 1 / (root + albedo / 2 * (weight * m * h / (m[:, None] + m)).sum(axis=1))
    return 1 / (root + albedo / 2 * (weight * m * h / (mu + m)).sum())


def looking_down(mu, edges=(400, 100, 400)):
    """Camera that sees the middle of the front face at an angle of cosine mu to its normal."""
    aim = np.array((0.0, -edges[1] / 2, 0.0))
    back = 50 * np.array((0.0, -mu, math.sqrt(1 - mu * mu)))
    return slab(edges), Camera(aim + back, aim, view_up=(1, 0, 0), parallel_scale=0.5)


CASES = [(0.5, 1.0), (0.9, 1.0), (0.9, 0.3), (0.99, 1.0)]


@pytest.mark.parametrize(("albedo", "mu"), CASES)
def test_half_space_under_an_even_sky(record, albedo, mu):
    # In equilibrium with an even sky the half-space would shine like it; emission alone gives
    # sqrt(1 - w) H(mu), so 1 - sqrt(1 - w) H(mu) is reflected
    vol, camera = looking_down(mu)
    picture = render(
        scene(vol, medium(1.0, albedo), camera, lights=UNIT, scattering="multiple"), samples=32
    )
    mean, error = mean_and_error(picture)
    assert error < 0.004
    expected = 1 - math.sqrt(1 - albedo) * h_function(albedo, mu)
    what = f"half-space of albedo {albedo:g} at cosine {mu:g}"
    record("furnace", what, "monte-carlo multiple", expected, mean, 4 * error)


@pytest.mark.slow
@pytest.mark.parametrize(("albedo", "mu"), CASES[:2])
def test_half_space_that_glows(albedo, mu):
    vol, camera = looking_down(mu)
    glowing = TransferFunction(
        None, ColourCurve([(0, albedo, albedo, albedo)]), extinction=Curve([(0, 0), (1, 1)]),
        emission=WHITE, emission_scale=3.0,
    )  # fmt: skip
    picture = render(scene(vol, glowing, camera, scattering="multiple"), samples=32)
    mean, error = mean_and_error(picture)
    assert abs(mean / 3 - math.sqrt(1 - albedo) * h_function(albedo, mu)) < 4 * error / 3


def test_glowing_medium_in_equilibrium_with_its_sky_is_even():
    # L_e = L_sky = 1: radiance 1 everywhere, whatever the albedo of each channel. Roulette is the
    # only randomness left
    colours = ColourCurve([(0, 0.0, 0.5, 0.95), (1, 0.9, 0.2, 0.6)])
    glowing = TransferFunction(None, colours, extinction=Curve([(0, 1), (1, 20)]), emission=WHITE)
    picture = render(furnace(noise(), glowing), samples=64)
    for channel in range(3):
        mean, error = mean_and_error(picture, channel)
        assert error < 0.01
        assert abs(mean - 1) < 4 * error + 1e-6


def test_more_scattering_events_are_brighter_and_converge():
    # The same seed: the first events of a path are the same, later ones only add light
    pictures = [
        render(furnace(noise(), medium(20.0, 0.9), max_scatterings=n), samples=16)
        for n in (1, 2, 8, 200, None)
    ]
    means = [picture.radiance.mean() for picture in pictures]
    assert means[0] < means[1] < means[2] < means[3]
    assert means[4] == means[3]
    assert pictures[0].plan.packed.scattering is None
