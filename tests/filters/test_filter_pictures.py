"""What the filters show is where it should be, and as bright."""

import math

import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkImagingSources import vtkImageEllipsoidSource
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkCamera, vtkLight, vtkVolumeProperty

from vtkmcvr.filters import MonteCarloFilter, ToneMapFilter
from vtkmcvr.lights import ConstantEnvironment, DirectionalLight, EnvironmentMap
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Camera, HenyeyGreenstein, Lens, PixelFilter, Scene, Volume
from vtkmcvr.vtk_bridge.scene import array_of_image


def opaque_above(threshold):
    opacity, colour, result = vtkPiecewiseFunction(), vtkPiecewiseFunction(), vtkVolumeProperty()
    opacity.AddPoint(threshold, 0.0)
    opacity.AddPoint(threshold + 1, 1.0)
    colour.AddPoint(0, 1.0)
    result.SetScalarOpacity(opacity)
    result.SetColor(colour)
    return result


def ball(centre, size=21, radius=4):
    source = vtkImageEllipsoidSource()
    source.SetWholeExtent(0, size - 1, 0, size - 1, 0, size - 1)
    source.SetCenter(*centre)
    source.SetRadius(radius, radius, radius)
    source.SetInValue(255)
    source.SetOutValue(0)
    return source


def image_of(values, origin=(0, 0, 0), direction=None):
    image = vtkImageData()
    image.SetDimensions(values.shape[::-1])
    image.SetOrigin(origin)
    if direction is not None:
        image.SetDirectionMatrix(direction)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
    return image


def rendered(image, **settings):
    render = MonteCarloFilter(volume_property=opaque_above(100), **settings)
    render.SetInputDataObject(image)
    render.Update()
    return render.picture


@pytest.mark.parametrize(
    ("centre", "row", "column"),
    [((15, 15, 10), 0, 1), ((5, 15, 10), 0, 0), ((15, 5, 10), 1, 1), ((5, 5, 10), 1, 0)],
)
def test_up_and_right_are_up_and_right_in_a_png(tmp_path, centre, row, column):
    source = ball(centre)
    render = MonteCarloFilter(film_size=(32, 24), samples=4, volume_property=opaque_above(100))
    tone = ToneMapFilter(background=(0, 0, 0), exposure=2)
    writer = vtkPNGWriter()
    render.SetInputConnection(source.GetOutputPort())
    tone.SetInputConnection(render.GetOutputPort())
    writer.SetInputConnection(tone.GetOutputPort())
    writer.SetFileName(str(tmp_path / "ball.png"))
    writer.Write()
    reader = vtkPNGReader()
    reader.SetFileName(str(tmp_path / "ball.png"))
    reader.Update()
    pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    # VTK gives the bottom row of the file first
    shown = pixels.reshape(24, 32, 4)[::-1, :, 0].astype(float)
    quarters = shown.reshape(2, 12, 2, 16).sum(axis=(1, 3))
    assert np.unravel_index(quarters.argmax(), (2, 2)) == (row, column)
    assert quarters[row, column] > 0.95 * quarters.sum()


def test_direction_matrix_is_the_same_as_its_index_to_world_map():
    values = np.random.default_rng(0).integers(0, 255, (7, 8, 9)).astype(np.uint8)
    turn = (0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6)
    image = image_of(values, (1, 2, 3), turn)
    render = MonteCarloFilter(film_size=(16, 12), samples=2, volume_property=opaque_above(100))
    render.SetInputDataObject(image)
    render.Update()
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(turn, (3, 3))
    matrix[:3, 3] = (1, 2, 3)
    scene = render.plan.scene
    same = Scene(
        Volume(values, matrix), scene.transfer, scene.camera, scene.lights, size=scene.size
    )
    picture = render_scene(same, samples=2)
    np.testing.assert_allclose(picture.radiance, render.picture.radiance, atol=1e-5)


def test_turned_image_looks_like_turned_voxels():
    values = np.zeros((12, 12, 12), np.uint8)
    values[2:9, 7:11, 1:6] = 255
    # A quarter turn about z: index i runs along world y, index j along world -x
    turned = image_of(values, (11, 0, 0), (0, -1, 0, 1, 0, 0, 0, 0, 1))
    plain = image_of(np.ascontiguousarray(values.transpose(0, 2, 1)[:, :, ::-1]))
    settings = {"film_size": (32, 24), "samples": 16, "pixel_filter": PixelFilter("box", 0.5)}
    a, b = rendered(turned, **settings), rendered(plain, **settings)
    assert a.alpha.sum() > 20
    assert np.abs(a.alpha - b.alpha).mean() < 0.01
    both = (a.alpha == 1) & (b.alpha == 1)
    assert both.sum() > 20
    np.testing.assert_allclose(a.depth[both], b.depth[both], atol=0.5)


def test_parallel_projection_has_no_perspective():
    values = np.full((9, 9, 9), 255, np.uint8)
    camera = vtkCamera()
    camera.SetPosition(4, 4, 40)
    camera.SetFocalPoint(4, 4, 4)
    camera.ParallelProjectionOn()
    camera.SetParallelScale(8)
    picture = rendered(
        image_of(values), camera=camera, film_size=(32, 32), samples=1,
        pixel_filter=PixelFilter("box", 0.5),
    )  # fmt: skip
    # 8 of 16 world units, 32 pixels
    expected = np.zeros((32, 32))
    expected[8:24, 8:24] = 1
    np.testing.assert_array_equal(picture.alpha, expected)


