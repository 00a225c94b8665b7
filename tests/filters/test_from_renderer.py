"""A filter made of a renderer shows what the renderer shows, and follows its edits."""

import logging

import numpy as np
import pytest
import vtkmodules.vtkRenderingOpenGL2
import vtkmodules.vtkRenderingVolumeOpenGL2
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane
from vtkmodules.vtkFiltersSources import vtkConeSource
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkCamera,
    vtkColorTransferFunction,
    vtkLight,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkTexture,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolume import vtkGPUVolumeRayCastMapper, vtkMultiVolume
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkSmartVolumeMapper

from vtkmcvr.filters import DirectionalOcclusionFilter, MonteCarloFilter, ToneMapFilter
from vtkmcvr.filters.scene_values import value_of
from vtkmcvr.lights import EnvironmentMap
from vtkmcvr.live.reading import SceneReader
from vtkmcvr.live.settings import LiveSettings
from vtkmcvr.pictures.display import srgb_decode
from vtkmcvr.scene import PixelFilter
from vtkmcvr.vtk_bridge.background import background_of
from vtkmcvr.vtk_bridge.environment import FROM_PANORAMA, environment_of
from vtkmcvr.vtk_bridge.props import volumes_of
from vtkmcvr.vtk_bridge.scene import array_of_image

SIZE = (32, 24)


def source(maximum=255):
    result = vtkRTAnalyticSource()
    result.SetWholeExtent(-6, 6, -6, 6, -6, 6)
    result.SetMaximum(maximum)
    return result


def volume(data, volume_property, x=0.0):
    mapper, result = vtkSmartVolumeMapper(), vtkVolume()
    mapper.SetInputConnection(data.GetOutputPort())
    result.SetMapper(mapper)
    result.SetProperty(volume_property)
    result.SetPosition(x, 0, 0)
    return result


def surface():
    cone, mapper, result = vtkConeSource(), vtkPolyDataMapper(), vtkActor()
    mapper.SetInputConnection(cone.GetOutputPort())
    result.SetMapper(mapper)
    result.GetProperty().SetColor(0.2, 0.4, 0.6)
    result.SetPosition(0, 12, 0)
    return result


def panorama():
    image, texture = vtkImageData(), vtkTexture()
    image.SetDimensions(8, 4, 1)
    values = np.random.default_rng(0).random((32, 3)).astype(np.float32)
    image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
    texture.SetInputData(image)
    return texture


def window_of(renderer):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    return window


@pytest.fixture
def renderer(pipeline):
    """Two volumes, one cut, a cone, two lights and a camera."""
    result, light, lamp = vtkRenderer(), vtkLight(), vtkLight()
    first, second = volume(source(), pipeline.property), volume(source(200), pipeline.property, 20)
    plane = vtkPlane()
    plane.SetNormal(0, 1, 0)
    first.GetMapper().AddClippingPlane(plane)
    for prop in (first, second, surface()):
        result.AddViewProp(prop)
    light.SetLightTypeToCameraLight()
    lamp.SetPosition(0, 50, 0)
    lamp.SetPositional(True)
    lamp.SetConeAngle(30)
    result.AddLight(light)
    result.AddLight(lamp)
    result.SetActiveCamera(pipeline.camera)
    pipeline.camera.SetWindowCenter(0.1, -0.2)
    window = window_of(result)
    yield result
    window.RemoveRenderer(result)


def scene_of(render):
    """Scene of a filter's inputs, without a picture."""
    scenes = []

    def keep(scene):
        scenes.append(scene)
        raise StopIteration

    render.render = keep
    with pytest.raises(StopIteration):
        render.Update()
    return scenes[0]


