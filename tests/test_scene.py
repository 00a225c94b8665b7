"""Bad input is refused with a sentence that names the value and what is allowed."""

import dataclasses

import numpy as np
import pytest
from scenes import WHITE, frontal, medium, noise, render, scene, slab

from vtkmcvr.curves import Curve
from vtkmcvr.lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    PointLight,
    RectangleLight,
)
from vtkmcvr.scene import (
    Camera,
    Cone,
    HenyeyGreenstein,
    Lens,
    PixelFilter,
    Rayleigh,
    Surface,
    TransferFunction,
    TransferTable,
    Volume,
)

NAN, INF = float("nan"), float("inf")
EYE = np.eye(4)


def matrix(**changes):
    m = np.eye(4)
    for place, value in changes.items():
        m[int(place[1]), int(place[2])] = value
    return m


def camera(position=(0, -1, 0), focal_point=(0, 0, 0), **options):
    return Camera(position, focal_point, **options)


def rectangle(**options):
    return RectangleLight(**{"centre": (0, 0, 1), "target": (0, 0, 0), "size": (1, 1), **options})


BAD = {
    "flat array": (lambda: Volume(np.zeros(5)), r"shape \(k, j, i\).*\(5,\)"),
    "2-D image": (lambda: Volume(np.zeros((1, 4, 5))), "two points.*2-D image.*5 x 4 x 1"),
    "colour image": (lambda: Volume(np.zeros((4, 4, 4, 3))), r"one scalar.*\(4, 4, 4, 3\)"),
    "complex": (lambda: Volume(np.zeros((2, 2, 2), complex)), "real.*complex128"),
    "text": (lambda: Volume(np.full((2, 2, 2), "x")), "real.*<U1"),
    "3x3 matrix": (lambda: Volume(np.zeros((2, 2, 2)), np.eye(3)), "4x4"),
    "NaN matrix": (lambda: Volume(np.zeros((2, 2, 2)), matrix(m00=NAN)), "finite 4x4"),
    "flat matrix": (lambda: Volume(np.zeros((2, 2, 2)), matrix(m11=0)), "invertible"),
    "singular": (lambda: Volume(np.zeros((2, 2, 2)), matrix(m01=1, m10=1)), "invertible"),
    "perspective": (lambda: Volume(np.zeros((2, 2, 2)), matrix(m30=1)), "affine.*1.0"),
    "no density": (lambda: TransferFunction(None, WHITE), "exactly one"),
    "two densities": (
        lambda: TransferFunction(Curve([(0, 0)]), WHITE, extinction=Curve([(0, 0)])),
        "exactly one",
    ),
    "opacity": (lambda: TransferFunction(Curve([(0, 1.5)]), WHITE), "opacity.*0 to 1.*1.5"),
    "negative": (lambda: TransferFunction(Curve([(0, -0.5)]), WHITE), "negative.*-0.5"),
    "unit distance": (
        lambda: TransferFunction(Curve([(0, 1)]), WHITE, unit_distance=0),
        "unit_distance.*above 0.*0",
    ),
    "density scale": (
        lambda: TransferFunction(Curve([(0, 1)]), WHITE, density_scale=-1),
        "density_scale.*-1",
    ),
    "gradient factor": (lambda: Surface(1.5), "gradient_factor.*0 to 1.*1.5"),
    "specular": (lambda: Surface(specular=2.0), "specular.*0 to 1.*2"),
    "specular shape": (lambda: Surface(specular=(1, 0)), "specular.*three"),
    "exponent": (lambda: Surface(exponent=-1), "exponent.*-1"),
    "huge exponent": (lambda: Surface(exponent=1e7), r"exponent.*0 to 1e\+06"),
    "lens radius": (lambda: Lens(-1), "lens.radius.*at least 0.*-1"),
    "focus": (lambda: Lens(1, 0), "focus_distance.*above 0"),
    "NaN camera": (lambda: camera((NAN, 0, 0)), "camera.position.*finite.*nan"),
    "short vector": (lambda: camera((1, 0)), "camera.position.*three"),
    "infinite focal point": (lambda: camera(focal_point=(INF, 0, 0)), "focal_point.*finite"),
    "no distance": (lambda: camera((0, 0, 0)), "position and camera.focal_point are both"),
    "parallel view up": (lambda: camera(view_up=(0, 2, 0)), "view_up.*parallel.*choose another"),
    "zero view up": (lambda: camera(view_up=(0, 0, 0)), r"view_up.*not be \(0, 0, 0\)"),
    "view angle": (lambda: camera(view_angle=180), "view_angle.*180"),
    "zero angle": (lambda: camera(view_angle=0), "view_angle.*above 0"),
    "parallel scale": (lambda: camera(parallel_scale=0), "parallel_scale.*above 0"),
    "window centre": (lambda: camera(window_centre=(NAN, 0)), "window_centre.*finite"),
    "filter": (lambda: PixelFilter("sinc"), "gaussian, box, tent.*'sinc'"),
    "filter width": (lambda: PixelFilter("box", 0), "width.*above 0"),
    "environment": (lambda: ConstantEnvironment(-1), "environment radiance.*negative"),
    "map shape": (lambda: EnvironmentMap(np.ones((4, 4))), r"\(rows, columns, 3\).*\(4, 4\)"),
    "map too wide": (
        lambda: EnvironmentMap(np.ones((1, 2**17 + 1, 3))),
        r"at most 131072 rows and columns, got 1 x 131073; make it smaller",
    ),
    "map NaN": (lambda: EnvironmentMap(np.full((1, 1, 3), NAN)), "finite and not negative"),
    "map negative": (lambda: EnvironmentMap(np.full((1, 1, 3), -1)), "finite and not negative"),
    "map scale": (lambda: EnvironmentMap(np.ones((1, 1, 3)), -2), "scale.*-2"),
    "map rotation": (
        lambda: EnvironmentMap(np.ones((1, 1, 3)), rotation=2 * np.eye(3)),
        "rotation",
    ),
    "map mirror": (
        lambda: EnvironmentMap(np.ones((1, 1, 3)), rotation=np.diag([1, 1, -1])),
        "rotation",
    ),
    "rectangle": (lambda: rectangle(size=(0, 1)), "light width.*above 0"),
    "rectangle size": (lambda: rectangle(size=(1, INF)), "light height.*finite"),
    "rectangle target": (lambda: rectangle(target=(0, 0, 1)), r"target.*\(0, 0, 0\)"),
    "rectangle colour": (lambda: rectangle(radiance=(1, -1, 0)), "radiance.*negative"),
    "direction": (lambda: DirectionalLight((0, 0, 0)), "light.direction"),
    "NaN light": (lambda: DirectionalLight((0, 0, 1), NAN), "irradiance.*finite"),
    "attenuation": (lambda: PointLight((0, 0, 0), attenuation=(0, 0, 0)), "attenuation"),
    "cone": (lambda: PointLight((0, 0, 0), cone_angle=0), "cone_angle.*above 0"),
    "spot exponent": (lambda: PointLight((0, 0, 0), exponent=-1), "exponent.*-1"),
    "film": (lambda: scene(size=(0, 10)), "film width.*at least 1.*0"),
    "film height": (lambda: scene(size=(10, 2.5)), "film height.*whole.*2.5"),
    "phase": (lambda: HenyeyGreenstein(1.0), "g must be.*got 1"),
    "cone of no width": (lambda: Cone(0.0), "angle.*0.01 to 180.*0"),
    "no phase": (lambda: scene(phase=0.5), r"Isotropic\(\), Henyey.*0.5"),
    "g of Rayleigh": (
        lambda: scene(
            transfer=TransferFunction(Curve([(0, 1)]), WHITE, g=Curve([(0, 0)])), phase=Rayleigh()
        ),
        "needs an Isotropic.*Rayleigh",
    ),
    "scattering": (lambda: scene(scattering="some"), "single, multiple.*some"),
    "scatterings": (
        lambda: scene(scattering="multiple", max_scatterings=0),
        "max_scatterings.*at least 1",
    ),
    "many of one": (lambda: scene(max_scatterings=3), 'scattering="multiple"'),
    "short light": (lambda: scene(scattering="multiple", shadow_reach=2), "shadow_reach at inf.*2"),
    "estimator": (lambda: scene(estimator="guess"), "majorant-grid, woodcock, ray-march.*guess"),
    "step": (lambda: scene(step=0.0), "step.*above 0"),
    "mode": (lambda: Surface(mode="always"), "hybrid, brdf, threshold.*always"),
    "coat": (lambda: Surface(coat="phong"), "blinn, ggx.*phong"),
    "two coats": (
        lambda: TransferFunction(
            Curve([(0, 1)]), WHITE, specular=WHITE, refraction_index=Curve([(0, 1.5)])
        ),
        "specular or refraction_index",
    ),
    "index": (
        lambda: TransferFunction(Curve([(0, 1)]), WHITE, refraction_index=Curve([(0, 0.5)])),
        "refraction_index is at least 1.*0.5",
    ),
    "g of a transfer function": (
        lambda: TransferFunction(Curve([(0, 1)]), WHITE, g=Curve([(0, -1)])),
        "g goes from -0.9999.*-1",
    ),
    "table and opacity": (
        lambda: TransferFunction(
            Curve([(0, 1)]), WHITE, table=TransferTable(np.ones((2, 2, 4)), (0, 1), (0, 1))
        ),
        "exactly one.*2",
    ),
    "table shape": (
        lambda: TransferTable(np.ones((2, 4)), (0, 1), (0, 1)),
        r"\(gradients, scalars, 4\)",
    ),
    "table range": (
        lambda: TransferTable(np.ones((2, 2, 4)), (1, 0), (0, 1)),
        "scalar_range.*1 to 0",
    ),
    "table values": (lambda: TransferTable(np.full((2, 2, 4), 2.0), (0, 1), (0, 1)), "0 to 1"),
    "backward phase": (lambda: HenyeyGreenstein(-1.0), "g must be.*-1"),
    "reach": (lambda: scene(shadow_reach=-1), "shadow_reach.*-1"),
    "NaN reach": (lambda: scene(shadow_reach=NAN), "shadow_reach.*nan"),
    "sampling": (lambda: scene(light_sampling="bsdf"), "mis, light, scatter.*'bsdf'"),
    "two maps": (
        lambda: scene(lights=(ConstantEnvironment(), ConstantEnvironment())),
        "one ConstantEnv",
    ),
    "samples": (lambda: render(scene(), samples=-1), "samples.*at least 1.*-1"),
    "no samples": (lambda: render(scene(), samples=0), "samples.*at least 1.*0"),
    "half samples": (lambda: render(scene(), samples=1.5), "samples.*whole.*1.5"),
    "seconds": (lambda: render(scene(), seconds=0), "seconds.*above 0"),
    "seed": (lambda: render(scene(), seed=-1), "seed.*at least 0.*-1"),
    "huge seed": (lambda: render(scene(size=(1, 1)), samples=1, seed=2**64), "seed"),
    "threads": (lambda: render(scene(), threads=0), "threads.*at least 1"),
}


