"""Lights as the user describes them: units, colours, textures, motion, errors."""

import math

import numpy as np
import pytest

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
    blackbody,
    checkerboard,
    headlight,
    irradiance_at,
    power_of,
    softbox,
    with_irradiance,
    with_power,
    with_vtk_intensity,
)
from vtkmcvr.lights.planck import chromatic_response
from vtkmcvr.scene import Camera
from vtkmcvr.vtk_bridge.lights import light_of

ORIGIN = (0.0, 0.0, 0.0)
POWER = (10.0, 20.0, 30.0)
SHAPES = {
    "rectangle": (RectangleLight((0, 0, 9), ORIGIN, (2, 3)), 6.0),
    "two-sided": (RectangleLight((0, 0, 9), ORIGIN, (2, 3), two_sided=True), 12.0),
    "disk": (DiskLight((0, 0, 9), ORIGIN, 2), 4 * math.pi),
    "ring": (DiskLight((0, 0, 9), ORIGIN, 2, inner_radius=1), 3 * math.pi),
    "sphere": (SphereLight((0, 0, 9), 2), 16 * math.pi),
    "box": (BoxLight((0, 0, 9), (1, 2, 3)), 22.0),
    "cylinder": (CylinderLight((0, 0, 9), (0, 4, 9), 1), 8 * math.pi),
    "capped": (CylinderLight((0, 0, 9), (0, 4, 9), 1, capped=True), 10 * math.pi),
}


@pytest.mark.parametrize("name", SHAPES)
def test_power_is_pi_times_area_times_radiance(name):
    light, area = SHAPES[name]
    bright = with_power(light, POWER)
    np.testing.assert_allclose(bright.radiance, np.divide(POWER, math.pi * area))
    np.testing.assert_allclose(power_of(bright), POWER)


@pytest.mark.parametrize("name", SHAPES)
def test_power_passes_through_a_sphere_around_the_light(name):
    light = with_power(SHAPES[name][0], POWER)
    # Midpoints in cosine and azimuth, the irradiance on the sphere from its inside
    z, phi = np.meshgrid((np.arange(10) + 0.5) / 5 - 1, (np.arange(20) + 0.5) * math.pi / 10)
    ring = np.sqrt(1 - z**2)
    out = np.stack([ring * np.cos(phi), ring * np.sin(phi), z], -1).reshape(-1, 3)
    centre = np.mean([patch.centre for patch in light.patches], axis=0)
    flux = np.mean([irradiance_at(light, centre + 30 * d, -d) for d in out], axis=0)
    np.testing.assert_allclose(4 * math.pi * 30**2 * flux, POWER, rtol=0.03)


def test_textured_light_has_the_power_that_was_asked_for():
    texture = Texture.of(checkerboard(4, 4))
    light = with_power(RectangleLight((0, 0, 9), ORIGIN, (2, 3), texture=texture), 5.0)
    np.testing.assert_allclose(light.radiance, 2 * 5.0 / (6 * math.pi), rtol=1e-6)


@pytest.mark.parametrize(
    ("cone_angle", "exponent"), [(180, 0), (120, 0), (35, 0), (40, 3), (90, 1)]
)
def test_power_of_point_and_spot_lights(cone_angle, exponent):
    light = with_power(PointLight(ORIGIN, cone_angle=cone_angle, exponent=exponent), POWER)
    cosine = (np.arange(200_000) + 0.5) / 100_000 - 1
    lit = cosine > math.cos(math.radians(cone_angle))
    falloff = np.where(lit, np.maximum(cosine, 0) ** exponent if exponent else 1.0, 0)
    integral = 2 * math.pi * 2 * falloff.mean()
    np.testing.assert_allclose(np.multiply(light.intensity, integral), POWER, rtol=1e-4)


def test_irradiance_of_lights_in_closed_form():
    r, h = 0.7, 2.0
    sphere, disk = SphereLight((0, 0, h), r), DiskLight((0, 0, h), ORIGIN, r)
    assert irradiance_at(sphere, ORIGIN)[0] == pytest.approx(math.pi * r**2 / h**2, rel=1e-3)
    assert irradiance_at(disk, ORIGIN)[0] == pytest.approx(math.pi * r**2 / (r**2 + h**2), rel=1e-3)
    assert irradiance_at(PointLight((0, 0, h), 8.0), ORIGIN)[0] == pytest.approx(2.0)
    assert irradiance_at(DirectionalLight((0, 0, -1), 3.0), ORIGIN, (0, 3, 4))[0] == pytest.approx(
        2.4
    )
    assert irradiance_at(ConstantEnvironment(2.0), ORIGIN)[0] == pytest.approx(2 * math.pi)


