"""Direct light: three estimators of one integral, and what blocks light.

All scenes have the same set of effects (`scenes.everything`), so that one kernel serves this file.
Seeds are fixed; z-scores are compared with 4.5, which by Bonferroni over the (fewer than 60)
comparisons of this file chance exceeds for less than 60 x 6.8e-6 = 4e-4 of all choices of seeds.
"""

import math

import numpy as np
import pytest
from scenes import blob, everything, frontal, mean_and_error, medium, render, volume, z_score

from vtkmcvr.lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    PointLight,
    RectangleLight,
)
from vtkmcvr.scene import HenyeyGreenstein, Surface

# Off the world's origin, so that a forgotten centre shows (HC-36)
CENTRE = (12.0, -7.0, 3.0)
BLOB = blob(centre=CENTRE)
SURFACE = Surface(mode="brdf", specular=0.3, exponent=40.0)


def near(x, y, z):
    """World position relative to the blob's centre."""
    return tuple(np.add(CENTRE, (x, y, z)))


def rectangle(place=(1.5, -1.5, 1.5), size=(1.5, 1.0), radiance=1.0, **options):
    return RectangleLight(near(*place), CENTRE, size, radiance, **options)


def panorama():
    pixels = np.random.default_rng(3).random((6, 10, 3)) ** 2
    pixels[1, 4] = 20.0
    return EnvironmentMap(pixels)


AREA_LIGHTS = {
    "rectangle": rectangle(),
    "near rectangle": rectangle((0.0, -1.3, 0.2), (2.0, 2.0)),
    "inside": rectangle((0.1, -0.2, 0.1), (0.6, 0.6), two_sided=True),
    "map": panorama(),
}


def lit(*lights, seed=1, samples=64, vol=BLOB, size=(16, 16), **options):
    return render(everything(*lights, vol=vol, size=size, **options), samples, seed)


@pytest.mark.parametrize("surface", [None, SURFACE], ids=["phase", "brdf"])
@pytest.mark.parametrize("name", AREA_LIGHTS)
def test_three_estimators_agree(name, surface):
    light = AREA_LIGHTS[name]
    by_light, by_scatter, mis = (
        lit(light, surface=surface, light_sampling=kind, seed=seed, samples=samples)
        for seed, (kind, samples) in enumerate([("light", 128), ("scatter", 512), ("mis", 128)])
    )
    assert mean_and_error(mis)[0] > 0
    assert abs(z_score(by_light, mis)) < 4.5
    assert abs(z_score(by_scatter, mis)) < 4.5
    assert abs(z_score(by_light, by_scatter)) < 4.5


@pytest.mark.parametrize("surface", [None, SURFACE], ids=["phase", "brdf"])
@pytest.mark.parametrize("name", AREA_LIGHTS)
def test_multiple_importance_sampling_is_never_the_worst(name, surface):
    light = AREA_LIGHTS[name]
    variance = {
        kind: mean_and_error(lit(light, surface=surface, light_sampling=kind, samples=128))[1] ** 2
        for kind in ("light", "scatter", "mis")
    }
    assert variance["mis"] <= max(variance["light"], variance["scatter"])


@pytest.mark.parametrize("surface", [None, SURFACE], ids=["phase", "brdf"])
@pytest.mark.parametrize(
    "light",
    [
        DirectionalLight((-1, 1, -1)),
        PointLight(near(1, -2, 1), 3.0),
        PointLight(near(1, -2, 1), 3.0, (1, 0.5, 0), near(-1, 2, -1), cone_angle=30, exponent=2),
    ],
    ids=["directional", "point", "spot"],
)
def test_delta_lights_are_found_by_light_sampling_alone(light, surface):
    by_light = lit(light, surface=surface, light_sampling="light", seed=2)
    mis = lit(light, surface=surface, seed=3)
    assert mean_and_error(mis)[0] > 0
    assert abs(z_score(by_light, mis)) < 4.5
    assert not lit(light, surface=surface, light_sampling="scatter").radiance.max() > 1e-9


@pytest.mark.parametrize("surface", [None, SURFACE], ids=["phase", "brdf"])
def test_constant_environment_is_a_map_of_constant_pixels(surface):
    constant = lit(ConstantEnvironment(0.7), surface=surface, seed=4)
    pixels = np.full((5, 9, 3), 0.35)
    for kind in ("light", "scatter", "mis"):
        same = lit(EnvironmentMap(pixels, scale=2.0), surface=surface, seed=5, light_sampling=kind)
        assert abs(z_score(constant, same)) < 4.5


