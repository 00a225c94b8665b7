import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import (
    vtkBox,
    vtkCylinder,
    vtkImageData,
    vtkPiecewiseFunction,
    vtkPlane,
    vtkPlaneCollection,
    vtkPlanes,
    vtkPolyData,
    vtkSphere,
)
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from vtkmcvr.cutting import CROSS, FENCE, SUBVOLUME, Box, Plane, Sphere
from vtkmcvr.receivers import SphereReceiver
from vtkmcvr.vtk_bridge.cutting import clip_of, cropping_of, shapes_of
from vtkmcvr.vtk_bridge.labels import label_transfers_of, mask_of
from vtkmcvr.vtk_bridge.mesh import MeshCache, mesh_of
from vtkmcvr.vtk_bridge.scene import volume_of


def plane(origin=(1, 2, 3), normal=(0, 0, 2)):
    result = vtkPlane()
    result.SetOrigin(origin)
    result.SetNormal(normal)
    return result


def collection(*planes):
    result = vtkPlaneCollection()
    for item in planes:
        result.AddItem(item)
    return result


def inside(shape, x):
    if isinstance(shape, Plane):
        return np.dot(np.subtract(x, shape.origin), shape.normal) >= 0
    if isinstance(shape, Sphere):
        return np.linalg.norm(np.subtract(x, shape.centre)) <= shape.radius
    local = np.subtract(x, shape.centre) @ shape.axes
    return bool((np.abs(local) <= np.array(shape.size) / 2).all())


def turned_box():
    box = vtkBox()
    box.SetBounds(-1, 2, 0, 3, 1, 1.5)
    transform = vtkTransform()
    transform.Translate(1, 2, 3)
    transform.RotateWXYZ(40, 1, 2, 3)
    box.SetTransform(transform)
    return box


def straight_box():
    box = vtkBox()
    box.SetBounds(-1, 2, 0, 3, 1, 1.5)
    return box


def ball():
    result = vtkSphere()
    result.SetCenter(0.5, 1, -1)
    result.SetRadius(1.5)
    return result


@pytest.mark.parametrize("make", [turned_box, straight_box, ball])
def test_boxes_and_spheres_keep_what_vtk_calls_inside(make):
    function = make()
    (shape,) = shapes_of(function)
    points = np.random.default_rng(1).uniform(-5, 5, (4000, 3))
    expected = [function.FunctionValue(x) <= 0 for x in points]
    assert [inside(shape, x) for x in points] == expected
    assert 5 < sum(expected) < 3000
    (hole,) = shapes_of(function, keep="outside")
    assert hole.keep == "outside"


def test_planes_keep_the_side_of_their_normals_as_mappers_do():
    (single,) = shapes_of(plane())
    assert single == Plane((1, 2, 3), (0, 0, 1))
    mapper = vtkFixedPointVolumeRayCastMapper()
    assert clip_of(mapper) == ()
    mapper.AddClippingPlane(plane())
    mapper.AddClippingPlane(plane(normal=(1, 0, 0)))
    assert [p.normal for p in clip_of(mapper)] == [(0, 0, 1), (1, 0, 0)]
    frustum = vtkPlanes()
    frustum.SetBounds(0, 1, 0, 2, 0, 3)
    mapper.SetClippingPlanes(frustum)
    assert clip_of(mapper) == shapes_of(frustum)
    assert len(clip_of(mapper)) == 6
    assert shapes_of([collection(plane()), Sphere((0, 0, 0), 1)])[1].radius == 1


def test_what_cannot_clip_is_named():
    with pytest.raises(TypeError, match="got vtkCylinder"):
        shapes_of(vtkCylinder())
    moved = ball()
    moved.SetTransform(vtkTransform())
    with pytest.raises(ValueError, match="vtkSphere with a transform"):
        shapes_of(moved)
    box = straight_box()
    stretch = vtkTransform()
    stretch.Scale(1, 2, 1)
    box.SetTransform(stretch)
    with pytest.raises(ValueError, match="rotation with a translation"):
        shapes_of(box)


def image_with(values=None, cells=False, extent=(2, 6, -1, 3, 7, 12)):
    image = vtkImageData()
    image.SetExtent(*extent)
    image.SetSpacing(0.5, 1.5, 2)
    image.SetOrigin(10, -20, 30)
    dims = [max(1, n - 1) if cells else n for n in image.GetDimensions()]
    count = int(np.prod(dims))
    flat = np.arange(count, dtype=np.int16) if values is None else np.asarray(values).ravel()
    array = numpy_to_vtk(flat, deep=True)
    (image.GetCellData() if cells else image.GetPointData()).SetScalars(array)
    return image


