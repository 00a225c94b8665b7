"""Every kind of light with every lobe: three estimators of one integral.

All kinds are in each scene, those that a test does not want too dark and too small to count, so
that one kernel serves this file. z-scores are compared with 4.7, which by Bonferroni over the
(fewer than 300) comparisons of this file chance exceeds for less than 300 x 2.6e-6 = 8e-4 of all
choices of seeds.
"""

import numpy as np
import pytest
from scenes import DARK, blob, mean_and_error, render, scene, z_score

from vtkmcvr.lights import (
    BoxLight,
    CameraLight,
    ConstantEnvironment,
    CylinderLight,
    DirectionalLight,
    DiskLight,
    EnvironmentMap,
    GradientEnvironment,
    PointLight,
    RectangleLight,
    SphereLight,
    Texture,
    checkerboard,
    headlight,
    softbox,
)
from vtkmcvr.scene import HenyeyGreenstein, Surface

CENTRE = np.array((12.0, -7.0, 3.0))
BLOB = blob(centre=CENTRE)
# In a corner of the volume, where it is empty
CORNER = CENTRE + 0.99


def near(x, y, z):
    """World position relative to the blob's centre."""
    return tuple(np.add(CENTRE, (x, y, z)))


DARK_ONES = (
    RectangleLight(CORNER, CENTRE, (1e-6, 1e-6), DARK, texture=Texture(np.ones((1, 1)))),
    DiskLight(CENTRE + 3e3, CENTRE, 1e-3, DARK),
    SphereLight(CENTRE + 4e3, 1e-3, DARK),
    CylinderLight(CENTRE + 5e3, CENTRE + 5001, 1e-3, DARK),
    GradientEnvironment(DARK, DARK / 2, DARK),
    EnvironmentMap(np.full((1, 1, 3), DARK)),
    DirectionalLight((0, 0, -1), DARK),
)
CHECKS = Texture.of(checkerboard(3, 2), (12, 8))
KINDS = {
    "near rectangle": RectangleLight(near(0.2, -1.1, 0.3), CENTRE, (2.0, 1.0)),
    "rectangle inside": RectangleLight(near(0.1, 0, 0.1), CENTRE, (0.6, 0.5), two_sided=True),
    "far rectangle": RectangleLight(near(3, -4, 3), CENTRE, (1.5, 1.0), 3.0),
    "checkered rectangle": RectangleLight(near(1, -1.5, 1), CENTRE, (1.5, 1), texture=CHECKS),
    "disk": DiskLight(near(0.5, -1.4, 0.7), CENTRE, 0.8),
    "soft disk": DiskLight(near(0.5, -1.4, 0.7), CENTRE, 0.8, texture=Texture.of(softbox(1.0))),
    "ring": DiskLight(near(0, -1.5, 0), CENTRE, 1.2, inner_radius=0.8),
    "two-sided disk": DiskLight(near(0.3, -0.9, 0), near(0.3, -9, 0.4), 0.5, two_sided=True),
    "sphere": SphereLight(near(-1.0, -1.2, 0.9), 0.7),
    "small sphere": SphereLight(near(-1.0, -1.2, 0.9), 0.05, 60.0),
    "checkered sphere": SphereLight(near(-1.0, -1.2, 0.9), 0.7, texture=CHECKS),
    "sphere around": SphereLight(near(0, 0, 0.2), 2.2, two_sided=True, texture=CHECKS),
    "sphere inside": SphereLight(near(0.2, -0.2, 0.2), 0.2, 2.0),
    "box": BoxLight(near(1.2, -1.2, 0.6), (0.8, 0.6, 0.7), axis=(1, 1, 2)),
    "cylinder": CylinderLight(near(-1.5, -1.1, 0.8), near(1, -1.3, 1.0), 0.25),
    "capped cylinder": CylinderLight(near(0, -1.2, 0.8), near(0.3, -2, 2), 0.4, capped=True),
    "tube": CylinderLight(near(-0.9, 0, 0), near(0.9, 0, 0.3), 1.1, two_sided=True),
    "camera light": CameraLight(DiskLight((0.2, 0.1, 0.6), (0, 0, 0), 0.1)),
}
LOBES = {
    "isotropic": {"phase": HenyeyGreenstein(0.002)},
    "forward": {"phase": HenyeyGreenstein(0.8)},
    "diffuse": {"surface": Surface(mode="brdf", specular=1e-6, exponent=1.0)},
    "glossy": {"surface": Surface(mode="brdf", specular=0.3, exponent=60.0)},
}


