"""Surfaces of area lights: sampling, density and intersection of each shape.

All shapes are in one table, so that one set of kernels serves this file.
"""

import math

import numpy as np
import pytest
from densities import N, check
from scenes import scene, slab

from vtkmcvr.kernels.grid import INFINITE
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.lights import (
    area_light,
    area_light_distance,
    area_light_pdf,
    area_light_radiance,
    sample_area_light,
)
from vtkmcvr.kernels.rng import start
from vtkmcvr.lights import CylinderLight, DiskLight, RectangleLight, SphereLight, Texture
from vtkmcvr.planning.lights import pack_lights

f32 = np.float32
SEED = np.int64(11)
ORIGIN = (0.0, 0.0, 0.0)
L = (1.0, 2.0, 3.0)
LIGHTS = {
    "rectangle": RectangleLight((0, 0, 1), ORIGIN, (1, 1), L),
    "near rectangle": RectangleLight((0.2, -0.3, 0.1), ORIGIN, (2, 0.5), L),
    "far rectangle": RectangleLight((7, 3, -1), ORIGIN, (1.5, 1.5), L),
    "two-sided rectangle": RectangleLight((0, 0, 1), ORIGIN, (1, 1.2), L, two_sided=True),
    "disk": DiskLight((0.3, 0, 1), ORIGIN, 0.9, L),
    "ring": DiskLight((0, -0.8, 0.6), ORIGIN, 1.1, L, inner_radius=0.6),
    "sphere": SphereLight((0.5, -0.4, 1.0), 0.8, L),
    "two-sided sphere": SphereLight((0.5, -0.4, 0.3), 0.9, L, two_sided=True),
    "cylinder": CylinderLight((-1, -1, 0.5), (1, -1, 0.9), 0.4, L),
    "two-sided cylinder": CylinderLight((0.9, -0.5, 0.5), (0.9, 0.5, 0.5), 0.6, L, two_sided=True),
}
NAMES = list(LIGHTS)


def pack(*lights):
    return pack_lights(scene(slab(), lights=lights)).area_lights


PACKED = pack(*LIGHTS.values())


@entry_point
def draw(lights, index, chance, x, seed, n):
    """Columns: direction (3), distance, radiance over density (3), density."""
    out = np.empty((n, 8), f32)
    for i in range(n):
        light, _ = sample_area_light(lights, index, chance, x, start(seed, i, 0))
        out[i, :3] = light.wi
        out[i, 3] = light.distance
        out[i, 4:7] = light.radiance
        out[i, 7] = light.pdf
    return out


@entry_point
def meet(lights, index, x, directions):
    """Columns: distance, density, radiance (3)."""
    out = np.zeros((len(directions), 5), f32)
    for i in range(len(directions)):
        d = (directions[i, 0], directions[i, 1], directions[i, 2])
        light = area_light(lights.few, lights.many, index)
        out[i, 0] = t = area_light_distance(lights.shapes, light, x, d)
        if t < INFINITE:
            out[i, 1] = area_light_pdf(lights, index, x, d, t)
            out[i, 2:] = area_light_radiance(lights, index, x, d, t)
    return out


def point(*x):
    return tuple(map(f32, x))


def drawn_from(name, x=ORIGIN, n=N, chance=1.0, lights=PACKED):
    return draw(lights, NAMES.index(name), f32(chance), point(*x), SEED, n)


def density_from(name, x=ORIGIN):
    return lambda d: meet(PACKED, NAMES.index(name), point(*x), d)[:, 1]


FROM_HERE = [(name, ORIGIN) for name in NAMES]
FROM_ELSEWHERE = [
    ("near rectangle", (0.9, 0.2, -0.05)),
    ("two-sided rectangle", (0.2, 0.1, 1.5)),
    ("disk", (1.0, 0.3, 0.4)),
    ("cylinder", (0.1, -0.5, 0.4)),
    ("two-sided cylinder", (0.4, 1.0, 0.9)),
    ("two-sided sphere", (0.5, 1.0, 0.3)),
]


@pytest.mark.parametrize(
    ("name", "x"), [pair for pair in FROM_HERE + FROM_ELSEWHERE if "cylinder" not in pair[0]]
)
def test_directions_follow_their_density(name, x):
    bins = {"cosines": 24, "angles": 24, "finer": 80}
    check(drawn_from(name, x)[:, :3], density_from(name, x), **bins)


@pytest.fixture(scope="module")
def sphere():
    """Even directions."""
    d = np.random.default_rng(9).normal(size=(1_000_000, 3))
    return (d / np.linalg.norm(d, axis=1)[:, None]).astype(f32)


