"""Media with a known answer: attenuation, single scattering, furnaces.

z-scores are compared with 4.5: by Bonferroni over the (fewer than 50) comparisons of this file,
chance exceeds it in less than 50 x 6.8e-6 = 3.4e-4 of all choices of seeds. The seeds are fixed.
"""

import math

import numpy as np
import pytest
from scenes import WHITE, frontal, mean_and_error, medium, noise, render, scene, slab, volume

from vtkmcvr.curves import Curve
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.scene import Camera, Cone, HenyeyGreenstein, Surface, TransferFunction

UNIT = (ConstantEnvironment(1.0),)


def alpha_score(picture, expected):
    """Deviation of the mean alpha from the expected one, in binomial standard errors."""
    n = picture.film.count.sum()
    return (picture.film.hits.sum() / n - expected) / math.sqrt(expected * (1 - expected) / n)


@pytest.mark.parametrize("depth", [0.01, 1.0, 5.0])
@pytest.mark.parametrize("points", [2, 20])
def test_parallel_rays_through_a_cube_obey_beer_lambert(depth, points):
    # 0.9 of the half height: every ray crosses the whole cube
    view = frontal(0.9, distance=7)
    cube = slab((2, 2, 2), points)
    picture = render(scene(cube, medium(depth / 2), view), samples=64)
    assert abs(alpha_score(picture, -math.expm1(-depth))) < 4.5


def test_perspective_rays_through_a_cube_obey_beer_lambert():
    # All rays of the 60 degree cone meet the front and the back face of a wide slab, 2 deep
    camera = Camera((0, -4, 0), (0, 0, 0), view_angle=60)
    picture = render(scene(slab((20, 2, 20)), medium(0.5), camera), samples=64)
    a = math.tan(math.radians(30)) * (np.arange(-499.5, 500) / 500)
    secant = np.sqrt(1 + a[:, None] ** 2 + a**2)
    assert abs(alpha_score(picture, np.mean(-np.expm1(-0.5 * 2 * secant)))) < 4.5


def test_opacity_is_reached_over_the_unit_distance():
    # Opacity 0.3 per 0.5 world units, 2 units deep, half the density: alpha = 1 - 0.7^(4 / 2)
    transfer = TransferFunction(Curve([(1, 0.3)]), WHITE, unit_distance=0.5, density_scale=0.5)
    picture = render(scene(slab((2, 2, 2)), transfer), samples=64)
    assert abs(alpha_score(picture, 1 - 0.7**2)) < 4.5


def test_depth_is_the_mean_distance_to_the_collision():
    # Collisions at 4 + x with x exponential of mean 1/3, cut off at 2; camera 5 from the centre
    picture = render(scene(slab((2, 2, 2)), medium(3.0), frontal(0.9)), samples=64)
    film, cut = picture.film, math.exp(-6)
    mean = 4 + 1 / 3 - 2 * cut / (1 - cut)
    n = film.hits.sum()
    found = (film.depth * film.hits).sum() / n
    assert abs(found - mean) < 4.5 * (1 / 3) / math.sqrt(n)


@pytest.mark.parametrize("ratio", [False, True])
@pytest.mark.parametrize("degrees", [0, 60])
def test_half_space_under_an_even_sky(ratio, degrees):
    # Isotropic, single scattering, unit sky: L = w/2 (1 - m ln(1 + 1/m)), m the cosine of the view.
    # 40 mean free paths deep and wide: leaks are below exp(-40).
    m, albedo = math.cos(math.radians(degrees)), 0.8
    half_space = slab((80, 40, 80), points=3)
    aim = np.array((0.0, -20.0, 0.0))
    back = 50 * np.array((0.0, -m, math.sin(math.radians(degrees))))
    camera = Camera(aim + back, aim, view_up=(1, 0, 0), parallel_scale=0.5)
    transfer = medium(1.0, albedo)
    picture = render(
        scene(half_space, transfer, camera, lights=UNIT, ratio_tracking=ratio), samples=128
    )
    mean, error = mean_and_error(picture)
    assert error < 0.002
    assert abs(mean - albedo / 2 * (1 - m * math.log(1 + 1 / m))) < 4.5 * error


@pytest.mark.parametrize("g", [-0.9, 0.5, 0.95])
def test_unshadowed_white_furnace_returns_alpha(g):
    # Albedo 1, unit light from everywhere, no shadows: each colliding path carries exactly 1, but
    # for float32 rounding of value / density
    picture = render(
        scene(noise(), medium(2.0), lights=UNIT, phase=HenyeyGreenstein(g), shadow_reach=0),
        samples=16,
    )
    assert 0.3 < picture.alpha.mean() < 1
    assert np.abs(picture.radiance - picture.alpha[..., None]).max() < 1e-5


