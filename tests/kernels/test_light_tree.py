"""The tree over all lights: chances of being chosen, and what a ray meets.

z-scores and p-values are bounded so that chance fails less than 1e-3 of all choices of seeds.
"""

import math

import numpy as np
import pytest
from densities import p_value
from scenes import scene, slab

from vtkmcvr.kernels.grid import INFINITE
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.light_tree import choose_light, importance, light_chance, node
from vtkmcvr.kernels.lights import (
    area_light,
    area_light_distance,
    delta_sample,
    nearest_light,
    sample_area_light,
    sample_light,
    sample_map,
)
from vtkmcvr.kernels.rng import start
from vtkmcvr.lights import (
    BoxLight,
    CylinderLight,
    DirectionalLight,
    DiskLight,
    EnvironmentMap,
    PointLight,
    RectangleLight,
    SphereLight,
)
from vtkmcvr.planning.lights import pack_lights

f32 = np.float32
SEED = np.int64(3)


def light_of_kind(k, place, target, size, L):
    return [
        lambda: RectangleLight(place, target, (size, 2 * size), L),
        lambda: RectangleLight(place, target, (size, size), L, two_sided=True),
        lambda: DiskLight(place, target, size, L),
        lambda: SphereLight(place, size, L),
        lambda: CylinderLight(place, target, size, L),
        lambda: BoxLight(place, (size, size, size), L),
        lambda: PointLight(place, L),
        lambda: PointLight(place, L, (1, 0, 0)),
        lambda: PointLight(place, L, direction=target, cone_angle=25),
        lambda: PointLight(place, L, direction=target, cone_angle=70, exponent=3),
        lambda: DirectionalLight(target, L),
        lambda: RectangleLight(place, target, (size, size), 0.0),
    ][k % 12]()


def many_lights(n=40, seed=2):
    """Lights of every kind around and inside the volume, of very different brightness."""
    rng = np.random.default_rng(seed)
    lights = [EnvironmentMap(rng.random((2, 3, 3)))]
    for k in range(n):
        place, target = rng.normal(size=3) * rng.choice([0.5, 3, 30]), rng.normal(size=3)
        size, L = rng.uniform(0.05, 1), float(rng.choice([0.1, 1, 50]))
        lights.append(light_of_kind(k, place, target, size, L))
    return lights


def pack(lights):
    return pack_lights(scene(slab(), lights=lights))


@pytest.fixture(scope="module")
def packed():
    return pack(many_lights())


@entry_point
def chances(lights, x, on_surface, normal, n):
    out = np.zeros(n, f32)
    for i in range(n):
        out[i] = light_chance(lights, i, x, on_surface, normal)
    return out


@entry_point
def choices(lights, x, on_surface, normal, seed, n):
    out = np.empty(n, np.int64)
    chance = np.empty(n, f32)
    for k in range(n):
        out[k], chance[k], _ = choose_light(lights, x, on_surface, normal, start(seed, k, 0))
    return out, chance


@entry_point
def estimates(tree, x, on_surface, normal, n):
    out = np.zeros(n, f32)
    for i in range(n):
        out[i] = importance(node(tree, np.int64(tree.leaf[i])), x, on_surface, normal)
    return out


@entry_point
def contributions(choice, lights, area, delta, environment, x, on_surface, normal, only, seed, n):
    """Columns: light arriving (sum of RGB over density), cosine at the surface.

    From all lights, or from the light `only` alone.
    """
    out = np.empty((n, 2), f32)
    count, one = area.number, f32(1)
    for k in range(n):
        rng = start(seed, k, 0)
        if only < 0:
            light, _ = sample_light(
                choice, lights, area, delta, environment, x, on_surface, normal, rng
            )
        elif only < count:
            light, _ = sample_area_light(area, only, one, x, rng)
        elif only < lights.number - 1:
            light = delta_sample(delta, only - count, one, x)
        else:
            light, _ = sample_map(environment, one, rng)
        out[k, 0] = light.radiance[0] + light.radiance[1] + light.radiance[2]
        out[k, 1] = light.wi[0] * normal[0] + light.wi[1] * normal[1] + light.wi[2] * normal[2]
    return out


@entry_point
def nearest(lights, area, o, directions, for_camera):
    out = np.empty((len(directions), 2), np.float64)
    for k in range(len(directions)):
        d = (directions[k, 0], directions[k, 1], directions[k, 2])
        out[k, 0], out[k, 1] = nearest_light(lights, area, o, d, for_camera)
    return out


@entry_point
def nearest_of_all(area, o, directions):
    out = np.empty((len(directions), 2), np.float64)
    for k in range(len(directions)):
        d = (directions[k, 0], directions[k, 1], directions[k, 2])
        best, index = INFINITE, -1
        for i in range(area.number):
            light = area_light(area.few, area.many, i)
            t = area_light_distance(area.shapes, light, o, d)
            if t < best:
                best, index = t, i
        out[k, 0], out[k, 1] = index, best
    return out