@pytest.mark.parametrize(("make", "words"), BAD.values(), ids=BAD)
def test_bad_input_is_named(make, words):
    with pytest.raises(ValueError, match=f"(?s){words}"):
        make()


def test_scenes_are_frozen():
    with pytest.raises(dataclasses.FrozenInstanceError):
        scene().phase = HenyeyGreenstein(0.5)
    with pytest.raises(dataclasses.FrozenInstanceError):
        camera().view_angle = 3


def test_geometry_of_a_volume():
    m = np.array([[0, -2.0, 0, 10], [1, 0, 0, 20], [0, 0, 3, 30], [0, 0, 0, 1]])
    vol = Volume(np.zeros((5, 4, 3)), m)
    assert vol.shape == (3, 4, 5)
    np.testing.assert_allclose(vol.centre, (7, 21, 36))
    np.testing.assert_allclose(vol.spacing, (1, 2, 3))
    np.testing.assert_allclose(vol.corners.min(axis=0), (4, 20, 30))
    np.testing.assert_allclose(vol.corners.max(axis=0), (10, 22, 42))
    assert vol.radius == pytest.approx(np.linalg.norm((3, 1, 6)))


def test_frame_of_a_camera_is_right_handed():
    right, up, forward = camera((0, -5, 0)).frame
    np.testing.assert_allclose([right, up, forward], [(1, 0, 0), (0, 0, 1), (0, 1, 0)])