def lit(*lights, seed=1, samples=64, dark=DARK_ONES, **options):
    present = {type(light) for light in lights}
    environments = (GradientEnvironment, EnvironmentMap)
    dark = [one for one in dark if type(one) not in present or type(one) not in environments]
    settings = {
        "surface": Surface(gradient_factor=1e-3), "phase": HenyeyGreenstein(0.3), "size": (16, 16),
    }  # fmt: skip
    return render(scene(BLOB, lights=(*lights, *dark), **{**settings, **options}), samples, seed)


@pytest.mark.parametrize("lobe", LOBES)
@pytest.mark.parametrize("kind", KINDS)
def test_three_estimators_agree(kind, lobe):
    by_light, by_scatter, mis = (
        lit(KINDS[kind], light_sampling=how, seed=seed, samples=samples, **LOBES[lobe])
        for seed, (how, samples) in enumerate([("light", 128), ("scatter", 512), ("mis", 128)])
    )
    assert mean_and_error(mis)[0] > 1e-4
    assert abs(z_score(by_light, mis)) < 4.7
    if kind == "small sphere" and lobe != "isotropic":
        # Scattering finds it too seldom for a standard error that means something
        return
    assert abs(z_score(by_scatter, mis)) < 4.7
    assert abs(z_score(by_light, by_scatter)) < 4.7


def test_estimators_that_differ_are_noticed():
    light = KINDS["cylinder"]
    brighter = light.with_brightness(1.1)
    one = lit(light, light_sampling="light", samples=512)
    other = lit(brighter, light_sampling="mis", samples=512, seed=2)
    assert abs(z_score(one, other)) > 4.7


@pytest.mark.parametrize("lobe", LOBES)
def test_gradient_environment_is_the_map_of_its_rows(lobe):
    up = np.array((0.6, 0.0, 0.8))
    light = GradientEnvironment((1, 2, 3), 0.5, (0.1, 0, 0.4), up=up, scale=0.7)
    v = 1 - 2 * (np.arange(256) + 0.5) / 256
    above, below = np.maximum(v, 0)[:, None], np.maximum(-v, 0)[:, None]
    rows = above * (1, 2, 3) + below * (0.1, 0, 0.4) + (1 - above - below) * 0.5
    rotation = np.stack([(0.8, 0, -0.6), up, np.cross((0.8, 0, -0.6), up)], axis=1)
    same = EnvironmentMap(rows[:, None], 0.7, rotation)
    one = lit(light, seed=1, samples=256, **LOBES[lobe])
    for how in ("light", "scatter", "mis"):
        other = lit(same, seed=2, samples=256, light_sampling=how, **LOBES[lobe])
        assert abs(z_score(one, other)) < 4.7


COPIED = {
    **{name: KINDS[name] for name in ("far rectangle", "ring", "sphere", "tube", "box")},
    "point": PointLight(near(1, -2, 1), 3.0),
    "spot": PointLight(near(1, -2, 1), 3.0, direction=(-1, 2, -1), cone_angle=30),
    "directional": DirectionalLight((-1, 1, -1)),
}


@pytest.mark.parametrize("kind", COPIED)
def test_copies_of_a_light_that_share_its_light_are_the_light(kind):
    light = COPIED[kind]
    part = light.with_brightness(np.array(light.brightness) / 8)
    one, eight = lit(light, seed=3), lit(*[part] * 8, seed=3)
    np.testing.assert_allclose(one.radiance, eight.radiance, rtol=1e-5, atol=1e-12)


