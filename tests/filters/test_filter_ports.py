"""What each port takes and gives; few pictures are made."""

import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPolyData
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkImagingCore import vtkImageShiftScale
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkColorTransferFunction,
    vtkVolume,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from vtkmcvr.filters import DirectionalOcclusionFilter, MonteCarloFilter
from vtkmcvr.lights import EnvironmentMap
from vtkmcvr.receivers import MeshReceiver


def image(shape=(5, 6, 7), components=1, dtype=np.float32, seed=1):
    result = vtkImageData()
    result.SetDimensions(shape)
    count = int(np.prod(shape))
    values = (np.random.default_rng(seed).random((count, components)) * 100).astype(dtype)
    result.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
    return result


def look(opacity=0.5):
    function, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    result = vtkVolumeProperty()
    function.AddPoint(0, 0.0)
    function.AddPoint(100, opacity)
    colour.AddRGBPoint(0, 1.0, 0.5, 0.0)
    result.SetScalarOpacity(function)
    result.SetColor(colour)
    return result


def prop(volume_property, x=0.0):
    result = vtkVolume()
    result.SetProperty(volume_property)
    result.SetPosition(x, 0, 0)
    return result


def seen(render, **edits):
    """Scene that a filter renders of what arrives at its ports."""
    scenes = []

    def keep(scene):
        scenes.append(scene)
        raise StopIteration

    render.render = keep
    with pytest.raises(StopIteration):
        render.Update()
    return scenes[0]


# Inputs


def test_several_volumes_have_looks_and_places_of_their_own():
    render = MonteCarloFilter()
    for seed in (1, 2):
        render.AddInputDataObject(0, image(seed=seed))
    render.props = (prop(look(0.5)), prop(look(0.25), x=30.0))
    scene = seen(render)
    (other,) = scene.layers
    assert scene.transfer.opacity.nodes[1][1] == 0.5
    assert other.transfer.opacity.nodes[1][1] == 0.25
    assert scene.volume.index_to_world[0, 3] == 0.0
    assert other.volume.index_to_world[0, 3] == 30.0
    assert not np.array_equal(other.volume.values, scene.volume.values)
    # Without props, one look for all
    render.props = ()
    render.volume_property = look(0.75)
    scene = seen(render)
    assert scene.layers[0].transfer == scene.transfer


def test_cuts_of_a_props_mapper_are_its_own():
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.CroppingOn()
    mapper.SetCroppingRegionPlanes(1, 3, 1, 4, 2, 5)
    second = prop(look())
    second.SetMapper(mapper)
    render = MonteCarloFilter(props=(prop(look()), second))
    scene = render.scene(image(), image(seed=2))
    assert scene.crop is None
    assert scene.layers[0].crop.upper == (3.0, 4.0, 5.0)


def test_props_are_as_many_as_volumes():
    render = MonteCarloFilter(props=[prop(look())])
    with pytest.raises(ValueError, match="one vtkVolume for each of 2 inputs, got 1"):
        render.scene(image(), image())
    with pytest.raises(ValueError, match="one vtkActor for each of 0 meshes"):
        MonteCarloFilter(actors=[vtkActor()]).scene(image())
    with pytest.raises(TypeError, match="props are vtkVolume objects"):
        MonteCarloFilter(props=[look()])


def test_port_1_is_a_mask_or_labels():
    mask = image(dtype=np.uint8, seed=3)
    mask.GetPointData().GetScalars().SetValue(0, 7)
    render = MonteCarloFilter(volume_property=look())
    render.SetInputDataObject(0, image())
    render.SetInputDataObject(1, mask)
    scene = seen(render)
    np.testing.assert_array_equal(scene.mask.ravel(), scene_values(mask) > 0)
    assert scene.labels is None
    own = vtkPiecewiseFunction()
    own.AddPoint(0, 0.9)
    render.volume_property.SetLabelScalarOpacity(7, own)
    scene = seen(render)
    assert scene.mask is None
    assert list(scene.labels.transfers) == [7]
    render.mask_type = "mask"
    assert seen(render).labels is None
    with pytest.raises(ValueError, match="mask_type is one of auto, mask, labels"):
        render.SetMaskType("binary")


def scene_values(data):
    return np.array([data.GetPointData().GetScalars().GetTuple1(i) for i in range(210)])


def test_mask_of_another_grid_is_refused():
    render = MonteCarloFilter(volume_property=look())
    with pytest.raises(ValueError, match="mask must have the volume's grid of 5 x 6 x 7"):
        render.scene(image(), mask=image((4, 4, 4)))


def test_label_with_gradient_opacity_is_refused():
    render = MonteCarloFilter(volume_property=look())
    render.volume_property.SetLabelGradientOpacity(1, vtkPiecewiseFunction())
    labels = image(dtype=np.uint8)
    labels.GetPointData().GetScalars().Fill(1)
    with pytest.raises(ValueError, match="label 1 has a gradient opacity"):
        render.scene(image(), mask=labels)


