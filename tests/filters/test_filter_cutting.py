"""What a filter takes from a mapper and from meshes; no picture is made."""

import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction, vtkPlane
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkVolumeProperty
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from vtkmcvr.cutting import Plane
from vtkmcvr.filters import MonteCarloFilter
from vtkmcvr.receivers import MeshReceiver, SphereReceiver


def image(components=1):
    result = vtkImageData()
    result.SetDimensions(5, 6, 7)
    values = np.random.default_rng(1).random((210, components)).astype(np.float32)
    result.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
    return result


def mapper_with_plane():
    plane, mapper = vtkPlane(), vtkOpenGLGPUVolumeRayCastMapper()
    plane.SetNormal(0, 1, 0)
    mapper.AddClippingPlane(plane)
    return mapper, plane


def test_mapper_gives_clipping_cropping_and_mask():
    mapper, _ = mapper_with_plane()
    mapper.CroppingOn()
    mapper.SetCroppingRegionPlanes(1, 3, 1, 4, 2, 5)
    mapper.SetMaskInput(image())
    mapper.SetMaskTypeToBinary()
    data = image()
    scene = MonteCarloFilter(mapper=mapper).scene(data)
    assert scene.clip == (Plane((0, 0, 0), (0, 1, 0)),)
    assert (scene.crop.lower, scene.crop.upper) == ((1, 1, 2), (3, 4, 5))
    assert scene.mask.shape == (7, 6, 5)
    assert scene.labels is None
    assert MonteCarloFilter().scene(data).clip == ()


def test_fractions_in_a_label_map_are_refused():
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    mapper.SetMaskInput(image())
    mapper.SetMaskTypeToLabelMap()
    volume_property = vtkVolumeProperty()
    volume_property.SetLabelScalarOpacity(1, vtkPiecewiseFunction())
    volume_property.GetLabelScalarOpacity(1).AddPoint(0, 1)
    with pytest.raises(ValueError, match="whole numbers"):
        MonteCarloFilter(mapper=mapper, volume_property=volume_property).scene(image())


def test_an_edited_plane_modifies_the_filter():
    mapper, plane = mapper_with_plane()
    algorithm = MonteCarloFilter(mapper=mapper)
    before = algorithm.GetMTime()
    plane.SetOrigin(0, 2, 0)
    assert algorithm.GetMTime() > before
    added = vtkPlane()
    mapper.AddClippingPlane(added)
    before = algorithm.GetMTime()
    added.SetNormal(1, 0, 0)
    assert algorithm.GetMTime() > before


def test_meshes_become_receivers_once():
    source = vtkSphereSource()
    source.Update()
    ball = SphereReceiver((0, 0, 0), 1.0)
    algorithm = MonteCarloFilter(receivers=[source.GetOutput(), ball])
    first, second = algorithm.scene(image()).receivers
    assert isinstance(first, MeshReceiver)
    assert second is ball
    assert algorithm.scene(image()).receivers[0] is first
    with pytest.raises(TypeError, match="receiver"):
        MonteCarloFilter(receivers=[3])


def test_independent_components_become_volumes_in_one_place():
    scene = MonteCarloFilter(mapper=mapper_with_plane()[0]).scene(image(2))
    (layer,) = scene.layers
    assert layer.volume.shape == scene.volume.shape
    assert layer.clip == scene.clip