@pytest.mark.parametrize("cells", [False, True])
def test_cropping_planes_are_at_the_same_place_in_index_coordinates(cells):
    image, mapper = image_with(cells=cells), vtkFixedPointVolumeRayCastMapper()
    volume = volume_of(image)
    assert cropping_of(mapper, image, volume) is None
    mapper.CroppingOn()
    bounds = (11.2, 12.3, -20, -16, 45, 51)
    mapper.SetCroppingRegionPlanes(bounds)
    for flags in (SUBVOLUME, FENCE, CROSS):
        mapper.SetCroppingRegionFlags(flags)
        crop = cropping_of(mapper, image, volume)
        assert crop.flags == flags
    world = volume.index_to_world
    ends = [world[:3, :3] @ end + world[:3, 3] for end in (crop.lower, crop.upper)]
    np.testing.assert_allclose(np.stack(ends, 1).ravel(), bounds)


def test_region_flags_are_those_of_vtk():
    mapper = vtkFixedPointVolumeRayCastMapper()
    for name, flags in (("SubVolume", SUBVOLUME), ("Fence", FENCE), ("Cross", CROSS)):
        getattr(mapper, f"SetCroppingRegionFlagsTo{name}")()
        assert mapper.GetCroppingRegionFlags() == flags


def labelled_property():
    result = vtkVolumeProperty()
    result.SetScalarOpacityUnitDistance(2.5)
    opacity, colour = vtkPiecewiseFunction(), vtkColorTransferFunction()
    opacity.AddPoint(0, 0.1)
    opacity.AddPoint(10, 0.7)
    colour.AddRGBPoint(0, 0.2, 0.4, 0.8)
    result.SetLabelScalarOpacity(3, opacity)
    result.SetLabelColor(5, colour)
    return result


def test_labels_get_their_functions_and_otherwise_those_of_the_volume():
    found = label_transfers_of(labelled_property(), [0, 3, 4, 5])
    assert sorted(found) == [3, 5]
    assert found[3].opacity.nodes[-1][:2] == (10, 0.7)
    assert found[3].unit_distance == 2.5
    assert found[5].colour(0).ravel().tolist() == pytest.approx([0.2, 0.4, 0.8])
    assert label_transfers_of(vtkVolumeProperty(), [1, 2]) == {}


def test_mask_and_label_map_of_a_mapper():
    assert mask_of(vtkFixedPointVolumeRayCastMapper(), vtkVolumeProperty()) == (None, None)
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    assert mask_of(mapper, vtkVolumeProperty()) == (None, None)
    values = (np.arange(5 * 5 * 6) % 7).astype(np.uint8)
    mapper.SetMaskInput(image_with(values))
    mapper.SetMaskTypeToBinary()
    mask, labels = mask_of(mapper, labelled_property())
    assert labels is None
    assert mask.shape == (6, 5, 5)
    mapper.SetMaskTypeToLabelMap()
    mask, labels = mask_of(mapper, labelled_property())
    assert mask is None
    np.testing.assert_array_equal(labels.values.ravel(), values)
    assert sorted(labels.transfers) == [3, 5]
    mapper.SetMaskBlendFactor(0.5)
    with pytest.raises(ValueError, match=r"blend factor is 0\.5"):
        mask_of(mapper, labelled_property())


def test_mesh_of_polygons_is_triangles_in_float64():
    cube = vtkCubeSource()
    cube.SetCenter(1e6, 0, 0)
    cube.SetOutputPointsPrecision(1)
    cube.Update()
    mesh = mesh_of(cube.GetOutput(), colour=(0.1, 0.2, 0.3), exponent=5.0)
    assert mesh.triangles.shape == (12, 3)
    assert mesh.points.dtype == np.float64
    assert mesh.colour == (0.1, 0.2, 0.3)
    np.testing.assert_array_equal(mesh.points.max(0), (1e6 + 0.5, 0.5, 0.5))
    assert mesh_of(cube.GetOutput(), smooth=False).normals is None


def test_user_matrix_moves_points_and_turns_normals():
    source = vtkSphereSource()
    source.Update()
    matrix = np.diag([2.0, 1, 1, 1])
    matrix[:3, 3] = (5, 6, 7)
    mesh = mesh_of(source.GetOutput(), user_matrix=matrix)
    local = (mesh.points - (5, 6, 7)) / (2, 1, 1)
    # Normals of the ellipsoid: gradient of (x/2)^2 + y^2 + z^2
    expected = local / (2, 1, 1)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    found = mesh.normals / np.linalg.norm(mesh.normals, axis=1, keepdims=True)
    assert np.abs(found - expected).max() < 0.05


def test_what_is_no_surface_is_named():
    with pytest.raises(TypeError, match=r"got .*ImageData"):
        mesh_of(vtkImageData())
    with pytest.raises(ValueError, match="no polygon"):
        mesh_of(vtkPolyData())


def test_meshes_are_kept_while_they_are_unchanged():
    source = vtkSphereSource()
    source.Update()
    data, receiver, cache = source.GetOutput(), SphereReceiver((0, 0, 0), 1), MeshCache()
    first = cache.receivers((data, receiver))
    assert first[1] is receiver
    assert cache.receivers((data,))[0] is first[0]
    data.Modified()
    assert cache.receivers((data,))[0] is not first[0]


def test_box_from_bounds():
    box = Box.from_bounds((0, 2, 1, 4, -1, 1))
    assert (box.centre, box.size) == ((1, 2.5, 0), (2, 3, 2))