def test_it_is_the_scene_that_a_live_view_shows(renderer):
    renderer.UseImageBasedLightingOn()
    renderer.SetEnvironmentTexture(panorama())
    scene = scene_of(MonteCarloFilter.from_renderer(renderer, pixel_filter=PixelFilter("box", 0.5)))
    surfaces = [prop for prop in renderer.GetActors()]
    live = SceneReader().scene(
        renderer, SIZE, volumes_of(renderer), surfaces, None, LiveSettings()
    )  # fmt: skip
    assert scene.size == SIZE
    for name in ("transfer", "surface", "phase", "clip", "crop", "size", "pixel_filter"):
        assert value_of(getattr(scene, name)) == value_of(getattr(live, name)), name
    assert str(scene.camera) == str(live.camera)
    assert scene.lights[:2] == live.lights[:2]
    np.testing.assert_array_equal(scene.lights[2].pixels, live.lights[2].pixels)
    np.testing.assert_array_equal(scene.lights[2].rotation, live.lights[2].rotation)
    (other,), (expected,) = scene.layers, live.layers
    np.testing.assert_array_equal(other.volume.index_to_world, expected.volume.index_to_world)
    np.testing.assert_array_equal(other.volume.values, expected.volume.values)
    (mesh,), (same,) = scene.receivers, live.receivers
    assert mesh.colour == same.colour
    np.testing.assert_array_equal(mesh.points, same.points)


def labelled(pipeline):
    """Renderer of a volume with a label map, and the label's colour function."""
    labels, colour, opacity = vtkImageData(), vtkColorTransferFunction(), vtkPiecewiseFunction()
    pipeline.source.Update()
    labels.CopyStructure(pipeline.source.GetOutput())
    labels.AllocateScalars(VTK_UNSIGNED_CHAR, 1)
    labels.GetPointData().GetScalars().Fill(1)
    colour.AddRGBPoint(0, 0.5, 0.25, 0.1)
    opacity.AddPoint(0, 0.3)
    pipeline.property.SetLabelColor(1, colour)
    pipeline.property.SetLabelScalarOpacity(1, opacity)
    mapper, prop, renderer = vtkGPUVolumeRayCastMapper(), vtkVolume(), vtkRenderer()
    mapper.SetInputConnection(pipeline.source.GetOutputPort())
    mapper.SetMaskInput(labels)
    mapper.SetMaskTypeToLabelMap()
    mapper.SetMaskBlendFactor(1)
    prop.SetMapper(mapper)
    prop.SetProperty(pipeline.property)
    renderer.AddViewProp(prop)
    return renderer, colour


def test_colours_of_labels_are_decoded_in_a_live_view_too(pipeline):
    renderer, colour = labelled(pipeline)
    reader = SceneReader()

    def live():
        scene = reader.scene(renderer, SIZE, volumes_of(renderer), (), None, LiveSettings())
        return scene.labels.transfers[1]

    theirs = scene_of(MonteCarloFilter.from_renderer(renderer)).labels.transfers[1]
    assert value_of(live()) == value_of(theirs)
    np.testing.assert_allclose(live().colour([0.0])[0], srgb_decode(np.array((0.5, 0.25, 0.1))))
    # An edit of the label's function is noticed
    colour.RemoveAllPoints()
    colour.AddRGBPoint(0, 1, 1, 1)
    np.testing.assert_allclose(live().colour([0.0])[0], 1)


def edits(renderer):
    first, *_ = volumes_of(renderer)
    return {
        "property": lambda: first.GetProperty().GetScalarOpacity().AddPoint(200, 0.1),
        "place": lambda: first.SetPosition(1, 0, 0),
        "plane": lambda: first.GetMapper().GetClippingPlanes().GetItem(0).SetOrigin(0, 1, 0),
        "cropping": lambda: first.GetMapper().CroppingOn(),
        "camera": lambda: renderer.GetActiveCamera().Azimuth(10),
        "another camera": lambda: renderer.SetActiveCamera(vtkCamera()),
        "light": lambda: renderer.GetLights().GetItemAsObject(1).SetIntensity(0.5),
        "new light": lambda: renderer.AddLight(vtkLight()),
        "actor": lambda: renderer.GetActors().GetLastActor().SetPosition(0, 14, 0),
        "its colour": lambda: renderer.GetActors().GetLastActor().GetProperty().SetColor(1, 0, 0),
        "voxels": lambda: first.GetMapper().GetInputAlgorithm().SetMaximum(100),
    }


