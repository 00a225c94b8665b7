"""Every sampler against the density it claims.

Chance fails a right sampler in less than 1e-3 of all choices of seeds: each p-value is compared
with 1e-3 / TESTS (Bonferroni; see `densities`). The seeds are fixed.
"""

import math

import numpy as np
import pytest
from densities import TESTS, N, bin_probabilities, check, p_value
from scenes import scene
from scipy import stats

from vtkmcvr import packed
from vtkmcvr.kernels.brdf import brdf_value_and_pdf, sample_brdf
from vtkmcvr.kernels.environment import environment_pdf, environment_radiance, sample_environment
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.phase import phase_value, sample_phase
from vtkmcvr.kernels.rng import exponential, start, uniform
from vtkmcvr.kernels.warp import concentric_disk, cosine_hemisphere, uniform_sphere
from vtkmcvr.lights import EnvironmentMap
from vtkmcvr.phases import Cone, Rayleigh, Schlick
from vtkmcvr.planning.lights import pack_lights
from vtkmcvr.planning.phase import pack_phase

f32 = np.float32
SEED = np.int64(11)


# Loops around the kernels


@entry_point
def draw_uniform(seed, pixels, samples, dimensions):
    out = np.empty((pixels, samples, dimensions), f32)
    for p in range(pixels):
        for s in range(samples):
            rng = start(seed, p, s)
            for d in range(dimensions):
                rng, out[p, s, d] = uniform(rng)
    return out


@entry_point
def draw_exponential(seed, n):
    out = np.empty(n, f32)
    for i in range(n):
        _, out[i] = exponential(start(seed, i, 0))
    return out


@entry_point
def draw_warps(seed, n):
    out = np.zeros((3, n, 3), f32)
    for i in range(n):
        rng, u = uniform(start(seed, i, 0))
        rng, v = uniform(rng)
        out[0, i, :2] = concentric_disk(u, v)
        out[1, i] = uniform_sphere(u, v)
        out[2, i] = cosine_hemisphere(u, v)
    return out


@entry_point
def draw_phase(phase, wo, seed, n):
    out = np.empty((n, 3), f32)
    for i in range(n):
        out[i], _ = sample_phase(phase, wo, start(seed, i, 0))
    return out


@entry_point
def phase_density(phase, wo, directions):
    out = np.empty(len(directions), f32)
    for i in range(len(directions)):
        d = directions[i]
        out[i] = phase_value(phase, wo, (d[0], d[1], d[2]))
    return out


@entry_point
def draw_brdf(gloss, normal, wo, seed, n):
    out = np.empty((n, 3), f32)
    for i in range(n):
        out[i], _ = sample_brdf(gloss, normal, wo, start(seed, i, 0))
    return out


@entry_point
def brdf_density(gloss, normal, wo, directions):
    out = np.empty(len(directions), f32)
    for i in range(len(directions)):
        d = directions[i]
        _, out[i] = brdf_value_and_pdf(gloss, normal, normal, wo, (d[0], d[1], d[2]))
    return out


@entry_point
def draw_environment(environment, seed, n):
    out = np.empty((n, 7), f32)
    for i in range(n):
        wi, radiance, pdf, _ = sample_environment(environment, start(seed, i, 0))
        out[i, :3] = wi
        out[i, 3:6] = radiance
        out[i, 6] = pdf
    return out


@entry_point
def environment_density(environment, directions):
    out = np.empty(len(directions), f32)
    for i in range(len(directions)):
        d = directions[i]
        out[i] = environment_pdf(environment, (d[0], d[1], d[2]))
    return out


@entry_point
def environment_light(environment, directions):
    out = np.empty((len(directions), 3), f32)
    for i in range(len(directions)):
        d = directions[i]
        out[i] = environment_radiance(environment, (d[0], d[1], d[2]))
    return out


def vector(*v):
    v = np.array(v, np.float64)
    return tuple(f32(x) for x in v / np.linalg.norm(v))


# Random numbers


@pytest.fixture(scope="module")
def numbers():
    """Variates of 512 pixels, 64 samples and 8 dimensions each."""
    return draw_uniform(SEED, 512, 64, 8)


def test_uniform_is_in_the_half_open_unit_interval_on_24_bits(numbers):
    assert numbers.min() >= 0
    assert numbers.max() < 1
    np.testing.assert_array_equal(numbers * 2**24, np.floor(numbers * 2**24))


