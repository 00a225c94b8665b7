"""Hard cases of surfaces, phase functions and lights (HC-17 to HC-46)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from brdf_reference import (
    UP,
    colour,
    direction,
    directional_albedo,
    gloss,
    on_hemisphere,
    reference,
    values_and_densities,
)
from compiled import compiled
from scenes import (
    WHITE,
    blob,
    everything,
    frontal,
    mean_and_error,
    medium,
    render,
    scene,
    slab,
    volume,
)
from techniques import (
    MONTE_CARLO,
    OCCLUSION,
    SKY,
    by_light,
    by_monte_carlo,
    picture_by,
    relative_difference,
)

from vtkmcvr import packed
from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.kernels.brdf import HYBRID, surface_probability
from vtkmcvr.kernels.direct import power_heuristic
from vtkmcvr.kernels.grid import gradient
from vtkmcvr.lights import ConstantEnvironment, PointLight, RectangleLight, SphereLight
from vtkmcvr.scene import HenyeyGreenstein, Surface, TransferFunction, Volume

f32 = np.float32


def half_space(transfer, camera_height=0.5, **options):
    """40 mean free paths deep and wide, seen from straight above; a far corner differs."""
    values = np.ones((5, 5, 5), f32)
    values[0, 0, 0] = 0.9
    vol = volume(values, (20.0, 10.0, 20.0))
    return scene(
        vol, transfer, frontal(camera_height, (0, -20, 0)), (16, 16), lights=SKY, **options
    )


# Surfaces


@by_monte_carlo
def test_hc17_no_surface_without_a_gradient(record, technique):
    # A surface wherever there is a gradient, but there is none in view: the phase function's
    # (1 - ln 2) / 2 of single scattering, 1 of multiple
    surface = Surface(mode="brdf", specular=0.0)
    picture = picture_by(technique, half_space(medium(1.0), surface=surface), 64)
    mean, error = mean_and_error(picture)
    if technique == "monte-carlo single":
        expected, tolerance = (1 - math.log(2)) / 2, 4.5 * error
    else:
        expected, tolerance = 1.0, 1e-3
    record("HC-17", "constant region, BRDF only", technique, expected, mean, tolerance)


def test_hc17_view_exactly_along_the_normal(record):
    coat = gloss(0.5, 30.0)
    found = values_and_densities(coat, colour(0.5), UP, UP, np.array([UP], f32))[0, 0]
    expected = reference(coat, colour(0.5), UP, np.array([UP]))[0, 0]
    record("HC-17", "BRDF along the normal", "kernel", expected, found, 1e-6 * expected)


def test_hc19_probability_of_a_tiny_gradient(record):
    # P = 1 - exp(-25 g^3 m): 25 m to first order, which 1 - exp in float32 gives as 0
    rows = (UP, UP, UP)
    surface = packed.Surface(np.int32(HYBRID), f32(1), rows, f32(1), f32(25), f32(0.5))
    found = compiled(surface_probability)(surface, f32(1), f32(1e-9))
    record("HC-19", "P_brdf of a gradient of 1e-9", "kernel", 2.5e-8, found, 1e-14)


@pytest.mark.parametrize("at", [0.0, 0.4, 4.0])
def test_hc22_gradient_at_the_border(record, at):
    values = np.broadcast_to(np.arange(5, dtype=f32) * 3, (5, 5, 5)).copy()
    rows = tuple(tuple(f32(x) for x in row) for row in np.eye(3))
    g = compiled(gradient)(values, rows, (f32(at), f32(2), f32(2)))
    record("HC-22", f"gradient of a ramp at {at:g}", "kernel", 3, g[0], 1e-6)


# Scattering functions


@pytest.mark.parametrize(("theta", "expected"), [(0, 0.970), (45, 0.890), (75, 0.641)])
def test_hc31_directional_albedo_of_the_fresnel_blend(record, theta, expected):
    found = directional_albedo(gloss(0.04, 100), colour(1), direction(theta))[0]
    record("HC-31", f"albedo of the Fresnel blend, {theta} deg", "kernel", expected, found, 0.005)


def rectangle_lit(**options):
    light = RectangleLight((2, -2, 2), (0, 0, 0), (1, 1), 20.0)
    surface = Surface(0.8, specular=0.3, exponent=20.0)
    return everything(light, surface=surface, phase=HenyeyGreenstein(0.6), **options)


@by_monte_carlo
def test_hc32_three_estimators_agree(record, technique):
    means = {}
    for seed, how in enumerate(("light", "scatter", "mis")):
        lit = replace(rectangle_lit(), light_sampling=how)
        means[how] = mean_and_error(picture_by(technique, lit, 128, seed))
    for how in ("light", "scatter"):
        (a, ea), (b, eb) = means[how], means["mis"]
        record("HC-32", f"MIS against {how} alone", technique, a, b, 4.5 * math.hypot(ea, eb))


DENSITIES = [0.0, 1e-38, 1e-30, 1.0, 1e30, 3e38]


def test_hc33_power_heuristic_of_extreme_densities(record):
    weight = compiled(power_heuristic)
    pairs = [(f32(p), f32(q)) for p in DENSITIES for q in DENSITIES if p or q]
    worst = max(abs(weight(p, q) + weight(q, p) - 1) for p, q in pairs)
    record("HC-33", "sum of two MIS weights, off 1", "kernel", 0, worst, 1e-6)
    assert weight(f32(0), f32(0)) == 0
    assert weight(f32(np.inf), f32(1)) == 1


@by_monte_carlo
def test_hc34_copies_of_a_light_share_its_light(record, technique):
    lamp = PointLight((-1, -2, 1), 8.0)
    one = everything(lamp)
    many = everything(*[replace(lamp, intensity=1.0)] * 8)
    (a, ea), (b, eb) = (
        mean_and_error(picture_by(technique, s, 64, seed)) for seed, s in enumerate((one, many))
    )
    record("HC-34", "8 copies at 1/8 of a light", technique, a, b, 4.5 * math.hypot(ea, eb))


@pytest.mark.parametrize("radius", [1e-2, 1e-6, 1e-9])
def test_hc35_tiny_lights(record, radius):
    # A sphere of radiance 1 / (pi r^2) is a lamp of intensity 1
    place = (-1.0, -2.0, 1.0)
    sphere = SphereLight(place, radius, 8.0 / (math.pi * radius**2))
    options = {"vol": blob(), "transfer": medium(3.0)}
    lamp, ball = (
        mean_and_error(render(scene(lights=(light,), **options), 64, seed))
        for seed, light in enumerate((PointLight(place, 8.0), sphere))
    )
    what = f"sphere of radius {radius:g}"
    tolerance = 4.5 * math.hypot(lamp[1], ball[1])
    record("HC-35", what, "monte-carlo single", lamp[0], ball[0], tolerance)


@by_monte_carlo
def test_hc36_lights_around_a_volume_far_from_the_origin(record, technique):
    def picture(shift):
        shift = np.array(shift)
        light = RectangleLight(shift + np.array((2, -2, 2)), shift, (1, 1), 20.0)
        return picture_by(technique, everything(light, vol=blob(centre=shift)), 4)

    near, far = picture((0.0, 0.0, 0.0)), picture((2.0**20, -(2.0**21), 64.0))
    difference = relative_difference(far, near)
    record("HC-36", "light and volume moved", technique, 0, difference, 0)


@by_light
def test_hc40_red_light_on_green_is_black(record, technique):
    green = medium(3.0, (0.0, 1.0, 0.0))
    lit = scene(blob(), green, lights=(ConstantEnvironment((1.0, 0.0, 0.0)),))
    picture = picture_by(technique, lit, 4)
    record("HC-40", "red light on green", technique, 0, np.abs(picture.radiance).max(), 0)
    red = replace(lit, transfer=medium(3.0, (1.0, 0.0, 0.0)))
    white = replace(lit, transfer=medium(3.0), lights=SKY)
    a, b = (picture_by(technique, s, 16).radiance[..., 0].mean(dtype=float) for s in (red, white))
    tolerance = 1e-6 if technique != "monte-carlo multiple" else 0.02
    record("HC-40", "red light on red, of that on white", technique, 1, a / b, tolerance)


@pytest.mark.parametrize("exponent", [0.0, 1.0, 1e2, 1e6])
def test_hc41_microfacets_at_grazing_angles(record, exponent):
    # f(a, b) = f(b, a) to 1e-5, and finite, down to half a minute of arc above the surface
    coat = gloss(0.3, exponent)
    rng = np.random.default_rng(2)
    cosines = np.cos(np.radians([0, 45, 80, 89, 89.9, 89.99]))
    d = on_hemisphere(np.repeat(cosines, 10), 2 * np.pi * rng.random(60)).astype(f32)
    worst = 0.0
    for x in d:
        there = values_and_densities(coat, colour(0.5), UP, tuple(x), d)[:, 0] / d[:, 2]
        back = np.array(
            [values_and_densities(coat, colour(0.5), UP, tuple(y), x[None])[0, 0] for y in d]
        )
        back /= x[2]
        assert np.isfinite(there).all()
        worst = max(worst, float((np.abs(there - back) / np.maximum(there, 1e-30)).max()))
    what = f"reciprocity of Blinn's exponent {exponent:g}"
    record("HC-41", what, "kernel", 0, worst, 1e-5)


@pytest.mark.parametrize("ggx", [False, True], ids=["Blinn", "GGX"])
def test_hc42_no_coat_reflects_more_than_arrives(record, ggx):
    most = max(
        directional_albedo(gloss(specular, e, ggx), colour(1), direction(theta)).max()
        for e in (0.0, 10.0, 1e4)
        for specular in (0.04, 1.0)
        for theta in (0, 60, 89)
    )
    name = "GGX" if ggx else "Blinn"
    what = f"reflected by a {name} coat beyond what arrives"
    record("HC-42", what, "kernel", 0, max(most - 1, 0), 1e-3)


@by_monte_carlo
def test_hc43_dark_objects_on_bright_ground(record, technique):
    # The same object by falling instead of by rising scalars: normals turn to the viewer
    rising = blob()
    falling = Volume(1 - rising.values, rising.index_to_world)
    ramp = Curve([(0, 0), (1, 12.0)]), Curve([(0, 12.0), (1, 0)])
    means = []
    for seed, (vol, curve) in enumerate(zip((rising, falling), ramp, strict=True)):
        transfer = TransferFunction(None, WHITE, extinction=curve)
        surface = Surface(1.0, specular=0.3, exponent=20.0)
        lit = everything(PointLight((-1, -2, 1), 8.0), vol=vol, transfer=transfer, surface=surface)
        means.append(mean_and_error(picture_by(technique, lit, 64, seed)))
    (a, ea), (b, eb) = means
    record("HC-43", "object of falling scalars", technique, a, b, 4.5 * math.hypot(ea, eb))


# Lights


@pytest.mark.parametrize("lights", [(), SKY], ids=["no light", "one light"])
def test_hc44_emission_is_independent_of_lights(record, lights):
    # A black body: L = L_e (1 - exp(-tau))
    glowing = TransferFunction(
        None, ColourCurve([(0, 0, 0, 0)]), extinction=Curve([(0, 0), (1, 0.5)]), emission=WHITE,
        emission_scale=2.0,
    )  # fmt: skip
    picture = render(scene(slab((2, 2, 2)), glowing, lights=lights), 64)
    mean, error = mean_and_error(picture)
    what = f"black body, {len(lights)} lights"
    expected = 2 * -math.expm1(-1.0)
    record("HC-44", what, "monte-carlo single", expected, mean, 4.5 * error)


@pytest.mark.parametrize("technique", ["monte-carlo single", *OCCLUSION])
def test_hc46_without_lights_the_medium_is_black_and_there(record, technique):
    dark = scene(slab((2, 2, 2), 9), medium(3.0), frontal(0.9), (16, 16))
    picture = picture_by(technique, dark, 16)
    # Occlusion lights a scene that has no lights
    if technique in MONTE_CARLO:
        record("HC-46", "radiance without lights", technique, 0, picture.radiance.max(), 0)
    p = -math.expm1(-6.0)
    got = picture.alpha.mean(dtype=float)
    tolerance = 4.5 * math.sqrt(p * (1 - p) / 4096) if technique in MONTE_CARLO else 2e-3
    record("HC-46", "alpha without lights", technique, p, got, tolerance)