@pytest.mark.parametrize(("name", "x"), FROM_HERE + FROM_ELSEWHERE)
def test_integrals_over_what_is_seen(name, x, sphere):
    """Mean of g / density over samples = integral of g over the solid angle, for moments g.

    Unlike binning this also serves cylinders, whose density has no bound at their outline.
    """
    drawn = drawn_from(name, x).astype(np.float64)
    met = meet(PACKED, NAMES.index(name), point(*x), drawn[:, :3].astype(f32))
    # Points that the light itself hides are drawn too; the shadow ray rejects them
    seen = (met[:, 0] > drawn[:, 3] * (1 - 1e-4)) & (drawn[:, 7] > 0)
    hidden = 1 - seen.sum() / (drawn[:, 7] > 0).sum()
    assert hidden > 0.01 if name == "two-sided cylinder" else hidden < 2e-4
    weight = np.where(seen, 1 / np.maximum(drawn[:, 7], 1e-30), 0)
    shining = meet(PACKED, NAMES.index(name), point(*x), sphere)[:, 1] > 0
    for g in (
        lambda d: 1 + 0 * d[:, 0],
        *(lambda d, k=k: d[:, k] ** 2 + d[:, k] for k in range(3)),
    ):
        ours, even = g(drawn[:, :3]) * weight, g(sphere) * shining * 4 * math.pi
        error = math.hypot(ours.std() / math.sqrt(N), even.std() / math.sqrt(len(even)))
        # 64 comparisons: chance exceeds 5.2 once in 1e5 choices of seeds
        assert abs(ours.mean() - even.mean()) < 5.2 * error + 1e-5


def test_a_wrong_density_is_noticed():
    drawn = drawn_from("disk")
    right = density_from("disk")

    def wrong(d):
        # Uniform in solid angle instead of over the area
        p = right(d)
        return np.where(p > 0, 1 / 1.98, 0).astype(f32)

    with pytest.raises(AssertionError):
        check(drawn[:, :3], wrong, cosines=24, angles=24, finer=80)


@pytest.mark.parametrize("name", NAMES)
def test_sample_density_and_ray_agree(name):
    drawn = drawn_from(name, n=5000)
    lit = drawn[:, 7] > 0
    assert lit.mean() > 0.3
    met = meet(PACKED, NAMES.index(name), point(*ORIGIN), drawn[lit, :3])
    seen = met[:, 0] > drawn[lit, 3] * (1 - 1e-4)
    # Directions that round to past the edge are missed
    hit = seen & (met[:, 0] < INFINITE)
    assert hit.sum() > 0.999 * seen.sum()
    np.testing.assert_allclose(met[hit, 0], drawn[lit][hit, 3], rtol=2e-3)
    close = np.abs(met[hit, 1] / drawn[lit][hit, 7] - 1) < 2e-3
    assert close.mean() > 0.99
    np.testing.assert_allclose(
        drawn[lit][:, 4:7] * drawn[lit][:, 7:8], np.tile(L, (lit.sum(), 1)), rtol=1e-5
    )
    # The chance of the light's choice is part of the density
    np.testing.assert_allclose(drawn_from(name, n=5000, chance=0.25)[:, 7], 0.25 * drawn[:, 7])


def rectangle_solid_angle(a, b, h):
    return 4 * math.asin(a * b / math.sqrt((a * a + h * h) * (b * b + h * h)))


def disk_solid_angle(r, h):
    return 2 * math.pi * (1 - h / math.hypot(h, r))


DISTANCES = [1e-3, 0.3, 1.0, 30.0, 3e4]


@pytest.mark.parametrize("h", DISTANCES)
def test_density_integrates_the_solid_angle(h):
    # The mean of 1 / density over the samples is the solid angle; its error is below 5 sigma
    cases = [
        (RectangleLight((0, 0, h), ORIGIN, (1, 0.5)), rectangle_solid_angle(0.5, 0.25, h)),
        (DiskLight((0, 0, h), ORIGIN, 0.5), disk_solid_angle(0.5, h)),
        (
            DiskLight((0, 0, h), ORIGIN, 0.5, inner_radius=0.4),
            disk_solid_angle(0.5, h) - disk_solid_angle(0.4, h),
        ),
        (
            SphereLight((0, 0, 0.5 + h), 0.5),
            disk_solid_angle(1.0, math.sqrt((1 + h / 0.5) ** 2 - 1)),
        ),
    ]
    lights = pack(*(light for light, _ in cases), CylinderLight((9, 9, 9), (9, 9, 8), 1))
    for index, (_, solid_angle) in enumerate(cases):
        pdf = draw(lights, index, f32(1), point(*ORIGIN), SEED, N)[:, 7].astype(np.float64)
        assert (pdf > 0).all()
        sigma = (1 / pdf).std() / math.sqrt(N)
        # 1e-3 mm from a disk of 0.5 mm nearly all of its area is so oblique that few samples count
        if sigma < 0.05 * solid_angle:
            assert abs((1 / pdf).mean() - solid_angle) < 5 * sigma + 2e-5 * solid_angle
        else:
            assert index in (1, 2)
            assert h < 0.01
        if index in (0, 3) and h < 2:
            # Drawn by solid angle: nothing varies
            assert np.ptp(1 / pdf) < 1e-4 * solid_angle