def test_light_of_all_kinds_adds_up():
    lights = [
        ConstantEnvironment(0.3), panorama(), rectangle(), PointLight(near(1, -2, 1), 3.0),
    ]  # fmt: skip
    together = mean_and_error(lit(*lights, surface=SURFACE, seed=6, samples=256))
    alone = [
        mean_and_error(lit(light, surface=SURFACE, seed=7 + i, samples=128))
        for i, light in enumerate(lights)
    ]
    # The rectangle blocks the others' light too
    shaded = [
        mean_and_error(
            lit(light, rectangle(radiance=0.0), surface=SURFACE, seed=17 + i, samples=128)
        )
        for i, light in enumerate(lights)
        if light is not lights[2]
    ]
    total = alone[2][0] + sum(mean for mean, _ in shaded)
    error = math.sqrt(together[1] ** 2 + alone[2][1] ** 2 + sum(e**2 for _, e in shaded))
    assert abs(together[0] - total) < 4.5 * error


@pytest.mark.parametrize("surface", [None, SURFACE], ids=["phase", "brdf"])
@pytest.mark.parametrize("kind", ["light", "mis"])
def test_one_rectangle_is_its_tiles(surface, kind):
    # 1, 2 x 1 and 2 x 4 tiles of the same radiance fill the same rectangle
    whole = rectangle((0.0, -1.5, 1.5), (2.0, 1.0))
    right, up, _ = whole.frame
    pictures = []
    for seed, (m, n) in enumerate([(1, 1), (2, 1), (2, 4)]):
        tiles = []
        for i in range(m):
            for j in range(n):
                shift = ((i + 0.5) / m - 0.5) * 2.0 * right + ((j + 0.5) / n - 0.5) * 1.0 * up
                centre = np.add(whole.centre, shift)
                target = np.add(whole.target, shift)
                tiles.append(RectangleLight(centre, target, (2.0 / m, 1.0 / n)))
        pictures.append(lit(*tiles, surface=surface, seed=seed, light_sampling=kind, samples=128))
    assert abs(z_score(pictures[0], pictures[1])) < 4.5
    assert abs(z_score(pictures[0], pictures[2])) < 4.5


def test_rectangle_shines_with_its_form_factor():
    # A tiny isotropic medium at distance h under a square of edge 2a, without attenuation: L is
    # alpha times the square's solid angle over 4 pi. Over the medium, 0.02 wide, that varies by
    # less than (0.01/h)^2 = 1e-4; g = 0.002 by less than 0.6 %, by symmetry of the square hardly at
    # all
    a, h = 0.5, 1.0
    values = np.ones((3, 3, 3), np.float32)
    values[0, 0, 0] = 0.9999  # with a gradient, so that the set of effects stays the same
    nearly_even = volume(values, (0.01,) * 3)
    light = RectangleLight((0, 0, h), (0, 0, 0), (2 * a, 2 * a))
    for kind in ("light", "scatter", "mis"):
        picture = lit(
            light, vol=nearly_even, phase=HenyeyGreenstein(0.002), camera=frontal(0.009),
            transfer=medium(50.0), light_sampling=kind, shadow_reach=1e-9, samples=256,
        )  # fmt: skip
        mean, error = mean_and_error(picture)
        solid_angle = 4 * math.asin(a**2 / (a**2 + h**2))
        expected = -math.expm1(-50 * 0.02) * solid_angle / (4 * math.pi)
        assert error < 0.03 * expected
        assert abs(mean - expected) < 4.5 * error + 2e-4 * expected


def test_directional_light_on_a_plane():
    # Opaque ramp, normal along -y, light at 60 degrees to it, no shadows. The extinction is so high
    # that everything happens at the face; there alpha is 1 and the gradient constant
    y = np.linspace(1, 2, 9, dtype=np.float32)
    values = np.broadcast_to(y[None, :, None], (9, 9, 9))
    vol = volume(values, (0.25,) * 3)
    light = DirectionalLight((math.sin(math.pi / 3), math.cos(math.pi / 3), 0), 2.0)
    picture = lit(
        light, vol=vol, surface=Surface(mode="brdf", specular=1e-6, exponent=1.0),
        shadow_reach=1e-9, transfer=medium(200.0, 0.6), camera=frontal(0.9), samples=16,
    )  # fmt: skip
    # The blend's body under a coat that is nearly black
    body = 28 / (23 * math.pi) * (1 - 0.75**5) * (1 - 0.5**5)
    # The chance of the light is divided out, but picking another (dark) one leaves noise
    mean, error = mean_and_error(picture)
    assert abs(mean - 0.6 * body * 2.0 * 0.5) < 4.5 * error + 1e-5