def test_headlight_moves_with_the_camera():
    camera, light = vtkCamera(), vtkLight()
    camera.SetPosition(10, 10, 60)
    camera.SetFocalPoint(10, 10, 10)
    light.SetLightTypeToHeadlight()
    source = ball((10, 10, 10), radius=8)
    source.Update()
    fronts = []
    for _ in range(2):
        picture = rendered(
            source.GetOutput(), camera=camera, lights=[light], film_size=(32, 24), samples=16
        )
        fronts.append(picture.radiance.sum())
        camera.Azimuth(180)
    assert fronts[0] == pytest.approx(fronts[1], rel=0.1)
    light.SetLightTypeToSceneLight()
    light.SetPosition(10, 10, 60)
    light.SetFocalPoint(10, 10, 10)
    camera.Azimuth(180)
    behind = rendered(
        source.GetOutput(), camera=camera, lights=[light], film_size=(32, 24), samples=16
    )
    assert behind.radiance.sum() < 0.3 * fronts[0]


# Scenes that need no rays to be checked


def scene_of(**settings):
    render = MonteCarloFilter(film_size=(40, 20), **settings)
    return render.scene(image_of(np.zeros((3, 3, 3), np.uint8)))


def test_lights_are_vtks_headlight_unless_something_else_shines():
    (headlight,) = scene_of().lights
    assert headlight == DirectionalLight((0, 0, -1), math.pi)
    assert scene_of(ambient=0.5).lights == (ConstantEnvironment(0.5),)
    panorama = EnvironmentMap(np.ones((2, 4, 3)))
    assert scene_of(environment=panorama).lights == (panorama,)
    assert scene_of(lights=[]).lights == ()
    sun = DirectionalLight((1, 0, 0))
    assert scene_of(lights=[sun], ambient=1.0).lights == (sun, ConstantEnvironment(1.0))


def test_lens_surface_phase_and_camera_reach_the_scene():
    volume_property = vtkVolumeProperty()
    volume_property.ShadeOn()
    volume_property.SetScatteringAnisotropy(-0.5)
    scene = scene_of(volume_property=volume_property, gradient_factor=0.3, lens=Lens(2.0))
    assert scene.surface.gradient_factor == 0.3
    assert scene.phase == HenyeyGreenstein(-0.5)
    assert scene.camera.lens == Lens(2.0)
    assert (scene.scattering, scene.max_scatterings) == ("single", None)
    assert scene.size == (40, 20)
    own = Camera((0, 0, 9), (0, 0, 0), view_up=(0, 1, 0))
    assert scene_of(camera=own).camera is own
    assert scene_of(camera=own, lens=Lens(1.0)).camera.lens == Lens(1.0)


def test_order_of_scattering_reaches_the_scene():
    scene = scene_of(scattering="multiple", max_scatterings=5)
    assert (scene.scattering, scene.max_scatterings) == ("multiple", 5)
    assert scene_of(max_scatterings=5).max_scatterings is None


def test_gradient_opacity_and_dependent_colours_reach_the_scene():
    volume_property = vtkVolumeProperty()
    volume_property.GetGradientOpacity().AddPoint(10, 0.5)
    assert scene_of(volume_property=volume_property).transfer.gradient_opacity is not None
    rgba = np.zeros((3, 3, 3, 4), np.uint8)
    rgba[..., 1], rgba[..., 3] = 200, 9
    image = image_of(np.zeros((3, 3, 3), np.uint8))
    image.GetPointData().SetScalars(numpy_to_vtk(rgba.reshape(-1, 4), deep=True))
    # Independent components are volumes that overlap
    apart = MonteCarloFilter().scene(image)
    assert [apart.volume.values.max(), *(layer.volume.values.max() for layer in apart.layers)] == [
        0, 200, 0, 9,
    ]  # fmt: skip
    volume_property.IndependentComponentsOff()
    volume = MonteCarloFilter(volume_property=volume_property).scene(image).volume
    assert volume.values.max() == 9
    assert volume.colours[1, 1, 1].tolist() == [0, 200, 0]


def test_scalars_are_chosen_by_name():
    image = image_of(np.zeros((3, 3, 3), np.uint8))
    dose = numpy_to_vtk(np.ones(27), deep=True)
    dose.SetName("dose")
    image.GetPointData().AddArray(dose)
    assert MonteCarloFilter(scalars="dose").scene(image).volume.values.max() == 1.0


# Tone mapping


def test_tone_mapping_is_the_pictures_own(pipeline):
    pipeline.tone.Update()
    picture = pipeline.render.picture
    output = pipeline.tone.GetOutputDataObject(0)
    np.testing.assert_array_equal(array_of_image(output, "rgba"), picture.rgba)
    dark = array_of_image(output, "rgba").astype(int).sum()
    pipeline.tone.exposure = 2.0
    pipeline.tone.Update()
    bright = array_of_image(pipeline.tone.GetOutputDataObject(0), "rgba")
    assert bright.astype(int).sum() > dark
    pipeline.tone.background = (0.0, 0.0, 1.0)
    pipeline.tone.Update()
    shown = array_of_image(pipeline.tone.GetOutputDataObject(0), "rgba")
    assert shown[0, 0].tolist() == [0, 0, 255, 255]
