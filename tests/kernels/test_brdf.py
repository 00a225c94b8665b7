"""The Fresnel blend and the hybrid choice between surface and volume."""

import math

import numpy as np
import pytest
from brdf_reference import (
    UP,
    colour,
    direction,
    directional_albedo,
    gloss,
    grid,
    on_hemisphere,
    reference,
    values_and_densities,
)
from compiled import compiled
from scenes import WHITE, frontal, scene, volume

from vtkmcvr import packed
from vtkmcvr.curves import Curve
from vtkmcvr.kernels.brdf import (
    ALWAYS,
    HYBRID,
    THRESHOLD,
    brdf_weight_and_pdf,
    surface_event,
    surface_probability,
)
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.rng import start
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.scene import Surface, TransferFunction

f32 = np.float32
SKY = (ConstantEnvironment(),)
EXPONENTS = [0.0, 1.0, 1e2, 1e6]


@entry_point
def surface_share(surface, medium, p, sigma_t, wo, n):
    count = 0
    normal = (np.float32(0), np.float32(0), np.float32(0))
    for i in range(n):
        yes, m, _ = surface_event(surface, medium, p, sigma_t, wo, start(5, i, 0))
        if yes:
            count += 1
            normal = m
    return count, normal


@entry_point
def weights_and_densities(gloss, diffuse, n, wo, wi):
    out = np.empty((len(wi), 4), f32)
    for i in range(len(wi)):
        d = (wi[i, 0], wi[i, 1], wi[i, 2])
        weight, out[i, 3] = brdf_weight_and_pdf(gloss, diffuse, n, wo, d)
        out[i, 0], out[i, 1], out[i, 2] = weight
    return out


@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("theta", [0, 60, 89, 120])
def test_a_weight_is_the_value_over_the_density(exponent, theta):
    # Above and below the surface, with a coat and without
    random = np.random.default_rng(3).normal(size=(500, 3))
    wi = (random / np.linalg.norm(random, axis=1, keepdims=True)).astype(f32)
    wo, grey = direction(theta), colour(0.5)
    for coat in (gloss(0.04, exponent), None):
        expected = values_and_densities(coat, grey, UP, wo, wi)
        found = weights_and_densities(coat, grey, UP, wo, wi)
        assert (expected[:, 3] > 0).any() == (theta < 90)
        # Without a coat a direction below is never drawn for a wo above, and weights ask for wi
        drawn = expected[:, 3] > 0
        np.testing.assert_allclose(found[drawn, 3], expected[drawn, 3], rtol=1e-5)
        np.testing.assert_allclose(
            found[drawn, :3] * found[drawn, 3:], expected[drawn, :3], rtol=1e-5, atol=1e-12
        )
        assert coat is None or not found[~drawn].any()


@pytest.mark.parametrize(
    ("exponent", "theta", "expected"),
    [(100, 0, 0.970), (100, 45, 0.890), (100, 75, 0.641), (1, 0, 0.946), (1, 75, 0.536)],
)
def test_fresnel_blend_has_its_known_albedo(exponent, theta, expected):
    # R_d = 1, R_s = 0.04, D = (e + 2) / 2 pi
    albedo = directional_albedo(gloss(0.04, exponent), colour(1), direction(theta))
    assert albedo == pytest.approx([expected] * 3, abs=0.005)


@pytest.mark.parametrize("ggx", [False, True])
@pytest.mark.parametrize("exponent", [0.0, 1.0, 10.0, 1e2, 1e4, 1e6])
def test_no_surface_reflects_more_than_arrives(exponent, ggx):
    for specular in (1e-3, 0.04, 0.5, 1.0):
        for diffuse in (0.0, 0.5, 1.0):
            for theta in (0, 20, 45, 70, 85, 89, 89.99):
                albedo = directional_albedo(
                    gloss(specular, exponent, ggx), colour(diffuse), direction(theta)
                )
                assert (albedo > 0).all()
                # 1e-3 for float32 and the quadrature
                assert (albedo <= 1.001).all(), (specular, diffuse, theta, albedo)