@pytest.mark.parametrize("name", SHAPES)
def test_light_of_a_given_irradiance(name):
    light = with_irradiance(SHAPES[name][0], (1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    np.testing.assert_allclose(irradiance_at(light, (0.1, 0.2, 0.3)), (1.0, 2.0, 3.0))


def test_intensity_as_in_vtk():
    from vtkmodules.vtkRenderingCore import vtkCamera, vtkLight

    light = vtkLight()
    light.SetLightTypeToSceneLight()
    light.SetPosition(0, 0, 5)
    light.SetIntensity(0.8)
    sun = with_vtk_intensity(DirectionalLight((0, 0, -1)), 0.8)
    assert light_of(light, vtkCamera()).irradiance == pytest.approx(sun.irradiance)
    light.SetPositional(True)
    light.SetAttenuationValues(0, 0, 1)
    light.SetConeAngle(90)
    lamp = with_vtk_intensity(PointLight((0, 0, 5)), 0.8)
    assert light_of(light, vtkCamera()).intensity == pytest.approx(lamp.intensity)
    panel = with_vtk_intensity(SphereLight((0, 0, 5), 1), 0.8, ORIGIN)
    assert irradiance_at(panel, ORIGIN) == pytest.approx(irradiance_at(sun, ORIGIN))
    with pytest.raises(ValueError, match="at a place: give one"):
        with_vtk_intensity(panel, 1.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: with_power(DirectionalLight((0, 0, 1)), 1), "DirectionalLight has no power"),
        (lambda: power_of(PointLight(ORIGIN, attenuation=(1, 0, 0))), "no finite power"),
        (lambda: irradiance_at(EnvironmentMap(np.ones((1, 1, 3))), ORIGIN), "not known in advance"),
        (
            lambda: with_irradiance(RectangleLight((0, 0, 1), ORIGIN, (1, 1)), 1, (0, 0, 2)),
            "no light",
        ),
        (lambda: irradiance_at(PointLight(ORIGIN), ORIGIN), "that of the light"),
        (lambda: with_power(SphereLight(ORIGIN, 1), -1), "power must not be negative"),
        (lambda: blackbody(500), "kelvin must be from 1000 to 40000, got 500"),
        (
            lambda: DiskLight((0, 0, 1), ORIGIN, 1, inner_radius=1),
            "inner_radius must be below.*= 1, got",
        ),
        (lambda: DiskLight((0, 0, 1), (0, 0, 1), 1), "light.target - light.centre"),
        (lambda: SphereLight(ORIGIN, 0), "radius must be above 0"),
        (lambda: SphereLight(ORIGIN, 1, texture=np.ones((2, 2))), "texture must be a Texture"),
        (lambda: BoxLight(ORIGIN, (1, 0, 1)), "light size along y must be above 0"),
        (lambda: CylinderLight(ORIGIN, ORIGIN, 1), "light.end - light.start"),
        (lambda: Texture(np.ones((2, 2, 4))), r"shape \(rows, columns, 3\), got \(2, 2, 4\)"),
        (lambda: Texture([[-1.0]]), "not negative"),
        (lambda: Texture.of(lambda s, t: s, (0, 1)), "texture columns"),
        (lambda: softbox(0), "softbox edge"),
        (lambda: CameraLight(ConstantEnvironment()), "holds an area.*got ConstantEnvironment"),
        (lambda: GradientEnvironment(-1, 0, 0), "light.top must not be negative"),
        (lambda: GradientEnvironment(1, 0, 0, up=ORIGIN), "light.up"),
    ],
)
def test_errors_say_what_is_wrong(call, message):
    with pytest.raises(ValueError, match=message):
        call()


# Black bodies


def chromaticity(kelvin):
    xyz = chromatic_response(kelvin)
    return xyz[:2] / xyz.sum()