@pytest.mark.parametrize("lobe", ["forward", "glossy"])
@pytest.mark.parametrize("kind", ["point", "spot", "directional"])
def test_lights_that_nearly_coincide_are_chosen_among(kind, lobe):
    # As above, but each copy is a light of its own in the tree
    light = COPIED[kind]
    one = lit(light, seed=4, samples=256, **LOBES[lobe])
    for n in (2, 8, 40):
        part = light.with_brightness(np.array(light.brightness) / n)
        shift = np.random.default_rng(n).normal(size=(n, 3)) * 1e-5
        if kind == "directional":
            copies = [DirectionalLight(part.direction + s, part.irradiance) for s in shift]
        else:
            copies = [part.moved(np.eye(3), s) for s in shift]
        many = lit(*copies, seed=5, samples=256, **LOBES[lobe])
        assert abs(z_score(one, many)) < 4.7


@pytest.mark.parametrize("how", ["light", "mis"])
def test_one_light_of_many_patches(how):
    # A ring and the disk in its hole are the disk; so are quarters of a rectangle
    place = near(0.5, -1.4, 0.7)
    whole = lit(DiskLight(place, CENTRE, 0.8), seed=6, samples=256, light_sampling=how)
    parts = lit(
        DiskLight(place, CENTRE, 0.8, inner_radius=0.5), DiskLight(place, CENTRE, 0.5),
        seed=7, samples=256, light_sampling=how,
    )  # fmt: skip
    assert abs(z_score(whole, parts)) < 4.7


def test_sphere_around_the_scene_is_a_constant_environment():
    sphere = SphereLight(near(0, 0, 0), 50.0, 0.7, two_sided=True)
    one, other = (
        lit(sphere, seed=8, samples=256),
        lit(ConstantEnvironment(0.7), seed=9, samples=256),
    )
    assert abs(z_score(one, other)) < 4.7


def test_closed_lights_shine_outward_only():
    for light in (
        SphereLight(near(0, 0, 0), 5.0),
        BoxLight(CENTRE, (6, 6, 6)),
        CylinderLight(near(0, 0, -9), near(0, 0, 9), 4.0, capped=True),
    ):
        for how in ("light", "scatter", "mis"):
            assert lit(light, light_sampling=how, samples=8).radiance.max() < 1e-9


def test_headlight_follows_the_camera():
    picture = lit(headlight(2.0), seed=3)
    same = lit(DirectionalLight((0, 1, 0), 2.0), seed=3)
    np.testing.assert_allclose(picture.radiance, same.radiance, rtol=1e-5, atol=1e-12)


@pytest.mark.parametrize(
    ("light", "seen"),
    [
        (SphereLight(near(-1, -2.5, 0), 0.6, 2.5, visible=True), 2.5),
        (SphereLight(near(-1, -2.5, 0), 0.6, 2.5), None),
        (BoxLight(near(-1, -2.5, 0), (1, 1, 1), 2.5, visible=True), 2.5),
        (DiskLight(near(-1, -2.5, 0), near(-1, 9, 0), 0.6, 2.5, visible=True), 0.0),
        (CylinderLight(near(-1, -2, -1), near(-1, -2, 1), 0.6, 2.5, visible=True), 2.5),
    ],
)
def test_camera_sees_visible_lights_of_every_shape(light, seen):
    left = lit(light).radiance[6:10, :3]
    if seen is None:
        assert left.max() < 1.0
    else:
        np.testing.assert_array_equal(left, np.float32(seen))


def test_camera_sees_the_texture():
    texture = Texture([[1.0, 2.0], [3.0, 4.0]])
    panel = RectangleLight(near(0, -2, 0), near(0, -9, 0), (4, 4), visible=True, texture=texture)
    seen = lit(panel).radiance[..., 1]
    corners = seen[0, 0], seen[0, -1], seen[-1, 0], seen[-1, -1]
    np.testing.assert_allclose(corners, (1.0, 2.0, 3.0, 4.0), atol=0.45)
    assert np.all(np.diff(seen, axis=0) > 0)
    assert np.all(np.diff(seen, axis=1) > 0)