def test_lambert_reflects_its_colour():
    wi = on_hemisphere(np.sqrt(grid()[:, 0]), 2 * np.pi * grid()[:, 1]).astype(f32)
    for theta in (0, 60, 89.9):
        out = values_and_densities(None, colour((1, 0.5, 0.25)), UP, direction(theta), wi)
        np.testing.assert_allclose(
            (out[:, :3] / out[:, 3:]).mean(axis=0), (1, 0.5, 0.25), rtol=1e-5
        )


@pytest.mark.parametrize("ggx", [False, True])
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_reciprocity(exponent, ggx):
    # f_r(a, b) = f_r(b, a), to 1e-5 (of value / cosine)
    coat, diffuse = gloss((0.04, 0.3, 1.0), exponent, ggx), colour((1.0, 0.5, 0.1))
    rng = np.random.default_rng(2)
    cosines = np.concatenate([rng.random(150), 10.0 ** rng.uniform(-4, 0, 50)])
    d = on_hemisphere(cosines, 2 * np.pi * rng.random(200)).astype(f32)
    # Pairs within the narrowest lobe, too: mirrored, then moved by a little
    near = d * f32([-1, -1, 1]) + rng.normal(0, 1e-4, d.shape).astype(f32)
    near /= np.linalg.norm(near, axis=1, keepdims=True)
    for a, b in [(d[:100], d[100:]), (d[near[:, 2] > 0], near[near[:, 2] > 0])]:
        for x, y in zip(a, b, strict=True):
            there = values_and_densities(coat, diffuse, UP, tuple(x), y[None])[0, :3] / y[2]
            back = values_and_densities(coat, diffuse, UP, tuple(y), x[None])[0, :3] / x[2]
            np.testing.assert_allclose(there, back, rtol=1e-5, atol=1e-30)


@pytest.mark.parametrize("ggx", [False, True])
@pytest.mark.parametrize("exponent", EXPONENTS)
@pytest.mark.parametrize("theta", [0, 45, 89, 89.99])
def test_fresnel_blend_is_its_formula(theta, exponent, ggx):
    coat, diffuse = gloss((0.04, 0.5, 1.0), exponent, ggx), colour((1.0, 0.2, 0.0))
    wo = direction(theta)
    mirror = np.array(wo) * [-1, -1, 1]
    rng = np.random.default_rng(3)
    spread = 10.0 ** rng.uniform(-5, 0, (2000, 1))
    wi = mirror + spread * rng.normal(size=(2000, 3))
    wi /= np.linalg.norm(wi, axis=1, keepdims=True)
    wi = wi[wi[:, 2] > 1e-6].astype(f32)
    found = values_and_densities(coat, diffuse, UP, wo, wi)
    expected = reference(coat, diffuse, wo, wi)
    assert np.isfinite(found).all()
    # Rounding of the half vector, 1e-7, is a relative error of e |n - h| 1e-7 in its power; where
    # the power counts, e |n - h|^2 / 2 is below 15, so the bound is 1e-7 sqrt(30 e), 5e-4 for e =
    # 1e6
    rtol = 1e-4 + 2e-7 * math.sqrt(30 * exponent)
    np.testing.assert_allclose(found[:, :3], expected, rtol=rtol, atol=1e-6 * expected.max())


def test_nothing_is_reflected_below_the_surface():
    below = on_hemisphere(np.linspace(0, 1, 50), np.linspace(0, 6, 50)).astype(f32) * f32(
        [1, 1, -1]
    )
    for coat in (None, gloss(0.5, 10)):
        assert not values_and_densities(coat, colour(1), UP, direction(30), below).any()


# Hybrid scattering


def packed_surface(mode, g=0.5, threshold=0.5):
    """Surface of a volume whose largest gradient magnitude is 40."""
    rows = (UP, UP, UP)
    return packed.Surface(
        np.int32(mode), f32(1e30), rows, f32(1 / 40), f32(25 * g**3), f32(threshold)
    )


