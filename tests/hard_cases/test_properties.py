"""Promises for any legal scene: time, finiteness, consistency, energy, laws of scale and symmetry.

Few examples here; thousands with `make slow`. Scenes are those of `random_scenes`. Film samples of
few paths are compared where the law holds path by path (the same random numbers), and statistically
where it does not.
"""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from random_scenes import KERNEL_TYPES, OTHER_TYPES, plain_scenes, rich_scenes, volumes
from scenes import blob, everything, frontal, mean_and_error, medium, noise, scene, volume
from techniques import MONTE_CARLO, SKY, by_monte_carlo, every_technique, picture_by

from vtkmcvr.lights import DirectionalLight, EnvironmentMap
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Surface, Volume
from vtkmcvr.voxels import voxels_of

# No picture of these few paths may take longer; nearly all take milliseconds
SECONDS = 20.0
ANY = list(HealthCheck)


def quick(examples):
    return settings(
        max_examples=examples, deadline=None, derandomize=True, database=None,
        suppress_health_check=ANY,
    )  # fmt: skip


def promised(lit, samples=2, seed=1):
    """Render a scene and check what holds for all of them."""
    picture = render_scene(lit, samples=samples, seed=seed, threads=1)
    assert picture.seconds < SECONDS
    for plane in (picture.radiance, picture.alpha, picture.standard_error):
        assert np.isfinite(plane).all()
    assert picture.rejected_samples == picture.majorant_violations == 0
    assert (picture.radiance >= 0).all()
    assert ((picture.alpha >= 0) & (picture.alpha <= 1)).all()
    hit = picture.alpha > 0
    assert np.isinf(picture.depth[~hit]).all()
    assert not picture.radiance[~hit].any()
    if hit.any():
        corners = np.subtract(lit.volume.corners, lit.camera.position)
        farthest = np.linalg.norm(corners, axis=1).max() + lit.volume.radius
        assert (picture.depth[hit] >= 0).all()
        assert (picture.depth[hit] <= farthest * (1 + 1e-6)).all()
    return picture


def check_plain(lit):
    picture = promised(lit)
    # No sample is brighter than the sky: each carries its colour times a transmittance
    sky = lit.lights[0].radiance[0]
    assert picture.radiance.max() <= sky * 1.0001


@quick(60)
@given(plain_scenes())
def test_any_scalars_under_a_sky(lit):
    check_plain(lit)


@pytest.mark.slow
@quick(3000)
@given(plain_scenes())
def test_any_scalars_under_a_sky_at_length(lit):
    check_plain(lit)


@quick(25)
@given(rich_scenes())
def test_all_effects_at_their_ends(lit):
    promised(lit)


@quick(20)
@given(rich_scenes("multiple"))
def test_all_effects_at_their_ends_by_multiple_scattering(lit):
    promised(lit)


@pytest.mark.slow
@pytest.mark.parametrize("scattering", ["single", "multiple"])
@quick(1500)
@given(st.data())
def test_all_effects_at_their_ends_at_length(scattering, data):
    promised(data.draw(rich_scenes(scattering)))


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["default", "fast", "paper"])
@quick(150)
@given(plain_scenes())
def test_any_scalars_by_occlusion(mode, lit):
    picture = render_occlusion(lit, Occlusion(60.0, mode, radiance=1.0), threads=1)
    assert picture.rejected_samples == 0
    assert ((picture.alpha >= 0) & (picture.alpha <= 1)).all()
    assert (picture.radiance >= 0).all()
    assert (picture.radiance <= 1.001 * picture.alpha[..., None] + 1e-6).all()
    assert (np.isinf(picture.depth) == (picture.alpha == 0)).all()


@quick(60)
@given(volumes(tuple(KERNEL_TYPES + OTHER_TYPES)))
def test_voxels_are_kept_whatever_their_type_and_layout(vol):
    voxels = voxels_of(vol)
    raw = vol.values.astype(np.float64)
    finite = np.isfinite(raw)
    again = voxels.values.astype(np.float64) * voxels.unit + voxels.offset
    span = np.ptp(raw[finite]) if finite.any() else 0.0
    # To float32 of the magnitude, or of the range where the magnitude is a thousand times larger
    largest = np.abs(raw[finite]).max() if finite.any() else 0.0
    bound = 1e-7 * (span if 0 < span < 1e-3 * largest else largest) + 1e-15 * largest
    assert (np.abs(again - raw)[finite] <= bound).all()
    assert np.isnan(voxels.values[~finite]).all() if not finite.all() else True
    assert voxels.not_finite == raw.size - finite.sum()


