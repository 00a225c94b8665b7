"""Hard cases of directional occlusion (HC-80 to HC-93)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scenes import BOX, blob, frontal, medium, noise, scene, slab, volume
from techniques import (
    EMISSION_ABSORPTION,
    OCCLUSION,
    SKY,
    by_occlusion,
    every_technique,
    picture_by,
    relative_difference,
)

from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.scene import Camera, Volume

THETAS = [0, 30, 50, 80, 85, 89.9]


def half_space_scene(sigma_t=1.0, size=(5, 5)):
    """24 mean free paths deep, 120 wide, seen along its normal; 16 of it fill the film."""
    vol = volume(np.ones((121, 25, 121), np.float32), (1 / sigma_t,) * 3)
    centre = (0.0, -12.0 / sigma_t, 0.0)
    return scene(
        vol, medium(sigma_t), frontal(8 / sigma_t, centre, 50 / sigma_t), size, lights=SKY,
        pixel_filter=BOX,
    )  # fmt: skip


def half_space(theta):
    """1 - ln(2 / (1 + c)) / (1 - c); 1/2 for a cone of no width."""
    c = math.cos(math.radians(theta))
    return 0.5 if theta == 0 else 1 - math.log(2 / (1 + c)) / (1 - c)


def middle(picture):
    height, width = picture.alpha.shape
    return float(picture.radiance[height // 2, width // 2, 1])


@by_occlusion
@pytest.mark.parametrize("share", [2, 4])
def test_hc80_thinner_slices_are_the_same_picture(record, technique, share):
    # As published, occlusion weakens as slices get thinner: sqrt(1 / share) of the width
    lit = scene(blob(33), medium(12.0), frontal(0.9), lights=SKY)
    slices = 64
    pictures = [
        picture_by(technique, lit, slices=n, grid=9 if "paper" in technique else 7)
        for n in (share * slices, slices)
    ]
    tolerance = 0.02 if technique == "occlusion default" else 0.5
    what = f"{share} times as many slices"
    record("HC-80", what, technique, 0, relative_difference(*pictures), tolerance)


@by_occlusion
def test_hc81_cones_as_wide_as_a_hemisphere(record, technique):
    # Nothing infinite, no more light than there is; the default mode has the cone's value
    picture = picture_by(technique, half_space_scene(), half_angle=89.9)
    if technique == "occlusion default":
        record("HC-81", "half-space, 89.9 deg", technique, half_space(89.9), middle(picture), 0.03)
    assert np.isfinite(picture.radiance).all()
    assert picture.radiance.max() <= 1


@pytest.mark.parametrize("theta", THETAS)
def test_hc83_half_space(record, theta):
    # HC-82 as well: a flat disk gives .435, .203 and .115 at 50, 80 and 85 degrees
    got = middle(render_occlusion(half_space_scene(), Occlusion(theta, slices=240)))
    expected = half_space(theta)
    what = f"half-space, {theta} deg"
    # Light from the horizon, beyond the raster's margin, counts as lit
    tolerance = (0.005 if theta < 89 else 0.03) * expected
    record("HC-83", what, "occlusion default", expected, got, tolerance)


@pytest.mark.parametrize("slices", [240, 24])
@by_occlusion
def test_hc84_coarse_slices(record, technique, slices):
    # As published 1 / (1 + exp(-a)) for slices of optical depth a; the default mode has the limit
    theta = 50
    got = middle(picture_by(technique, half_space_scene(), half_angle=theta, slices=slices))
    a = 24 / slices
    paper = technique == "occlusion paper"
    expected = 1 / (1 + math.exp(-a)) if paper else half_space(theta)
    what = f"slices of {a:g} mean free paths"
    record("HC-84", what, technique, expected, got, 0.03 * expected)


def test_hc85_thousands_of_faint_slices(record):
    # 5000 slices of optical depth 1e-5, every ray its own shade: (1 - exp(-2 tau)) / 2
    vol = slab((12, 10, 12), 13)
    lit = scene(vol, medium(0.005), frontal(1.0, distance=50), (3, 3), lights=SKY)
    got = middle(render_occlusion(lit, Occlusion(0, slices=5000)))
    expected = -math.expm1(-0.1) / 2
    record("HC-85", "5000 slices of 1e-5", "occlusion default", expected, got, 1e-3 * expected)


@pytest.mark.parametrize("exponent", [-20, -34, -38, -41])
@pytest.mark.parametrize("technique", [*OCCLUSION, "occlusion fast", EMISSION_ABSORPTION])
def test_hc85_media_fainter_than_single_precision_inverts(record, technique, exponent):
    # A scalar from 0 to 1 along the ray: optical depth, and alpha, sigma L / 2; albedo 0.5. Below
    # 1e-38 numbers have fewer digits (spaced by 1.4e-45), and below 3e-39 no finite inverse
    sigma = 10.0**exponent
    ramp = np.broadcast_to(np.linspace(0, 1, 9, dtype=np.float32)[:, None], (9, 9, 9))
    lit = scene(volume(ramp, (0.5,) * 3), medium(sigma, 0.5), frontal(0.9), (3, 3), lights=SKY)
    picture = picture_by(technique, lit)
    expected = sigma * 4 / 2
    tolerance = 0.02 * expected + 32 * 1.4e-45
    what = f"ramp of 1e{exponent}"
    record("HC-85", f"{what}, alpha", technique, expected, picture.alpha[1, 1], tolerance)
    if "occlusion" in technique:
        record("HC-85", f"{what}, light", technique, expected / 2, middle(picture), tolerance)
    assert picture.rejected_samples == 0


@by_occlusion
def test_hc90_alpha_does_not_round_above_one(technique):
    # Sums of 32-bit numbers to 1 + 1e-7 were seen in many layers of an opaque medium
    vol = volume(np.random.default_rng(3).random((33, 65, 33), np.float32), (1 / 32,) * 3)
    for sigma_t in (30.0, 60.0, 200.0):
        lit = scene(vol, medium(sigma_t), frontal(0.3), (64, 64), lights=SKY)
        picture = picture_by(technique, lit)
        assert picture.alpha.max() <= 1
        assert picture.alpha.min() > 0.99


@pytest.mark.parametrize("slices", [60, 200])
def test_hc90_no_more_light_than_alpha_along_an_edge(slices):
    # Rays that run along the volume's edge within rounding: what raster steps add to the optical
    # depth of light, and is taken off, was more than there is (0.3 % too bright)
    vol = Volume(np.ones((2, 2, 200), np.uint8), np.diag([0.1, 1.0, 1.0, 1.0]))
    camera = Camera((-0.01, 0, 0), (0, 0, 0), (0.1, 1.2, -0.3), view_angle=1e-3)
    lit = scene(vol, medium(0.05), camera, (1, 1), lights=SKY)
    picture = render_occlusion(lit, Occlusion(60.0, slices=slices, radiance=1.0))
    assert picture.radiance.max() > 0
    assert (picture.radiance <= (1 + 1e-5) * picture.alpha[..., None]).all()


@every_technique
def test_hc86_oblique_rays_are_longer(record, technique):
    # A slab seen at 90 degrees: 1.7 times as long to the corners
    vol = slab((40, 2, 40), 33)
    camera = Camera((0, -4, 0), (0, 0, 0), view_angle=90)
    picture = picture_by(
        technique, scene(vol, medium(0.25), camera, (15, 15), lights=SKY, pixel_filter=BOX), 256
    )
    corners = picture.alpha[[0, 0, -1, -1], [0, -1, 0, -1]].astype(float)
    # Mean over the corner pixel: tangents from 13/15 to 1
    x = 13 / 15 + 2 / 15 * (np.arange(50) + 0.5) / 50
    expected = float(np.mean(-np.expm1(-0.5 * np.sqrt(1 + x[:, None] ** 2 + x**2))))
    tolerance = 2e-3 if technique.startswith("occlusion") else 4.5 * 0.5 / math.sqrt(4 * 256)
    record("HC-86", "alpha in the corners, 90 deg", technique, expected, corners.mean(), tolerance)


@every_technique
def test_hc87_off_centre_windows(record, technique):
    # The right half of a film as a film of its own
    camera = Camera((0.5, -4.0, 0.8), (0, 0, 0), view_angle=32)
    whole = scene(blob(33), medium(6.0), camera, (48, 24), lights=SKY, pixel_filter=BOX)
    half = replace(whole, size=(24, 24), camera=replace(camera, window_centre=(1.0, 0.0)))
    a, b = (picture_by(technique, s, 256).alpha for s in (half, whole))
    got, expected = float(a.mean(dtype=float)), float(b[:, 24:].mean(dtype=float))
    tolerance = 2e-3 if technique.startswith("occlusion") else 4.5 / math.sqrt(2 * 24 * 24 * 256)
    record("HC-87", "half of a film by a window", technique, expected, got, tolerance)


@by_occlusion
def test_hc88_no_halo_at_the_border_of_the_film(record, technique):
    picture = picture_by(technique, half_space_scene(size=(24, 24)))
    light = picture.radiance[..., 1]
    ratio = float(light.max() / light.min())
    record("HC-88", "brightest over darkest pixel of a wall", technique, 1, ratio, 0.01)


@by_occlusion
def test_hc88_no_light_is_lost_beside_a_silhouette(record, technique):
    # Too faint to shade itself: its own light only, up to its edge
    vol = volume(np.ones((17, 3, 17), np.float32), (0.5,) * 3)
    lit = scene(vol, medium(1e-3), frontal(6.0, distance=50), (48, 48), lights=SKY)
    picture = picture_by(technique, lit, half_angle=80)
    seen = picture.alpha > 0.9e-3
    worst = np.abs(picture.radiance[seen][:, 0] / picture.alpha[seen] - 1).max()
    record("HC-88", "light beside a silhouette", technique, 0, worst, 0.01)
    assert not picture.radiance[picture.alpha == 0].any()


def test_hc89_no_banding_of_a_plane(record):
    # An even wall at 85 degrees is even: spread of its pixels over their mean
    picture = render_occlusion(half_space_scene(size=(32, 32)), Occlusion(85))
    light = picture.radiance[8:-8, 8:-8, 1]
    spread = light.std() / light.mean()
    record("HC-89", "spread on a wall, 85 deg", "occlusion default", 0, spread, 0.005)


@every_technique
def test_hc90_alpha_composites_over_any_background(record, technique):
    # Premultiplied: nothing of the background is in the radiance; albedo 0 is black
    lit = scene(blob(), medium(3.0, 0.0), lights=SKY)
    picture = picture_by(technique, lit, 16)
    record("HC-90", "radiance of albedo 0", technique, 0, picture.radiance.max(), 0)
    assert picture.alpha.max() > 0.8


@by_occlusion
def test_hc91_saturated_pixels_go_on_shading_others(record, technique):
    lit = scene(blob(33), medium(60.0), frontal(0.9), lights=SKY)
    quick, whole = (picture_by(technique, lit, skip=skip, grid=5) for skip in (True, False))
    worst = np.abs(quick.radiance - whole.radiance).max()
    record("HC-91", "early end against none", technique, 0, worst, 5e-5)


@every_technique
def test_hc93_axes_stored_backwards(record, technique):
    vol = noise(9)
    matrix = vol.index_to_world.copy()
    matrix[:3, 3] += matrix[:3, :3] @ (np.array(vol.shape) - 1)
    matrix[:3, :3] *= -1
    turned = Volume(np.ascontiguousarray(vol.values[::-1, ::-1, ::-1]), matrix)
    means = [
        picture_by(technique, scene(v, medium(3.0), frontal(0.9), lights=SKY), 64)
        .radiance.mean(dtype=float)
        for v in (turned, vol)
    ]  # fmt: skip
    tolerance = 0.01 * means[1] if technique.startswith("occlusion") else 0.01
    record("HC-93", "axes stored backwards", technique, means[1], means[0], tolerance)