def unit(rng):
    v = rng.normal(size=3)
    return tuple(map(f32, v / np.linalg.norm(v)))


def places(n, seed=7):
    """Points in and around the volume, with normals."""
    rng = np.random.default_rng(seed)
    for i in range(n):
        x = rng.normal(size=3) * (0.4 if i % 2 else 2.0)
        yield tuple(map(f32, x)), bool(i % 3), unit(rng)


def test_chances_of_all_lights_sum_to_one(packed):
    # But for clusters that may reach x, of which no light does
    n, full = packed.all_lights.number, 0
    for x, on_surface, normal in places(200):
        total = chances(packed.all_lights, x, on_surface, normal, n).sum()
        _, chance = choices(packed.all_lights, x, on_surface, normal, SEED, 1000)
        dead = max(1 - total, 0)
        # Binomial; 4.5 standard errors in 200 places are exceeded once in 700 choices of seeds
        error = np.sqrt(max(dead * (1 - dead), 2e-3) / 1000)
        assert abs(np.mean(chance == 0) - dead) < 1e-5 + 4.5 * error
        full += total > 0.95
    assert full > 150


@pytest.mark.parametrize("on_surface", [False, True])
def test_lights_are_chosen_as_often_as_is_said(packed, on_surface):
    n, draws = packed.all_lights.number, 100_000
    for x, _, normal in places(8):
        expected = chances(packed.all_lights, x, on_surface, normal, n).astype(float)
        found, chance = choices(packed.all_lights, x, on_surface, normal, SEED, draws)
        some = chance > 0
        np.testing.assert_allclose(chance[some], expected[found[some]], rtol=1e-4)
        counts = np.append(np.bincount(found[some], minlength=n), draws - some.sum())
        expected = draws * np.append(expected, max(1 - expected.sum(), 0))
        assert p_value(counts, expected) > 1e-3 / 20


def sent(p, x, on_surface, normal, only=-1, n=200):
    """Irradiance (or fluence) estimates at x."""
    rows = contributions(
        p.choice, p.all_lights, p.area_lights, p.delta_lights, p.environment,
        x, on_surface, normal, only, SEED, n,
    ).astype(float)  # fmt: skip
    return rows[:, 0] * (np.maximum(rows[:, 1], 0) if on_surface else 1)


def test_whatever_sends_light_is_estimated_to_do_so(packed):
    n, found = packed.all_lights.number, 0
    for x, on_surface, normal in places(30):
        estimate = estimates(packed.all_lights.tree, x, on_surface, normal, n)
        for i in range(n):
            light = sent(packed, x, on_surface, normal, i)
            # What comes from within rounding of the horizon may be left to the even share
            assert estimate[i] > 0 or light.max() <= 2e-3 * max(packed.all_lights.tree.flux)
            found += light.max() > 0
    assert found > 500


def few_lights():
    """Three, of which kernels ask each and a black one beside them."""
    return pack([
        RectangleLight((0, 1.5, 2), (0, 0, 0), (1, 1), 3.0), PointLight((2, 0, 0), 0.5),
        EnvironmentMap(np.ones((1, 1, 3)) * 0.1),
    ])  # fmt: skip


@pytest.mark.parametrize("on_surface", [False, True])
def test_a_few_lights_are_chosen_as_often_as_is_said(on_surface):
    lights, draws = few_lights().all_lights, 100_000
    assert lights.tree is None and len(lights.few) == 4
    for x, _, normal in places(8):
        expected = chances(lights, x, on_surface, normal, 3).astype(float)
        # The map reaches every place
        assert expected.sum() == pytest.approx(1, abs=1e-5)
        found, chance = choices(lights, x, on_surface, normal, SEED, draws)
        np.testing.assert_allclose(chance, expected[found], rtol=1e-4)
        counts = np.bincount(found, minlength=3)
        assert len(counts) == 3
        assert p_value(counts, draws * expected / expected.sum()) > 1e-3 / 16


def test_choice_among_a_few_is_unbiased():
    p = few_lights()
    for x, on_surface, normal in places(8, seed=1):
        mean, _, total, _, error = compare(p, x, on_surface, normal)
        assert abs(mean - total) < 4.5 * error


def test_no_light_is_chosen_where_none_reaches():
    # Beside the even share, which takes a tenth of the draws
    lights = pack([RectangleLight((0, 0, 2), (0, 0, 9), (1, 1), 3.0)]).all_lights
    x, normal = (f32(0), f32(0), f32(0)), (f32(0), f32(0), f32(1))
    assert chances(lights, x, True, normal, 1)[0] == pytest.approx(0.1)
    found, chance = choices(lights, x, True, normal, SEED, 10_000)
    assert not found.any()
    # Binomial: 4.5 standard deviations
    assert abs(np.mean(chance > 0) - 0.1) < 4.5 * math.sqrt(0.09 / 10_000)