@pytest.mark.parametrize(
    "edit",
    ["property", "place", "plane", "cropping", "camera", "another camera", "light", "new light",
     "actor", "its colour", "voxels"],
)  # fmt: skip
def test_edits_of_the_renderer_are_seen(renderer, edit):
    render = MonteCarloFilter.from_renderer(renderer)
    before = value_of(scene_of(render))
    assert value_of(scene_of(render)) == before
    edits(renderer)[edit]()
    assert value_of(scene_of(render)) != before


def test_a_picture_of_a_renderer(pipeline, traced):
    """With the effects of the other pictures of these tests; the headlight is VTK's own."""
    renderer = vtkRenderer()
    renderer.AddViewProp(volume(pipeline.source, pipeline.property))
    renderer.SetActiveCamera(pipeline.camera)
    renderer.SetBackground(0.2, 0.4, 0.6)
    render = MonteCarloFilter.from_renderer(renderer, film_size=SIZE, samples=2, colours="linear")
    tone = ToneMapFilter.from_renderer(renderer)
    tone.SetInputConnection(render.GetOutputPort())
    tone.Update()
    shown = array_of_image(tone.GetOutputDataObject(0), "rgba")
    assert shown[0, 0].tolist() == [51, 102, 153, 255]
    assert tone.exposure == 2.5
    pipeline.render.Update()
    np.testing.assert_array_equal(render.picture.radiance, pipeline.render.picture.radiance)
    renderer.SetBackground(1, 1, 1)
    tone.Update()
    assert array_of_image(tone.GetOutputDataObject(0), "rgba")[0, 0].tolist() == [255] * 4
    assert len(traced) == 2


def test_what_is_left_out_is_said(renderer, caplog):
    actor = surface()
    actor.SetTexture(panorama())
    renderer.AddActor(actor)
    with caplog.at_level(logging.WARNING, "vtkmcvr"):
        render = MonteCarloFilter.from_renderer(renderer)
    assert "leaves out 1 props" in caplog.text
    assert len(render.actors) == 1
    caplog.clear()
    with caplog.at_level(logging.WARNING, "vtkmcvr"):
        assert DirectionalOcclusionFilter.from_renderer(renderer).actors == ()
    assert "leaves out 2 props of the renderer: it takes no meshes" in caplog.text


def test_what_cannot_be_is_refused(pipeline):
    renderer = vtkRenderer()
    with pytest.raises(ValueError, match="no visible volume"):
        MonteCarloFilter.from_renderer(renderer)
    several = vtkMultiVolume()
    several.SetMapper(vtkSmartVolumeMapper())
    renderer.AddViewProp(several)
    with pytest.raises(TypeError, match="a vtkMultiVolume is not supported"):
        MonteCarloFilter.from_renderer(renderer)
    sheared = vtkRenderer()
    sheared.AddViewProp(volume(pipeline.source, pipeline.property))
    sheared.GetActiveCamera().SetViewShear(0.1, 0, 1)
    with pytest.raises(ValueError, match="view shear"):
        MonteCarloFilter.from_renderer(sheared).Update()


def test_translucent_meshes_are_left_out_with_a_word(pipeline, caplog):
    renderer = vtkRenderer()
    renderer.AddViewProp(volume(pipeline.source, pipeline.property))
    actor = surface()
    actor.GetProperty().SetOpacity(0.5)
    renderer.AddActor(actor)
    with caplog.at_level(logging.WARNING, "vtkmcvr"):
        assert MonteCarloFilter.from_renderer(renderer).actors == ()
    assert "leaves out 1 props of the renderer: it takes opaque vtkPolyData" in caplog.text