@pytest.mark.parametrize(
    ("g", "m", "expected"),
    [(0.25, 1, 0.32), (0.5, 0.1, 0.268), (0.5, 0.5, 0.790), (0.5, 1, 0.956), (0.75, 0.1, 0.652),
     (1, 0.01, 0.221), (1, 0.1, 0.918), (0.5, math.log(2) / 3.125, 0.5), (1, 1e-9, 2.5e-8)],
)  # fmt: skip
@pytest.mark.parametrize("alpha", [1.0, 0.3])
def test_probability_of_a_surface(g, m, expected, alpha):
    surface = packed_surface(HYBRID, g)
    found = compiled(surface_probability)(surface, f32(alpha), f32(40 * m))
    assert found == pytest.approx(alpha * expected, abs=4e-3 * alpha)
    assert found == pytest.approx(alpha * -math.expm1(-25 * g**3 * m), rel=1e-5)


@pytest.mark.parametrize("alpha", [1.0, 0.3])
@pytest.mark.parametrize("m", [1e-6, 0.49, 0.51, 1.0])
def test_probability_of_a_surface_in_other_modes(m, alpha):
    probability = compiled(surface_probability)
    always = probability(packed_surface(ALWAYS), f32(alpha), f32(40 * m))
    above = probability(packed_surface(THRESHOLD), f32(alpha), f32(40 * m))
    assert always == pytest.approx(alpha)
    assert above == pytest.approx(alpha if m > 0.5 else 0.0)


def two_slopes():
    """Values rise by 1 per voxel along x up to 16, then by 0.1; the largest gradient is 1 / 0.5."""
    x = np.arange(33)
    row = np.where(x < 16, x, 16 + 0.1 * (x - 16)).astype(f32)
    return volume(np.broadcast_to(row, (5, 5, 33)), (0.5, 1.0, 1.0))


@pytest.mark.parametrize(("x", "m"), [(8.3, 1.0), (24.6, 0.1)])
@pytest.mark.parametrize("g", [0.3, 0.8])
def test_surfaces_happen_with_their_probability(x, m, g):
    transfer = TransferFunction(Curve([(0, 0.6)]), WHITE)
    parts = plan(scene(two_slopes(), transfer, frontal(), surface=Surface(g), lights=SKY)).packed
    wo = direction(30, 180)
    n = 50_000
    place = (f32(x), f32(2.2), f32(1.7))
    sigma_t = f32(-math.log1p(-0.6))
    count, normal = surface_share(parts.surface, parts.medium, place, sigma_t, wo, n)
    p = 0.6 * -math.expm1(-25 * g**3 * m)
    # 4.5 binomial standard errors: 4 x 6.8e-6
    assert abs(count - n * p) < 4.5 * math.sqrt(n * p * (1 - p))
    # The gradient points along +x; the normal is on the viewer's side
    np.testing.assert_allclose(normal, (-1, 0, 0), atol=1e-6)


def test_opacity_modulation_can_be_left_out():
    transfer = TransferFunction(Curve([(0, 0.1)]), WHITE)
    surface = Surface(0.3, opacity_modulated=False)
    parts = plan(scene(two_slopes(), transfer, frontal(), surface=surface, lights=SKY)).packed
    n, p = 50_000, -math.expm1(-25 * 0.3**3)
    place, sigma_t = (f32(8.3), f32(2.2), f32(1.7)), f32(-math.log1p(-0.1))
    count, _ = surface_share(parts.surface, parts.medium, place, sigma_t, direction(30, 180), n)
    # 4.5 binomial standard errors, as above
    assert abs(count - n * p) < 4.5 * math.sqrt(n * p * (1 - p))


def test_no_surface_without_a_gradient():
    values = two_slopes().values.copy()
    values[:, :, :8] = 0
    parts = plan(
        scene(
            volume(values),
            TransferFunction(Curve([(0, 0.6)]), WHITE),
            lights=SKY,
            surface=Surface(mode="brdf"),
        )
    ).packed
    for place, some in [((3, 2, 2), False), ((12, 2, 2), True)]:
        count, normal = surface_share(
            parts.surface,
            parts.medium,
            tuple(f32(c) for c in place),
            f32(1),
            UP,
            100,
        )
        assert count == (100 if some else 0)
        assert np.isfinite(normal).all()