def moments(light):
    return light.mean(), light.var()


def compare(packed, x, on_surface, normal, n=100_000):
    """Mean and variance with the tree; the same for the sum over all lights chosen evenly."""
    mean, variance = moments(sent(packed, x, on_surface, normal, n=n))
    count = packed.all_lights.number
    alone = [moments(sent(packed, x, on_surface, normal, i, n // 10)) for i in range(count)]
    total = sum(m for m, _ in alone)
    even = count * sum(v + m * m for m, v in alone) - total**2
    error = math.sqrt((variance + 10 * sum(v for _, v in alone)) / n)
    return mean, variance, total, even, error


def test_choice_is_unbiased_and_better_than_an_even_one(packed):
    # Points among the lights, which lie at distances of 0.5 to 30: inside of most clusters. Without
    # `LightTree.within` the first has 6 times the variance of an even choice, the fourth 13 times.
    for x, on_surface, normal in places(8, seed=1):
        mean, variance, total, even, error = compare(packed, x, on_surface, normal)
        assert abs(mean - total) < 4.5 * error
        assert variance < 0.5 * even


def test_choice_among_lights_around_a_volume_is_better_than_an_even_one():
    rng = np.random.default_rng(4)
    lights = [EnvironmentMap(np.ones((1, 1, 3)) * 0.01), PointLight((0, 0, 3), 0.1)]
    for _ in range(62):
        place = rng.normal(size=3)
        place *= rng.uniform(1.5, 4) / np.linalg.norm(place)
        lights.append(DiskLight(place, (0, 0, 0), 0.2, float(rng.choice([0.2, 1, 5]))))
    # One of each shape, so that the kernels are those of the other tests
    lights += [SphereLight((9, 9, 9), 1e-3), CylinderLight((9, 9, 8), (9, 8, 8), 1e-3)]
    lights.append(RectangleLight((0.4, 0.4, 0.4), (1, 1, 1), (1e-6, 1e-6), 1e-6))
    p = pack(lights)
    gains = []
    for x, on_surface, normal in places(16, seed=5):
        x = tuple(f32(0.2) * v for v in x)
        mean, variance, total, even, error = compare(p, x, on_surface, normal)
        assert abs(mean - total) < 4.5 * error
        gains.append(even / variance)
    assert np.median(gains) > 1.8


def test_tree_finds_the_light_that_a_ray_meets(packed):
    area = packed.area_lights
    met = 0
    for x, _, _ in places(20):
        d = np.random.default_rng(1).normal(size=(2000, 3))
        d = (d / np.linalg.norm(d, axis=1)[:, None]).astype(f32)
        ours, all_ = nearest(packed.all_lights, area, x, d, False), nearest_of_all(area, x, d)
        np.testing.assert_array_equal(ours[:, 0], all_[:, 0])
        np.testing.assert_allclose(ours[:, 1], all_[:, 1], rtol=1e-4)
        met += (ours[:, 0] >= 0).sum()
        assert (nearest(packed.all_lights, area, x, d, True)[:, 0] == -1).all()
    assert met > 1000


def test_depth_grows_with_the_logarithm_of_the_number_of_lights():
    rng = np.random.default_rng(0)
    for n in (5, 6, 64, 1000):
        lights = [PointLight(tuple(p)) for p in rng.normal(size=(n, 3))]
        tree = pack(lights).all_lights.tree
        links, depth = tree.links, 0
        for k in tree.leaf:
            steps = 0
            while k > 0:
                k, steps = links[k, 1], steps + 1
            depth = max(depth, steps)
        assert len(links) == 2 * n - 1
        assert depth <= 2 * np.ceil(np.log2(n))


def numbers(part):
    """All numbers of a packed tuple."""
    if isinstance(part, tuple):
        return [x for inner in part for x in numbers(inner)]
    return [] if part is None else np.ravel(part).astype(float).tolist()


def test_lights_that_coincide_are_one():
    for light in (
        RectangleLight((0, 0, 3), (0, 0, 0), (1, 1), (1.0, 2.0, 3.0)),
        PointLight((1, 2, 3), (1.0, 2.0, 3.0), cone_angle=30),
        DirectionalLight((1, 2, 3), (1.0, 2.0, 3.0)),
        SphereLight((1, 2, 3), 1, (1.0, 2.0, 3.0)),
    ):
        one, many = pack([light]), pack([light.with_brightness(np.array(light.brightness) / 8)] * 8)
        assert "7 lights coincide" in many.notes[0]
        assert one.notes == ()
        for name in ("area_lights", "delta_lights", "all_lights"):
            a, b = numbers(getattr(one, name)), numbers(getattr(many, name))
            np.testing.assert_allclose(a, b, rtol=1e-6)
