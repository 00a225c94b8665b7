"""Emission: the source sigma_a L_e, seen through what absorbs it.

z-scores are compared with 4.5: by Bonferroni over fewer than 20 comparisons, chance exceeds it in
less than 20 x 6.8e-6 = 1.4e-4 of all choices of seeds.
"""

import math

import numpy as np
import pytest
from scenes import WHITE, frontal, mean_and_error, medium, render, scene, slab, volume

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.lights import ConstantEnvironment, DirectionalLight
from vtkmcvr.plan import plan
from vtkmcvr.scene import TransferFunction

RED = ColourCurve([(0, 1, 0.5, 0.1)])


def glowing(sigma_t, colour=0.0, emission=RED, scale=2.0):
    return TransferFunction(
        None, ColourCurve([(0, colour, colour, colour)]),
        extinction=Curve([(0, 0), (1, sigma_t)]), emission=emission, emission_scale=scale,
    )  # fmt: skip


@pytest.mark.parametrize("depth", [0.1, 1.0, 50.0])
def test_black_body_shows_its_radiance_through_itself(depth):
    # L = L_e (1 - exp(-tau)): every colliding sample is L_e, so the picture is alpha L_e exactly,
    # and alpha is binomial
    picture = render(scene(slab((2, 2, 2)), glowing(depth / 2)), samples=64)
    np.testing.assert_allclose(
        picture.radiance, picture.alpha[..., None] * np.array((2, 1, 0.2)), rtol=1e-6
    )
    n, p = picture.film.count.sum(), -math.expm1(-depth)
    assert abs(picture.film.hits.sum() / n - p) < 4.5 * math.sqrt(p * (1 - p) / n) + 1e-9


def test_what_scatters_does_not_emit():
    # Thin enough to be seen once: sigma_a / sigma_t = 1 - albedo
    picture = render(scene(slab((2, 2, 2)), glowing(0.5, 0.75)), samples=16)
    np.testing.assert_allclose(
        picture.radiance, 0.25 * picture.alpha[..., None] * np.array((2, 1, 0.2)), rtol=1e-6
    )


def test_emission_does_not_depend_on_the_number_of_lights():
    # HC-44: black, so that lights add nothing
    lights = [ConstantEnvironment(1.0), DirectionalLight((0, 0, -1))]
    dark = render(scene(slab(), glowing(1.0)), samples=8)
    lit = render(scene(slab(), glowing(1.0), lights=lights), samples=8)
    np.testing.assert_array_equal(dark.radiance, lit.radiance)


def test_emission_by_the_scalar_is_seen_through_what_lies_before():
    # A glowing half behind a dark one, 1 mean free path each:
    # L = L_e exp(-1) (1 - exp(-1)); the boundary is a voxel wide, linear, and symmetric
    values = np.zeros((2, 201, 2), np.float32)
    values[:, 100:] = 1
    values[:, 100] = 0.5
    behind = ColourCurve([(0.5, 0, 0, 0), (0.5, 1, 1, 1)])
    transfer = TransferFunction(
        None, ColourCurve([(0, 0, 0, 0)]), extinction=Curve([(0, 1)]), emission=behind
    )
    picture = render(scene(volume(values, (2, 0.01, 2)), transfer, frontal(0.9)), samples=64)
    mean, error = mean_and_error(picture)
    assert error < 0.003
    assert abs(mean - math.exp(-1) * -math.expm1(-1)) < 4.5 * error


def test_absent_emission_compiles_nothing():
    none = plan(scene()).packed.transfer
    black = glowing(3.0, emission=ColourCurve([(0, 0, 0, 0)]))
    off = glowing(3.0, scale=0.0)
    assert none.emission is None
    for transfer in (black, off):
        assert plan(scene(transfer=transfer)).packed.transfer.emission is None
    assert plan(scene(transfer=glowing(3.0))).packed.transfer.emission is not None


def test_emission_adds_to_scattered_light():
    # Independent of each other: the sum of both pictures, by the same random numbers
    lights = (ConstantEnvironment(0.5),)
    one = TransferFunction(
        None, ColourCurve([(0, 0.5, 0.5, 0.5)]), extinction=Curve([(0, 0), (1, 2)]), emission=WHITE
    )
    both = render(scene(transfer=one, lights=lights), samples=16)
    glow = render(scene(transfer=one), samples=16)
    light = render(scene(transfer=medium(2.0, 0.5), lights=lights), samples=16)
    np.testing.assert_allclose(both.radiance, glow.radiance + light.radiance, atol=1e-5)