@pytest.mark.parametrize(
    ("kelvin", "expected"),
    # Planckian locus of the CIE 1931 observer; 2856 K is illuminant A
    [(2000, (0.5267, 0.4133)), (2856, (0.4476, 0.4074)), (4000, (0.3805, 0.3768)),
     (6500, (0.3135, 0.3237)), (10000, (0.2807, 0.2884))],
)  # fmt: skip
def test_black_bodies_lie_on_the_planckian_locus(kelvin, expected):
    # The fits of the colour matching functions leave 3e-3
    assert chromaticity(kelvin) == pytest.approx(expected, abs=4e-3)


def test_black_bodies_have_the_luminance_that_was_asked_for():
    luminance = np.array((0.2126, 0.7152, 0.0722))
    for kelvin in (1000, 1500, 3200, 6500, 40000):
        assert np.dot(blackbody(kelvin), luminance) == pytest.approx(1)
        assert np.dot(blackbody(kelvin, 7.0), luminance) == pytest.approx(7)
        assert min(blackbody(kelvin)) >= 0
    red, _, blue = np.array([blackbody(k) for k in (1500, 3000, 6000, 12000)]).T
    assert (np.diff(red) < 0).all()
    assert (np.diff(blue) > 0).all()
    # Daylight's neighbour is nearly white in Rec. 709
    np.testing.assert_allclose(blackbody(6500), 1, atol=0.08)


# Textures


def test_texture_of_a_function_has_its_first_row_on_top():
    texture = Texture.of(lambda s, t: s + 10 * t, (4, 2))
    np.testing.assert_allclose(texture.pixels[..., 0], [[7.625, 7.875, 8.125, 8.375],
                                                        [2.625, 2.875, 3.125, 3.375]])  # fmt: skip
    np.testing.assert_allclose(texture.mean, 5.5)


def test_patterns():
    board = Texture.of(checkerboard(2, 2, dark=0.25), (4, 4)).pixels[..., 0]
    np.testing.assert_array_equal(board[2:, :2], 1)
    np.testing.assert_array_equal(board[:2, :2], 0.25)
    box = Texture.of(softbox(0.5), (64, 64)).pixels[..., 0]
    assert box[32, 32] == 1
    assert box[0].max() < 0.01
    assert (np.diff(box[32, :32]) >= 0).all()


# Lights fixed to the camera


def test_camera_lights_stand_where_vtk_puts_them():
    from vtkmodules.vtkRenderingCore import vtkLight

    from vtkmcvr.vtk_bridge.scene import vtk_camera_of

    camera = Camera((3, -8, 2), (1, 2, 3), (0.1, 0.2, 1))
    light = vtkLight()
    light.SetLightTypeToCameraLight()
    light.SetPosition(0.3, 0.4, 1.2)
    light.SetFocalPoint(0.1, 0.0, 0.0)
    light.SetPositional(True)
    light.SetConeAngle(30)
    theirs = light_of(light, vtk_camera_of(camera))
    ours = CameraLight(
        PointLight((0.3, 0.4, 1.2), direction=(-0.2, -0.4, -1.2), cone_angle=30)
    ).seen_by(camera)
    np.testing.assert_allclose(ours.position, theirs.position, atol=1e-9)
    np.testing.assert_allclose(ours.direction, theirs.direction, atol=1e-9)


def test_area_lights_move_and_scale_with_the_camera():
    camera = Camera((0, -10, 0), (0, 0, 0))
    panel = CameraLight(RectangleLight((1, 0, 1), ORIGIN, (0.2, 0.1), 3.0, up=(0, 1, 0)))
    moved = panel.seen_by(camera)
    np.testing.assert_allclose(moved.centre, (10, -10, 0), atol=1e-9)
    np.testing.assert_allclose(moved.target, ORIGIN, atol=1e-9)
    np.testing.assert_allclose(moved.up, (0, 0, 1), atol=1e-9)
    assert moved.size == pytest.approx((2.0, 1.0))
    assert moved.radiance == (3.0, 3.0, 3.0)
    assert headlight(2.0).seen_by(camera) == DirectionalLight((0, 1, 0), 2.0)
    ring = CameraLight(DiskLight((0, 0, 1), ORIGIN, 0.2, inner_radius=0.1)).seen_by(camera)
    assert (ring.radius, ring.inner_radius) == pytest.approx((2.0, 1.0))