def test_volumes_that_scatter_in_different_ways_are_refused(pipeline):
    """A scene has one phase function; one that is not asked for it takes any."""
    renderer, other = vtkRenderer(), vtkVolumeProperty()
    other.DeepCopy(pipeline.property)
    other.SetScatteringAnisotropy(0.4)
    for x, look in ((0.0, pipeline.property), (3.0, other)):
        renderer.AddViewProp(volume(pipeline.source, look, x))
    render = MonteCarloFilter.from_renderer(renderer, film_size=SIZE, samples=1)
    with pytest.raises(ValueError, match=r"anisotropies are 0, 0\.4"):
        render.Update()
    assert scene_of(DirectionalOcclusionFilter.from_renderer(renderer)).layers
    pipeline.property.SetScatteringAnisotropy(0.4)
    assert scene_of(MonteCarloFilter.from_renderer(renderer)).phase.g == pytest.approx(0.4)


def test_environment_of_a_cube_map_and_a_skybox(pipeline):
    renderer = vtkRenderer()
    renderer.AddViewProp(volume(pipeline.source, pipeline.property))
    renderer.SetEnvironmentTexture(panorama())
    assert not any(
        isinstance(light, EnvironmentMap)
        for light in scene_of(MonteCarloFilter.from_renderer(renderer)).lights
    )
    renderer.UseImageBasedLightingOn()
    scene = scene_of(MonteCarloFilter.from_renderer(renderer))
    assert isinstance(scene.lights[-1], EnvironmentMap)
    assert not scene.environment_visible
    skybox = vtkmodules.vtkRenderingOpenGL2.vtkOpenGLSkybox()
    skybox.SetTexture(panorama())
    renderer.AddActor(skybox)
    assert scene_of(MonteCarloFilter.from_renderer(renderer)).environment_visible


def test_rotation_of_the_environment_is_as_old_versions_have_it():
    renderer = vtkRenderer()
    renderer.SetEnvironmentTexture(panorama())
    renderer.UseImageBasedLightingOn()
    renderer.SetEnvironmentRight(0, 1, 0)
    renderer.SetEnvironmentUp(0, 0, 1)
    turn = environment_of(renderer).rotation @ np.linalg.inv(FROM_PANORAMA)
    np.testing.assert_allclose(turn, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-12)


# Backgrounds

RADIAL = "RADIAL_VIEWPORT_FARTHEST_"
MODES = ["VERTICAL", "HORIZONTAL", RADIAL + "SIDE", RADIAL + "CORNER"]


def drawn(renderer):
    """What VTK draws, [row, column, RGB], row 0 on top."""
    window = window_of(renderer)
    window.Render()
    values = vtkUnsignedCharArray()
    window.GetRGBACharPixelData(0, 0, SIZE[0] - 1, SIZE[1] - 1, 1, values)
    return vtk_to_numpy(values).reshape(SIZE[1], SIZE[0], 4)[::-1, :, :3].astype(int)


@pytest.mark.parametrize("mode", ["none", *MODES, "texture"])
def test_background_is_where_vtk_draws_it(mode):
    renderer = vtkRenderer()
    renderer.SetBackground(0.9, 0.1, 0.2)
    renderer.SetBackground2(0.1, 0.6, 1.0)
    if mode == "texture":
        texture = panorama()
        pixels = (np.arange(96).reshape(32, 3) * 2).astype(np.uint8)
        texture.GetInput().GetPointData().SetScalars(numpy_to_vtk(pixels, deep=True))
        texture.InterpolateOn()
        renderer.SetBackgroundTexture(texture)
        renderer.TexturedBackgroundOn()
    elif mode != "none":
        if not hasattr(renderer, "SetGradientMode"):
            pytest.skip("VTK before 9.3")
        renderer.GradientBackgroundOn()
        renderer.DitherGradientOff()
        renderer.SetGradientMode(getattr(renderer.GradientModes, f"VTK_GRADIENT_{mode}"))
    ours = np.broadcast_to(background_of(renderer, SIZE[1], SIZE[0]), (SIZE[1], SIZE[0], 3)) * 255
    assert np.abs(ours - drawn(renderer)).max() < 3