@pytest.mark.parametrize("surface", [None, SURFACE], ids=["phase", "brdf"])
@pytest.mark.parametrize("toward", [-1, 1], ids=["dark side up", "bright side up"])
def test_rectangle_casts_a_shadow_with_either_side(surface, toward):
    sun = DirectionalLight((0, 0, -1))
    x, y, z = near(-1, 0, 2)
    roof = RectangleLight((x, y, z), (x, y, z + toward), (2.0, 4.0), 0.0, up=(0, 1, 0))
    floor = RectangleLight(near(0, 0, -9), CENTRE, (2.0, 4.0), 0.0, up=(0, 1, 0))
    free = lit(sun, floor, surface=surface, seed=1).radiance[..., 1]
    shaded = lit(sun, roof, surface=surface, seed=1).radiance[..., 1]
    left, right = np.s_[:, :8], np.s_[:, 8:]
    assert free[left].mean() > 1e-3
    assert shaded[left].max() < 1e-9
    # Same seed, same choice among lights: the other half is not touched
    np.testing.assert_allclose(shaded[right], free[right], rtol=1e-5, atol=1e-12)


def test_rectangle_blocks_the_environment_and_other_rectangles():
    roof = RectangleLight(near(0, 0, 1.2), near(0, 0, 2), (9.0, 9.0), 0.0, up=(0, 1, 0))
    lamp = RectangleLight(near(0, 0, 3), CENTRE, (1.0, 1.0), 5.0, up=(0, 1, 0))
    sky = np.zeros((2, 4, 3))
    sky[0] = 1.0
    for light in (lamp, EnvironmentMap(sky)):
        for kind in ("light", "scatter", "mis"):
            dark = lit(light, roof, light_sampling=kind, samples=16).radiance
            # 9 wide at 0.3 above the ball: light from above the horizon, bilinear at the horizon's
            # edge
            free = lit(light, light_sampling=kind, samples=16).radiance
            assert dark.mean() < (1e-9 if light is lamp else 0.5 * free.mean())
            assert free.mean() > 1e-4


def test_rectangle_shines_from_its_bright_side_only():
    away = RectangleLight(near(0, 0, 2), near(0, 0, 3), (1.0, 1.0), up=(0, 1, 0))
    both = RectangleLight(near(0, 0, 2), near(0, 0, 3), (1.0, 1.0), up=(0, 1, 0), two_sided=True)
    facing = RectangleLight(near(0, 0, 2), CENTRE, (1.0, 1.0), up=(0, 1, 0))
    for kind in ("light", "scatter", "mis"):
        assert lit(away, light_sampling=kind).radiance.max() < 1e-9
        pair = (lit(light, light_sampling=kind, seed=s) for s, light in enumerate((both, facing)))
        assert abs(z_score(*pair)) < 4.5


@pytest.mark.parametrize("kind", ["light", "mis"])
def test_two_sided_rectangle_seen_edge_on_from_the_centre(kind):
    # Its plane holds the volume's centre, where its irradiance vanishes; elsewhere it shines
    x, y, z = near(1.2, 0, 0)
    light = RectangleLight((x, y, z), (x, y, z + 1), (0.4, 1.0), up=(0, 1, 0), two_sided=True)
    mis = lit(light, light_sampling=kind, seed=1, samples=128)
    by_scatter = lit(light, light_sampling="scatter", seed=2, samples=512)
    assert abs(z_score(mis, by_scatter)) < 4.5


@pytest.mark.parametrize(
    ("visible", "two_sided", "toward", "seen"),
    [(False, False, -1, None), (True, False, -1, 2.5), (True, False, 1, 0.0), (True, True, 1, 2.5)],
)
def test_camera_sees_a_visible_rectangle_before_the_volume(visible, two_sided, toward, seen):
    # Covers the left half of the view, between camera and volume (HC-45)
    x, y, z = near(-1, -2, 0)
    light = RectangleLight(
        (x, y, z), (x, y + toward, z), (2.0, 4.0), 2.5, two_sided=two_sided, visible=visible
    )
    picture = lit(light)
    left, right = np.s_[:, :8], np.s_[:, 8:]
    assert picture.alpha[right].mean() > 0.5
    if seen is None:
        assert picture.alpha[left].mean() > 0.5
    else:
        assert not picture.alpha[left].any()
        np.testing.assert_array_equal(picture.radiance[left], np.float32(seen))


def test_visible_environment_is_seen_beside_the_volume_only():
    sky = ConstantEnvironment((1.0, 2.0, 3.0))
    hidden = lit(sky, camera=frontal(3.0, CENTRE), seed=1)
    seen = lit(sky, camera=frontal(3.0, CENTRE), seed=1, environment_visible=True)
    np.testing.assert_array_equal(hidden.alpha, seen.alpha)
    behind = (1 - hidden.alpha[..., None]) * np.array((1.0, 2.0, 3.0))
    assert (hidden.alpha[0] == 0).all()
    np.testing.assert_allclose(seen.radiance, hidden.radiance + behind, atol=1e-5)