def test_one_number_is_grey():
    assert ConstantEnvironment(0.5).radiance == (0.5, 0.5, 0.5)
    assert Surface(specular=0.25).specular == (0.25, 0.25, 0.25)


def test_directions_of_any_length_are_taken():
    for length in (1e-200, 1.0, 1e200):
        light = DirectionalLight((0, 3 * length, -4 * length))
        assert light.direction == pytest.approx((0, 0.6, -0.8))
    # The light of a rectangle that looks along its own `up`
    right, up, normal = rectangle(up=(0, 0, 1)).frame
    np.testing.assert_allclose(
        np.array([right, up, normal]) @ np.array([right, up, normal]).T, np.eye(3)
    )
    np.testing.assert_allclose(np.cross(right, up), normal)


@pytest.mark.parametrize("g", [-0.9999, 0.9999])
def test_extreme_phase_functions_reject_no_sample(g):
    picture = render(
        scene(
            noise(),
            medium(3.0),
            lights=(ConstantEnvironment(),),
            phase=HenyeyGreenstein(g),
            shadow_reach=0,
        ),
        16,
    )
    assert picture.rejected_samples == 0
    np.testing.assert_allclose(picture.radiance[..., 0], picture.alpha, atol=1e-3)


def test_helpers_build_what_they_say():
    vol = slab((2, 4, 6), centre=(1, 2, 3))
    np.testing.assert_allclose(vol.corners.min(axis=0), (0, 0, 0))
    assert frontal(2.0).parallel_scale == 2.0