def test_port_2_is_the_light_around():
    sky = image((8, 4, 1), components=3)
    render = MonteCarloFilter(volume_property=look())
    render.SetInputDataObject(0, image())
    render.SetInputDataObject(2, sky)
    (light,) = seen(render).lights
    assert isinstance(light, EnvironmentMap)
    assert seen(render).lights[0] is light
    sky.Modified()
    assert seen(render).lights[0] is not light
    with pytest.raises(ValueError, match="an environment is a flat image"):
        render.scene(image(), environment=image())


def test_port_3_is_surfaces():
    sphere, actor = vtkSphereSource(), vtkActor()
    actor.SetPosition(0, 0, 9)
    actor.GetProperty().SetColor(1.0, 0.0, 0.0)
    render = MonteCarloFilter(volume_property=look())
    render.SetInputDataObject(0, image())
    for _ in range(2):
        render.AddInputConnection(3, sphere.GetOutputPort())
    first, second = seen(render).receivers
    assert isinstance(first, MeshReceiver)
    assert first.colour == second.colour == (0.5, 0.5, 0.5)
    render.actors = (actor, vtkActor())
    moved, other = seen(render).receivers
    assert moved.colour == (1.0, 0.0, 0.0)
    assert moved.points[:, 2].mean() == pytest.approx(9.0, abs=1e-6)
    again = seen(render).receivers
    assert again[0] is moved
    assert again[1] is other


@pytest.mark.parametrize("port", [1, 2])
def test_wrong_type_at_a_port_says_which(port):
    render = MonteCarloFilter()
    render.SetInputDataObject(0, image())
    render.SetInputDataObject(port, vtkPolyData())
    with pytest.raises(TypeError, match=f"takes a vtkImageData, its input {port} gives vtkPoly"):
        render.Update()


def test_colours_of_a_display_are_decoded():
    render = MonteCarloFilter(volume_property=look())
    assert render.scene(image()).transfer.colour(np.array([0.0]))[0].tolist() == [1.0, 0.5, 0.0]
    render.colours = "display"
    shown = render.scene(image()).transfer.colour(np.array([0.0]))[0]
    np.testing.assert_allclose(shown, [1.0, 0.21404, 0.0], atol=1e-5)
    # Bytes of dependent components, too
    render.volume_property.IndependentComponentsOff()
    rgba = image(components=4, dtype=np.uint8)
    volume = render.scene(rgba).volume
    assert volume.colours.dtype == np.float32
    assert render.scene(rgba).volume is volume


def test_masks_and_layers_are_no_news_the_next_time(pipeline, traced):
    """Objects that are made for each request must not count as a change."""
    pipeline.source.Update()
    mask = vtkImageShiftScale()
    mask.SetInputConnection(pipeline.source.GetOutputPort())
    mask.SetShift(-100)
    mask.SetOutputScalarTypeToUnsignedChar()
    pipeline.render.SetInputConnection(1, mask.GetOutputPort())
    pipeline.tone.Update()
    pipeline.property.Modified()
    pipeline.render.Modified()
    pipeline.tone.Update()
    assert len(traced) == 1
    mask.SetShift(-150)
    pipeline.tone.Update()
    assert len(traced) == 2


# Statistics


def cell(table, name):
    column = table.GetColumnByName(name)
    return column.GetValue(0)


def test_statistics_are_those_of_the_picture(pipeline):
    pipeline.render.Update()
    table, picture = pipeline.render.GetOutputDataObject(1), pipeline.render.picture
    assert (table.GetClassName(), table.GetNumberOfRows()) == ("vtkTable", 1)
    assert cell(table, "samples") == 2
    assert cell(table, "seconds") == picture.seconds
    assert cell(table, "nrms") == picture.nrms
    assert cell(table, "stopped_by") == "samples"
    assert cell(table, "plan") == picture.plan.explain()
    assert cell(table, "rejected_samples") == 0


def test_statistics_of_a_technique_without_samples(pipeline):
    occlusion = DirectionalOcclusionFilter(
        film_size=(16, 12), volume_property=pipeline.property, camera=pipeline.camera
    )
    occlusion.SetInputConnection(pipeline.source.GetOutputPort())
    occlusion.Update()
    table = occlusion.GetOutputDataObject(1)
    assert np.isnan(cell(table, "nrms"))
    assert cell(table, "stopped_by") == "end"


def test_statistics_are_cleared_with_the_picture(pipeline):
    pipeline.render.Update()
    pipeline.property.SetScalarOpacity(vtkPiecewiseFunction())
    with pytest.raises(ValueError, match="no nodes"):
        pipeline.render.Update()
    assert pipeline.render.GetOutputDataObject(1).GetNumberOfRows() == 0