def test_uniform_fills_all_bins_evenly(numbers):
    for d in range(numbers.shape[2]):
        counts = np.bincount((numbers[..., d].ravel() * 1024).astype(int), minlength=1024)
        assert p_value(counts, np.full(1024, numbers[..., d].size / 1024)) > 1e-3 / TESTS


def test_each_bit_of_uniform_is_fair(numbers):
    words = (numbers.ravel().astype(np.float64) * 2**24).astype(np.int64)
    for bit in range(24):
        ones = ((words >> bit) & 1).sum()
        # 4.8: two-sided 1.6e-6 for each of 24 bits
        assert abs(ones - len(words) / 2) < 4.8 * math.sqrt(len(words)) / 2


@pytest.mark.parametrize("axis", [0, 1, 2], ids=["pixels", "samples", "dimensions"])
def test_neighbouring_variates_are_independent(numbers, axis):
    for lag in (1, 2, 3):
        a = np.take(numbers, range(0, numbers.shape[axis] - lag), axis).ravel()
        b = np.take(numbers, range(lag, numbers.shape[axis]), axis).ravel()
        correlation = np.corrcoef(a, b)[0, 1]
        assert abs(correlation) * math.sqrt(len(a)) < 4.8
        pairs = np.histogram2d(a, b, 32, [[0, 1], [0, 1]])[0]
        assert p_value(pairs, np.full(pairs.shape, len(a) / pairs.size)) > 1e-3 / TESTS


def test_seeds_are_independent(numbers):
    other = draw_uniform(SEED + np.int64(1), *numbers.shape)
    assert np.mean(numbers == other) < 1e-3
    correlation = np.corrcoef(numbers.ravel(), other.ravel())[0, 1]
    assert abs(correlation) * math.sqrt(numbers.size) < 4.8


def test_start_never_repeats_over_a_picture(numbers):
    # 24-bit words of 6 dimensions as one key: 2^-144 for a coincidence
    keys = np.unique(numbers[..., :6].reshape(-1, 6), axis=0)
    assert len(keys) == numbers.shape[0] * numbers.shape[1]


def test_exponential_is_standard():
    x = draw_exponential(SEED, N)
    assert stats.kstest(x.astype(np.float64), stats.expon.cdf).pvalue > 1e-3 / TESTS
    assert x.min() >= 0
    # The largest of N has a Gumbel distribution around log(N) = 12.2: 99.999 % are in [9.7, 23.8]
    assert 9.7 < x.max() < 22.9


# Warps


@pytest.fixture(scope="module")
def warps():
    return draw_warps(SEED, N)


def test_concentric_disk_is_even(warps):
    x, y = warps[0, :, 0], warps[0, :, 1]
    square = x.astype(np.float64) ** 2 + y.astype(np.float64) ** 2
    assert square.max() < 1 + 1e-6
    counts = np.histogram2d(square, np.arctan2(y, x), (16, 16), [[0, 1], [-math.pi, math.pi]])[0]
    assert p_value(counts, np.full(counts.shape, N / counts.size)) > 1e-3 / TESTS


def test_uniform_sphere_is_even(warps):
    check(warps[1], lambda d: np.full(len(d), 0.25 / math.pi))


def test_cosine_hemisphere_is_proportional_to_the_cosine(warps):
    check(warps[2], lambda d: np.maximum(d[:, 2], 0) / math.pi)


# Phase functions


def henyey_greenstein(g):
    return packed.Phase(np.int32(0), f32(g))


def other_phase(phase):
    return pack_phase(phase)[0]


# With the mean cosine between the directions of propagation
PHASES = [
    (None, 0.0),
    *((henyey_greenstein(g), float(f32(g))) for g in (-0.9, -0.5, 1e-4, 0.5, 0.9)),
    # (1 - (1 - k^2) ln((1 + k) / (1 - k)) / 2 k) / k
    (other_phase(Schlick(0.5)), 2 * (1 - 0.75 * math.log(3))),
    (other_phase(Schlick(-0.9)), (1 - 0.19 * math.log(19) / 1.8) / -0.9),
    (other_phase(Rayleigh()), 0.0),
    (other_phase(Cone(180)), 0.0),
]


@pytest.mark.parametrize("wo", [vector(0, 0, 1), vector(0, 0, -1), vector(1, -2, 0.5)])
@pytest.mark.parametrize(("phase", "g"), PHASES)
def test_phase_function(phase, g, wo):
    directions = draw_phase(phase, wo, SEED, N)
    check(directions, lambda d: phase_density(phase, wo, d))
    # The standard deviation of a cosine of mean g is at most sqrt(1 - g^2)
    mean = -(directions.astype(np.float64) @ np.array(wo, np.float64)).mean()
    assert abs(mean - g) < 5 * math.sqrt((1 - g * g) / N)