def test_unshadowed_lambert_surface_reflects_its_colour():
    colour = np.array((1.0, 0.5, 0.25))
    picture = render(
        scene(
            noise(), medium(50.0, colour), lights=UNIT, shadow_reach=0,
            surface=Surface(mode="brdf", specular=0.0),
        ),
        samples=16,
    )  # fmt: skip
    assert picture.alpha.mean() > 0.9
    assert np.abs(picture.radiance - picture.alpha[..., None] * colour).max() < 1e-5


def test_red_light_on_what_is_green_gives_black():
    # HC-40: products of linear RGB; those of XYZ give (0.24, 0.14, -0.02)
    red, green = (ConstantEnvironment((1.0, 0.0, 0.0)),), medium(2.0, (0.0, 1.0, 0.0))
    picture = render(
        scene(noise(), green, lights=red, phase=HenyeyGreenstein(0.5), shadow_reach=0), samples=4
    )
    assert picture.alpha.mean() > 0.3
    assert not picture.radiance.any()


def test_without_lights_the_medium_is_black_and_there():
    # HC-46
    picture = render(scene(slab((2, 2, 2)), medium(3.0), frontal(0.9)), samples=4)
    assert picture.alpha.mean() > 0.9
    assert not picture.radiance.any()


def test_shadow_reach_limits_attenuation():
    # A reach beyond the volume is no limit; half of it lies between no shadows and full ones
    def mean(reach):
        lit = scene(slab((2, 2, 2)), medium(3.0), lights=UNIT, shadow_reach=reach)
        return mean_and_error(render(lit, samples=64))

    (near, e0), (half, e1), (full, e2), (far, e3) = (mean(r) for r in (1e-6, 0.2, 4.0, math.inf))
    assert near - half > 4.5 * math.hypot(e0, e1)
    assert half - full > 4.5 * math.hypot(e1, e2)
    # The same seed and the same walks: nothing beyond 4 can attenuate
    assert (full, e2) == (far, e3)


def test_scene_without_density_is_black_and_transparent():
    for sigma_t in (0.0, 1e-30):
        picture = render(scene(transfer=medium(sigma_t), lights=UNIT), samples=4)
        assert not picture.alpha.any()
        assert not picture.radiance.any()
        assert np.isinf(picture.depth).all()
    assert render(scene(transfer=medium(0.0)), samples=1).plan.empty


def test_one_voxel_plate_is_opaque():
    # Opaque where the interpolated scalar is above 1/2: one voxel, 24 ln 2 optical depths, so that
    # a miss has probability 6e-8 a sample, 1e-3 in all (HC-01)
    values = np.zeros((20, 20, 20), np.float32)
    values[:, 10, :] = 1
    transfer = TransferFunction(Curve([(0.5, 0), (0.5, 1)]), WHITE, unit_distance=1.0)
    picture = render(scene(volume(values), transfer, frontal(9)), samples=16)
    assert (picture.alpha == 1).all()


def test_volume_is_seen_from_inside():
    # Camera in the middle of the cube: every path is from 1 (face) to its end; parallel rays have
    # length 1
    camera = Camera((0, 0, 0), (0, 1, 0), parallel_scale=0.9)
    picture = render(scene(slab((2, 2, 2)), medium(1.0), camera), samples=64)
    assert abs(alpha_score(picture, -math.expm1(-1.0))) < 4.5


# Directional occlusion: single scattering out of a cone around the viewer


@pytest.mark.parametrize(("degrees", "expected"), [(30, 0.4825), (50, 0.4492), (80, 0.3550)])
def test_half_space_under_a_cone_of_light(degrees, expected):
    # L = 1 - ln(2 / (1 + c)) / (1 - c) with c the cosine of the half angle
    c = math.cos(math.radians(degrees))
    assert 1 - math.log(2 / (1 + c)) / (1 - c) == pytest.approx(expected, abs=1e-4)
    half_space = slab((400, 40, 400), points=3)
    view = frontal(0.5, (0, -20, 0))
    picture = render(
        scene(half_space, medium(1.0), view, lights=UNIT, phase=Cone(degrees)), samples=128
    )
    mean, error = mean_and_error(picture)
    assert error < 0.002
    assert abs(mean - (1 - math.log(2 / (1 + c)) / (1 - c))) < 4.5 * error