@pytest.mark.parametrize("radius", [1e-6, 1e-3])
def test_tiny_sphere_keeps_its_solid_angle(radius):
    lights = pack(SphereLight((0.6, 0, 0.8), radius, L))
    drawn = draw(lights, 0, f32(1), point(*ORIGIN), SEED, 1000)
    np.testing.assert_allclose(1 / drawn[:, 7].astype(float), math.pi * radius**2, rtol=1e-5)
    assert np.abs(drawn[:, :3] - (0.6, 0, 0.8)).max() < radius + 1e-6


def test_nothing_is_drawn_from_where_no_light_goes():
    dark = {
        "rectangle": [(2.0, 0.0, 1.0), (0.2, 0.1, 3.0)],
        "disk": [(0.3, 0.0, 2.0)],
        "sphere": [(0.5, -0.4, 1.0), (0.6, -0.3, 1.1)],
        "cylinder": [(0.0, -1.0, 0.7)],
    }
    for name, places in dark.items():
        for x in places:
            drawn = drawn_from(name, x, n=200)
            assert np.isfinite(drawn).all()
            rate = np.mean(drawn[:, 7] > 0)
            assert rate < 0.02
            if rate == 0:
                assert not drawn[:, 4:8].any()


def test_points_on_and_beside_every_surface_stay_finite():
    rng = np.random.default_rng(5)
    for name, light in LIGHTS.items():
        for patch in light.patches:
            points, normals, _ = patch.quadrature(8)
            for p, n in zip(points[::7], normals[::7], strict=True):
                for off in (0.0, 1e-7, -1e-4):
                    drawn = drawn_from(name, p + off * n, n=20)
                    assert np.isfinite(drawn).all()
                    assert (drawn[:, 7] >= 0).all()
                    d = rng.normal(size=(20, 3))
                    d = (d / np.linalg.norm(d, axis=1)[:, None]).astype(f32)
                    assert np.isfinite(meet(PACKED, NAMES.index(name), point(*p), d)).all()


def test_texture_is_seen_upright_and_unmirrored():
    # Texels numbered from the upper left; seen from the front the first is there
    pixels = np.arange(1.0, 13.0).reshape(3, 4)
    texture = Texture(pixels)
    panel = RectangleLight((0, 4, 0), ORIGIN, (4, 3), texture=texture)
    globe = SphereLight((0, 4, 0), 1.0, texture=texture)
    tube = CylinderLight((0, 4, -1.5), (0, 4, 1.5), 1.0, texture=texture)
    lights = pack(panel, globe, tube, DiskLight((9, 9, 9), ORIGIN, 1))
    # The viewer looks along +y with z up: x to the right
    x, z = np.meshgrid(np.arange(4) - 1.5, 1.0 - np.arange(3))
    d = np.stack([x, np.full(x.shape, 4.0), z], -1).reshape(-1, 3)
    d = (d / np.linalg.norm(d, axis=1)[:, None]).astype(f32)
    seen = meet(lights, 0, point(*ORIGIN), d)
    np.testing.assert_allclose(seen[:, 2].reshape(3, 4), pixels, rtol=1e-4)
    # Round lights: rows from top to bottom, columns growing to the right
    for index in (1, 2):
        d = np.array([[0, 3, 0.7], [0, 3, -0.7], [-0.3, 3.02, 0], [0.3, 3.02, 0]])
        d = (d / np.linalg.norm(d, axis=1)[:, None]).astype(f32)
        top, bottom, left, right = meet(lights, index, point(*ORIGIN), d)[:, 2]
        assert top < bottom - 3
        assert left < right


@pytest.mark.parametrize("name", NAMES)
def test_a_few_lights_are_those_of_a_table(name):
    """As values and as rows of a table they are the same, in whatever place."""
    black = [SphereLight((20 + i, 0, 0), 0.1, L) for i in range(3)]
    for before in (0, 1, 3):
        few = pack(*black[:before], LIGHTS[name])
        assert few.many is None and PACKED.few is None
        ours = draw(few, before, f32(0.3), point(*ORIGIN), SEED, 2000)
        theirs = draw(PACKED, NAMES.index(name), f32(0.3), point(*ORIGIN), SEED, 2000)
        # Machine code of other shapes, which rounds otherwise
        lit = theirs[:, 7] > 0
        np.testing.assert_array_equal(lit, ours[:, 7] > 0)
        np.testing.assert_allclose(ours[lit], theirs[lit], rtol=1e-3, atol=1e-6)
        met = [
            meet(lights, i, point(*ORIGIN), theirs[lit][:, :3])
            for lights, i in ((few, before), (PACKED, NAMES.index(name)))
        ]
        # At the outline of a tube densities are as large as rounding has it: their inverses agree
        for rows in met:
            rows[:, 1] = 1 / np.maximum(rows[:, 1], 1e-6)
        np.testing.assert_allclose(*met, rtol=1e-3, atol=1e-3)