@pytest.mark.parametrize("g", [-0.9999, -0.99, -0.9, 0.0, 0.5, 0.99, 0.9999])
def test_phase_function_is_that_of_henyey_and_greenstein(g):
    # Forward is wi = -wo. At the peak, where float32 may cancel, 1 % is allowed
    wo = vector(0, 0, 1)
    cosine = np.concatenate([np.linspace(-1, 1, 101), 1 - np.logspace(-8, -2, 61)])
    cosine = np.concatenate([cosine, -cosine])
    d = np.stack([np.sqrt(1 - cosine**2), 0 * cosine, -cosine], 1).astype(f32)
    g32 = float(f32(g))
    apart = np.sum((d.astype(np.float64) + np.array((0, 0, math.copysign(1, g)))) ** 2, axis=1)
    square = (1 - abs(g32)) ** 2 + abs(g32) * apart
    expected = (1 - g32 * g32) / (4 * math.pi * square**1.5)
    error = np.abs(phase_density(henyey_greenstein(g), wo, d) / expected - 1)
    assert error.max() < 0.01
    assert error[square > 0.1].max() < 1e-3


@pytest.mark.parametrize("g", [-0.99, 0.99])
def test_narrow_phase_function_keeps_its_distribution(g):
    # With x = 1 - |cos| to the peak and s^2 = (1 - |g|)^2 + 2 |g| x, the distribution function is
    # (1 - g^2) / (2 |g|) (1 / (1 - |g|) - 1 / s)
    wo, h = vector(0.3, -0.5, 0.8), abs(g)
    wi = draw_phase(henyey_greenstein(g), wo, SEED, 20_000).astype(np.float64)
    x = np.sum((wi + math.copysign(1, g) * np.array(wo, np.float64)) ** 2, axis=1) / 2
    cdf = (1 - h * h) / (2 * h) * (1 / (1 - h) - 1 / np.sqrt((1 - h) ** 2 + 2 * h * x))
    assert stats.kstest(cdf, stats.uniform.cdf).pvalue > 1e-3 / TESTS


@pytest.mark.parametrize("wo", [vector(0, 0, 1), vector(1, -2, 0.5)])
@pytest.mark.parametrize("degrees", [0.01, 1.0, 60.0, 90.0, 180.0])
def test_cone_is_evenly_filled(wo, degrees):
    # In a cone the cosine is uniform; |wo - wi|^2 / 2 = 1 - cos keeps that visible at any width
    cone = other_phase(Cone(degrees))
    wi = draw_phase(cone, wo, SEED, N)
    x = np.sum((wi.astype(np.float64) - np.array(wo, np.float64)) ** 2, axis=1) / 2
    width = 2 * math.sin(math.radians(degrees) / 2) ** 2
    # float32 unit vectors place the rays of a cone of 0.01 degrees to 1e-3 of its radius
    if degrees > 0.1:
        assert stats.kstest(x / width, stats.uniform.cdf).pvalue > 1e-3 / TESTS
    assert abs((x / width).mean() - 0.5) < 5 / math.sqrt(12 * N)
    values = phase_density(cone, wo, wi)
    assert (values > 0).mean() > 0.999
    assert values.max() == pytest.approx(1 / (2 * math.pi * width), rel=1e-6)
    outside = vector(*(-np.array(wo, np.float64)))
    if degrees < 180:
        assert phase_density(cone, wo, np.array([outside], f32))[0] == 0


# Surfaces

VIEWS = [vector(0, 0, 1), vector(1, 0, 1), vector(1, 1, 0.4), vector(1, 0, 0.02)]


@pytest.mark.parametrize("wo", VIEWS)
def test_lambert(wo):
    n = vector(0, 0, 1)
    check(draw_brdf(None, n, wo, SEED, N), lambda d: brdf_density(None, n, wo, d))