@pytest.mark.parametrize("size", [(1, 1), (1, 500), (10_000, 1)])
@by_monte_carlo
def test_films_of_any_shape(record, technique, size):
    # A ray through the middle: a film of one pixel, or a narrow one, has the cube's alpha
    camera = frontal(0.9 if size[0] < size[1] else 0.9 * size[1] / size[0])
    lit = scene(volume(np.ones((5, 5, 5)), (0.5,) * 3), medium(0.5), camera, size, lights=SKY)
    samples = max(1, 4096 // (size[0] * size[1]))
    picture = picture_by(technique, lit, samples)
    p, n = -math.expm1(-1.0), samples * size[0] * size[1]
    assert picture.alpha.shape == size[::-1]
    tolerance = 4.5 * math.sqrt(p * (1 - p) / n)
    got = picture.alpha.mean(dtype=float)
    record("film", f"{size[0]} x {size[1]} pixels", technique, p, got, tolerance)


# Laws of scale


@pytest.mark.parametrize("factor", [2.0**-20, 2.0**20])
@every_technique
def test_units_of_length_do_not_matter(record, technique, factor):
    # The world larger, extinction smaller by a power of two: the same bits
    def picture(k):
        vol = volume(blob().values, (0.125 * k,) * 3)
        camera = frontal(0.9 * k, distance=5 * k)
        return picture_by(technique, scene(vol, medium(3.0 / k), camera, lights=SKY), 8)

    a, b = picture(factor), picture(1.0)
    what = f"world scaled by {factor:g}"
    record("scale", what, technique, 0, np.abs(a.radiance - b.radiance).max(), 1e-6)
    np.testing.assert_allclose(a.depth / factor, b.depth, rtol=1e-6)


def brighter(light, factor):
    if isinstance(light, EnvironmentMap):
        return replace(light, scale=light.scale * factor)
    return light.with_brightness(np.multiply(light.brightness, factor))


@pytest.mark.parametrize("factor", [2.0**-40, 2.0**60])
@by_monte_carlo
def test_twice_the_light_is_twice_the_picture(record, technique, factor):
    def picture(k):
        lights = tuple(brighter(light, k) for light in some.lights)
        return picture_by(technique, replace(some, lights=lights), 8)

    some = everything(DirectionalLight((1, 2, -1.5), 2.0))
    a, b = picture(factor), picture(1.0)
    what = f"light scaled by {factor:g}"
    difference = np.abs(a.radiance / np.float32(factor) - b.radiance).max()
    record("scale", what, technique, 0, difference, 1e-6)


# Symmetries, in distribution: z-scores of means below 4.5


def turned(lit, turn):
    """The whole scene under a rotation or a mirror."""
    vol = lit.volume
    matrix = np.eye(4)
    matrix[:3, :3] = turn
    camera = replace(
        lit.camera,
        **{name: tuple(turn @ getattr(lit.camera, name)) for name in
           ("position", "focal_point", "view_up")},
    )  # fmt: skip
    lights = tuple(
        replace(light, direction=tuple(turn @ light.direction))
        if isinstance(light, DirectionalLight)
        else light
        for light in lit.lights
    )
    return replace(
        lit, volume=Volume(vol.values, matrix @ vol.index_to_world), camera=camera, lights=lights
    )


def rotation(axis, angle):
    k = np.cross(np.eye(3), axis) * -1
    return np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k


MOTIONS = {
    "rotation": rotation((2 / 7, 3 / 7, 6 / 7), 1.234),
    "quarter turn": rotation((0, 0, 1.0), math.pi / 2),
    "mirror": np.diag([-1.0, 1.0, 1.0]),
}


@pytest.mark.parametrize("motion", MOTIONS)
@by_monte_carlo
def test_scene_and_camera_moved_together(record, technique, motion):
    sun = DirectionalLight((1, 2, -1.5), 2.0)
    lit = everything(sun, surface=Surface(0.9, specular=0.3, exponent=20))
    (a, ea), (b, eb) = (
        mean_and_error(picture_by(technique, s, 64, seed))
        for seed, s in enumerate((lit, turned(lit, MOTIONS[motion])))
    )
    record("symmetry", motion, technique, a, b, 4.5 * math.hypot(ea, eb))


@every_technique
def test_axes_in_any_order(record, technique):
    vol = noise(7)
    values = np.ascontiguousarray(vol.values.transpose(0, 2, 1))
    other = Volume(values, vol.index_to_world[:, [1, 0, 2, 3]])
    pictures = [
        picture_by(technique, scene(v, medium(3.0), frontal(0.9), lights=SKY), 64, seed)
        for seed, v in enumerate((vol, other))
    ]
    means = [p.radiance.mean(dtype=float) for p in pictures]
    tolerance = 1e-3
    if technique in MONTE_CARLO:
        tolerance = 4.5 * math.hypot(*(mean_and_error(p)[1] for p in pictures))
    record("symmetry", "axes in another order", technique, means[0], means[1], tolerance)


def test_every_field_of_a_scene_is_drawn_or_named():
    # What random scenes leave at its default has tests of its own
    left = {
        "max_scatterings", "estimator", "step", "shadow_reach", "environment_visible",
        "ratio_tracking", "light_sampling", "aovs", "sampler", "clip", "crop", "mask", "labels",
        "receivers", "layers", "backdrop",
    }  # fmt: skip
    drawn = {
        "volume", "transfer", "camera", "lights", "surface", "phase", "scattering", "size",
        "pixel_filter",
    }  # fmt: skip
    assert {field.name for field in fields(plan(scene()).scene)} == left | drawn