@pytest.mark.parametrize("ggx", [np.bool_(False), np.bool_(True)], ids=["blinn", "ggx"])
@pytest.mark.parametrize("exponent", [0.0, 1.0, 30.0, 1000.0])
@pytest.mark.parametrize("wo", VIEWS)
def test_fresnel_blend(wo, exponent, ggx):
    n = vector(0, 0, 1)
    gloss = packed.Gloss((f32(0.04),) * 3, f32(exponent), ggx)
    bins = {"cosines": 20, "angles": 48, "finer": 28}
    check(draw_brdf(gloss, n, wo, SEED, N), lambda d: brdf_density(gloss, n, wo, d), **bins)


def test_fresnel_blend_around_a_tilted_normal():
    n = vector(-0.3, 0.5, -0.8)
    wo = vector(-0.6, 0.4, -0.5)
    gloss = packed.Gloss((f32(0.5),) * 3, f32(10), np.bool_(False))
    check(draw_brdf(gloss, n, wo, SEED, N), lambda d: brdf_density(gloss, n, wo, d), finer=28)


# Environment map


def packed_map(rotation=None):
    """5 x 7 random texels, one of them bright, one row black."""
    pixels = np.random.default_rng(4).random((5, 7, 3))
    pixels[1, 3] = (30.0, 20.0, 5.0)
    pixels[4] = 0.0
    rotation = {} if rotation is None else {"rotation": rotation}
    light = EnvironmentMap(pixels, **rotation)
    return pack_lights(scene(lights=(light,))).environment


def tilted():
    a, b = np.cos(0.7), np.sin(0.7)
    c, d = np.cos(-1.9), np.sin(-1.9)
    return np.array([[a, -b, 0], [b, a, 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, c, -d], [0, d, c]]
    )


@pytest.mark.parametrize(
    "rotation", [np.eye(3), None, tilted()], ids=["local", "head-up", "tilted"]
)
def test_environment_map(rotation):
    environment = packed_map(rotation)
    drawn = draw_environment(environment, SEED, N)
    directions = drawn[:, :3]
    # Texel edges cut through the bins: a fine midpoint rule leaves an error far below the counts'
    # noise
    bins = {"cosines": 16, "angles": 16, "finer": 64}
    check(directions, lambda d: environment_density(environment, d), **bins)
    # What the sampler says of its directions is what the other two functions say; at a texel's edge
    # the neighbour's density may be found after rounding
    np.testing.assert_allclose(
        drawn[:, 3:6], environment_light(environment, directions), rtol=1e-4, atol=1e-4
    )
    density = environment_density(environment, directions)
    assert np.mean(np.abs(drawn[:, 6] / density - 1) < 1e-4) > 0.9999


def test_environment_map_is_sampled_by_its_radiance():
    # The weight luminance / density is bounded where the bilinear radiance follows its texel's
    # mean, and its mean is the integral of the luminance over the sphere
    environment = packed_map()
    drawn = draw_environment(environment, SEED, N).astype(np.float64)
    luminance = drawn[:, 3:6] @ (0.2126, 0.7152, 0.0722)
    weight = luminance / drawn[:, 6]
    exact = bin_probabilities(
        lambda d: environment_light(environment, d) @ np.array((0.2126, 0.7152, 0.0722))
    ).sum()
    assert abs(weight.mean() - exact) < 5 * weight.std() / math.sqrt(N)
    assert weight.std() < 0.7 * exact
    uniform_std = math.sqrt(
        4 * math.pi * bin_probabilities(
            lambda d: (environment_light(environment, d) @ np.array((0.2126, 0.7152, 0.0722))) ** 2
        ).sum() - exact**2
    )  # fmt: skip
    assert weight.std() < 0.5 * uniform_std


def test_environment_map_looks_where_it_says():
    # Column x of n looks along local (sin phi, 0, -cos phi), phi = 2 pi (x + 1/2) / n; row 0 toward
    # +y
    environment = packed_map(np.eye(3))
    rows, columns, _ = environment.pixels.shape
    j, i = np.mgrid[:rows, :columns]
    theta, phi = np.pi * (j + 0.5) / rows, 2 * np.pi * (i + 0.5) / columns
    d = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), -np.sin(theta) * np.cos(phi)], -1)
    found = environment_light(environment, d.reshape(-1, 3).astype(f32)).reshape(rows, columns, 3)
    np.testing.assert_allclose(found, environment.pixels, rtol=1e-4, atol=1e-4)
    # By default local +y is world +z
    head_up = environment_light(packed_map(), np.array([[0, 0, 1], [0, 0, -1]], f32))
    np.testing.assert_allclose(
        head_up, environment_light(environment, np.array([[0, 1, 0], [0, -1, 0]], f32)), rtol=1e-4
    )
