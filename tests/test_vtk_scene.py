"""VTK objects become the parts of a scene that they stand for, compared with VTK's own answers."""

import math
from dataclasses import replace

import numpy as np
import pytest
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import (
    vtkImageData,
    vtkPiecewiseFunction,
    vtkPolyData,
    vtkRectilinearGrid,
)
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkRenderingCore import (
    vtkCamera,
    vtkColorTransferFunction,
    vtkLight,
    vtkLightCollection,
    vtkRenderer,
    vtkVolumeProperty,
)
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper

from vtkmcvr.lights import ConstantEnvironment, DirectionalLight, PointLight
from vtkmcvr.scene import Camera, Lens, Stereo
from vtkmcvr.vtk_bridge.scene import (
    VolumeCache,
    array_of_image,
    camera_of,
    default_camera,
    default_headlight,
    image_of_arrays,
    light_of,
    lights_of,
    looks_of,
    matrix_of,
    phase_of,
    refuse_mapper_features,
    surface_of,
    transfer_of,
    volume_of,
    vtk_camera_of,
)

ROTATION = (0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6)


def image_with(cells=False, components=1, name="ct", dtype=np.int16):
    image = vtkImageData()
    image.SetExtent(2, 5, -1, 3, 7, 12)
    image.SetOrigin(10, -20, 30)
    image.SetSpacing(0.5, 0.7, 1.5)
    image.SetDirectionMatrix(*ROTATION)
    count = image.GetNumberOfCells() if cells else image.GetNumberOfPoints()
    array = numpy_to_vtk(np.arange(count * components).astype(dtype).reshape(count, -1), deep=True)
    array.SetName(name)
    (image.GetCellData() if cells else image.GetPointData()).SetScalars(array)
    return image


# Volume


def test_volume_has_vtks_index_to_world_map_and_shares_memory():
    image = image_with()
    volume = volume_of(image)
    assert volume.shape == (4, 5, 6)
    for i, j, k in ((2, -1, 7), (5, 3, 12), (3, 0, 9)):
        expected = [0.0, 0.0, 0.0]
        image.TransformIndexToPhysicalPoint(i, j, k, expected)
        assert (volume.index_to_world @ (i - 2, j + 1, k - 7, 1))[:3] == pytest.approx(expected)
        value = image.GetScalarComponentAsDouble(i, j, k, 0)
        assert volume.values[k - 7, j + 1, i - 2] == value
    volume.values[0, 0, 0] = 77
    assert image.GetScalarComponentAsDouble(2, -1, 7, 0) == 77


def test_values_of_cells_stand_at_their_centres():
    image = image_with(cells=True)
    volume = volume_of(image)
    assert volume.shape == (3, 4, 5)
    bounds = image.GetCell(0).GetBounds()
    centre = [(bounds[2 * a] + bounds[2 * a + 1]) / 2 for a in range(3)]
    assert volume.index_to_world[:3, 3] == pytest.approx(centre)


@pytest.mark.parametrize("as_vtk", [True, False])
def test_user_matrix_comes_after_the_images_map(as_vtk):
    transform = vtkTransform()
    transform.Translate(1, 2, 3)
    transform.RotateX(30)
    matrix = transform.GetMatrix()
    given = matrix if as_vtk else matrix_of(matrix)
    volume = volume_of(image_with(), user_matrix=given)
    expected = matrix_of(matrix) @ volume_of(image_with()).index_to_world
    np.testing.assert_allclose(volume.index_to_world, expected, rtol=0, atol=1e-12)


def test_scalars_are_the_active_the_named_or_the_only_array():
    image = image_with()
    extra = numpy_to_vtk(np.full(image.GetNumberOfPoints(), 5.0), deep=True)
    extra.SetName("dose")
    image.GetPointData().AddArray(extra)
    assert volume_of(image).values.dtype == np.int16
    assert volume_of(image, scalars="dose").values.max() == 5.0
    image.GetPointData().SetActiveScalars(None)
    with pytest.raises(ValueError, match="no active scalars; name one of its arrays: 'ct', 'dose'"):
        volume_of(image)
    image.GetPointData().RemoveArray("ct")
    assert volume_of(image).values.max() == 5.0


def flat_image():
    image = vtkImageData()
    image.SetDimensions(4, 4, 1)
    image.AllocateScalars(4, 1)
    return image


@pytest.mark.parametrize(
    ("image", "error", "message"),
    [
        (None, TypeError, "got None: has its source been updated"),
        (np.zeros((2, 2, 2)), TypeError, "got ndarray"),
        (vtkPolyData(), TypeError, "got vtkPolyData; resample it onto a regular grid"),
        (vtkRectilinearGrid(), TypeError, "vtkRectilinearGrid.*vtkResampleToImage"),
        (vtkImageData(), ValueError, "has no scalars"),
        (image_with(components=3), ValueError, "'ct' has 3 components.*vtkImageExtractComponents"),
        (flat_image(), ValueError, "at least two points along each axis"),
    ],
)
def test_what_is_no_volume_is_refused_in_one_sentence(image, error, message):
    with pytest.raises(error, match=message):
        volume_of(image)


def test_unknown_array_is_named_with_those_that_exist():
    with pytest.raises(ValueError, match="no array 'mr'; it has 'ct'"):
        volume_of(image_with(), scalars="mr")


def test_cache_keeps_the_volume_while_the_image_is_unchanged():
    cache, image = VolumeCache(), image_with()
    volume = cache.volume(image)
    assert cache.volume(image) is volume
    image.GetPointData().GetScalars().Modified()
    assert cache.volume(image) is not volume
    volume = cache.volume(image)
    assert cache.volume(image, "ct") is not volume
    assert cache.volume(image_with(), "ct") is not volume


# Transfer function


def random_opacity(rng):
    function = vtkPiecewiseFunction()
    function.SetClamping(bool(rng.integers(2)))
    for x in rng.choice(200, rng.integers(1, 7), replace=False) - 50.0:
        sharpness = rng.choice([0.0, rng.random(), 1.0])
        function.AddPoint(x, rng.random(), rng.random(), sharpness)
    return function


def random_colour(rng):
    function = vtkColorTransferFunction()
    function.SetClamping(bool(rng.integers(2)))
    for x in rng.choice(200, rng.integers(1, 7), replace=False) - 50.0:
        sharpness = rng.choice([0.0, rng.random(), 1.0])
        function.AddRGBPoint(x, *rng.random(3), rng.random(), sharpness)
    return function


def property_with(opacity=None, colour=None):
    result = vtkVolumeProperty()
    result.SetScalarOpacity(opacity or random_opacity(np.random.default_rng(0)))
    result.SetColor(colour or random_colour(np.random.default_rng(0)))
    return result


def places(rng, function):
    nodes = np.linspace(*function.GetRange(), 5)
    return np.concatenate([rng.uniform(-80, 180, 300), nodes])


def vtk_colours(function, x):
    return np.array([function.GetColor(v) for v in x])


@pytest.mark.parametrize("seed", range(30))
def test_random_functions_are_exact(seed):
    rng = np.random.default_rng(seed)
    opacity, colour = random_opacity(rng), random_colour(rng)
    transfer = transfer_of(property_with(opacity, colour))
    x = places(rng, opacity)
    np.testing.assert_allclose(transfer.opacity(x), [opacity.GetValue(v) for v in x], atol=1e-12)
    x = places(rng, colour)
    np.testing.assert_allclose(transfer.colour(x), vtk_colours(colour, x), atol=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_random_grey_functions_agree(seed):
    rng = np.random.default_rng(seed)
    grey = random_opacity(rng)
    volume_property = property_with(colour=grey)
    assert volume_property.GetColorChannels() == 1
    colour = transfer_of(volume_property).colour
    assert volume_property.GetColorChannels() == 1
    x = places(rng, grey)
    expected = np.array([[grey.GetValue(v)] * 3 for v in x])
    sharp = any(node[5] > 0.99 for node in colour.nodes) or len(colour.nodes) > 100
    np.testing.assert_allclose(colour(x), expected, atol=0.02 if sharp else 1e-12)


@pytest.mark.parametrize("space", ["HSV", "HSVNoWrap", "Lab", "Diverging", "Step"])
def test_other_colour_spaces_are_sampled(space):
    function = vtkColorTransferFunction()
    setter = {"HSVNoWrap": "HSV"}.get(space, space)
    getattr(function, f"SetColorSpaceTo{setter}")()
    function.SetHSVWrap(space != "HSVNoWrap")
    for x, r, g, b in ((0, 0.2, 0.3, 0.8), (40, 0.9, 0.9, 0.9), (100, 0.7, 0.05, 0.1)):
        function.AddRGBPoint(x, r, g, b)
    colour = transfer_of(property_with(colour=function)).colour
    x = np.setdiff1d(np.linspace(-10, 120, 997), (0, 40, 100))
    expected = np.clip(vtk_colours(function, x), 0, 1)
    difference = np.abs(colour(x) - expected).max(axis=1)
    # Beside a step lies a ramp of one sample
    assert (difference > 1e-3).mean() < (0.02 if space in ("Step", "HSV") else 0.001)


def test_steps_of_ciede2000_are_kept():
    function = vtkColorTransferFunction()
    function.SetColorSpaceToLabCIEDE2000()
    function.AddRGBPoint(0, 0.2, 0.3, 0.8)
    function.AddRGBPoint(100, 0.7, 0.05, 0.1)
    colour = transfer_of(property_with(colour=function)).colour
    x = np.arange(5, 100, 15)
    # VTK walks a lattice of 8-bit colours: next to a step of it, neighbours differ
    np.testing.assert_allclose(colour(x), vtk_colours(function, x), atol=0.03)


def test_logarithmic_scales_are_sampled():
    colour = vtkColorTransferFunction()
    colour.AddRGBPoint(0.01, 0, 0, 1)
    colour.AddRGBPoint(1000, 1, 0.5, 0)
    colour.SetScaleToLog10()
    opacity = vtkPiecewiseFunction()
    opacity.AddPoint(0.01, 0)
    opacity.AddPoint(1000, 1)
    opacity.UseLogScaleOn()
    transfer = transfer_of(property_with(opacity, colour))
    x = np.geomspace(0.005, 2000, 777)
    np.testing.assert_allclose(transfer.colour(x), vtk_colours(colour, x), atol=1e-3)
    np.testing.assert_allclose(transfer.opacity(x), [opacity.GetValue(v) for v in x], atol=1e-3)


@pytest.mark.parametrize("clamping", [True, False])
def test_colours_below_and_above_the_range(clamping):
    function = vtkColorTransferFunction()
    function.AddRGBPoint(0, 0.5, 0.5, 0.5)
    function.AddRGBPoint(100, 1, 1, 1)
    function.SetClamping(clamping)
    function.SetBelowRangeColor(1, 0, 0)
    function.UseBelowRangeColorOn()
    colour = transfer_of(property_with(colour=function)).colour
    x = np.array([-1e6, -5, 0, 50, 100, 105, 1e6])
    np.testing.assert_allclose(colour(x), vtk_colours(function, x), atol=1e-3)


def test_a_new_property_has_vtks_defaults():
    volume_property = vtkVolumeProperty()
    transfer = transfer_of(volume_property)
    assert transfer.opacity.nodes == ((0.0, 1.0, 0.5, 0.0), (1024.0, 1.0, 0.5, 0.0))
    assert transfer.colour(512).tolist() == [0.5, 0.5, 0.5]
    time = volume_property.GetMTime()
    transfer_of(volume_property)
    assert volume_property.GetMTime() == time
    assert not volume_property.HasGradientOpacity()


def test_unit_distance_and_phase():
    volume_property = property_with()
    volume_property.SetScalarOpacityUnitDistance(2.5)
    volume_property.SetScatteringAnisotropy(0.6)
    assert transfer_of(volume_property).unit_distance == 2.5
    assert phase_of(volume_property).g == pytest.approx(0.6)


def test_surface_only_with_shading():
    volume_property = property_with()
    volume_property.SetSpecular(0.2)
    volume_property.SetSpecularPower(10)
    assert surface_of(volume_property) is None
    volume_property.ShadeOn()
    surface = surface_of(volume_property, gradient_factor=0.25)
    assert surface.gradient_factor == 0.25
    assert surface.exponent == 40.0
    assert surface.specular == pytest.approx((8 * 0.2 / 42,) * 3)
    volume_property.SetSpecularPower(0)
    assert surface_of(volume_property).specular == pytest.approx((0.8,) * 3)


def two_d(volume_property):
    volume_property.SetTransferFunction2D(flat_image())
    volume_property.SetTransferFunctionModeTo2D()


def gradient_opacity(volume_property):
    volume_property.GetGradientOpacity().AddPoint(5, 0.2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (two_d, "vtkImageData with four components; call SetTransferFunction2D"),
        (lambda p: p.SetScalarOpacity(vtkPiecewiseFunction()), "vtkPiecewiseFunction has no nodes"),
        (lambda p: p.GetRGBTransferFunction().IndexedLookupOn(), "indexed .* not supported yet"),
    ],
)
def test_what_is_not_supported_is_named(change, message):
    volume_property = property_with()
    change(volume_property)
    with pytest.raises(ValueError, match=message):
        transfer_of(volume_property)


def test_gradient_opacity_is_a_curve_where_it_has_an_effect():
    volume_property = property_with()
    assert transfer_of(volume_property).gradient_opacity is None
    volume_property.GetGradientOpacity()
    assert transfer_of(volume_property).gradient_opacity is None
    gradient_opacity(volume_property)
    curve = transfer_of(volume_property).gradient_opacity
    function = volume_property.GetStoredGradientOpacity()
    x = np.linspace(-1, 300, 500)
    np.testing.assert_allclose(curve(x), [function.GetValue(v) for v in x], atol=1e-12)
    volume_property.DisableGradientOpacityOn()
    assert transfer_of(volume_property).gradient_opacity is None


def rgba_table(columns, rows):
    """TF_2D function whose red counts columns and whose opacity counts rows."""
    table = vtkImageData()
    table.SetDimensions(columns, rows, 1)
    j, i = np.mgrid[:rows, :columns]
    rgba = np.stack([i / columns, 0 * i, 0 * i + 1.0, j / rows], -1).reshape(-1, 4)
    table.GetPointData().SetScalars(numpy_to_vtk(rgba.astype(np.float32), deep=True))
    return table


def test_2d_function_spans_scalars_and_a_quarter_of_them():
    volume_property = property_with()
    volume_property.SetTransferFunction2D(rgba_table(8, 4))
    volume_property.SetTransferFunctionModeTo2D()
    with pytest.raises(ValueError, match="give scalar_range"):
        transfer_of(volume_property)
    volume_property.SetScalarOpacityUnitDistance(2.5)
    transfer = transfer_of(volume_property, scalar_range=(-100.0, 300.0))
    table = transfer.table
    assert (table.scalar_range, table.gradient_range) == ((-100, 300), (0, 100))
    assert table.rgba[3, 5].tolist() == pytest.approx([5 / 8, 0, 1, 3 / 4])
    assert transfer.unit_distance == 2.5


def test_independent_components_are_volumes_with_their_own_functions():
    image = image_with(components=2)
    volume_property = property_with()
    volume_property.SetComponentWeight(1, 0.25)
    volume_property.SetScalarOpacityUnitDistance(1, 3.0)
    volume_property.ShadeOn(1)
    first, second = looks_of(image, volume_property)
    i, j, k = first.volume.shape
    np.testing.assert_array_equal(first.volume.values.ravel(), np.arange(0, 2 * i * j * k, 2))
    np.testing.assert_array_equal(second.volume.values.ravel(), np.arange(1, 2 * i * j * k, 2))
    np.testing.assert_array_equal(first.volume.index_to_world, second.volume.index_to_world)
    assert (first.transfer.density_scale, second.transfer.density_scale) == (1.0, 0.25)
    assert (first.transfer.unit_distance, second.transfer.unit_distance) == (1.0, 3.0)
    assert first.surface is None
    assert second.surface is not None


def test_four_dependent_components_are_colours_and_a_scalar():
    image = image_with(components=4, dtype=np.uint8)
    volume_property = property_with()
    volume_property.IndependentComponentsOff()
    (look,) = looks_of(image, volume_property)
    raw = np.arange(look.volume.values.size * 4).astype(np.uint8).reshape(-1, 4)
    np.testing.assert_array_equal(look.volume.values.ravel(), raw[:, 3])
    np.testing.assert_array_equal(look.volume.colours.reshape(-1, 3), raw[:, :3])


def test_two_dependent_components_are_a_colour_by_function_and_a_scalar():
    image = image_with(components=2)
    volume_property = property_with()
    volume_property.IndependentComponentsOff()
    (look,) = looks_of(image, volume_property)
    raw = np.arange(look.volume.values.size * 2).reshape(-1, 2)
    np.testing.assert_array_equal(look.volume.values.ravel(), raw[:, 1])
    function = volume_property.GetRGBTransferFunction()
    expected = [function.GetColor(float(x)) for x in raw[:, 0]]
    np.testing.assert_allclose(look.volume.colours.reshape(-1, 3), expected, atol=1e-6)


def test_three_dependent_components_are_refused():
    volume_property = property_with()
    volume_property.IndependentComponentsOff()
    with pytest.raises(ValueError, match=r"four \(red.*got 3"):
        looks_of(image_with(components=3), volume_property)


def test_cache_keeps_each_component_while_the_image_is_unchanged():
    image, cache = image_with(components=2), VolumeCache()
    first, second = cache.volume(image, component=0), cache.volume(image, component=1)
    assert first is not second
    assert cache.volume(image, component=0) is first
    image.Modified()
    assert cache.volume(image, component=0) is not first


def test_blend_modes_are_refused_by_name():
    mapper = vtkOpenGLGPUVolumeRayCastMapper()
    refuse_mapper_features(mapper)
    mapper.SetBlendModeToMaximumIntensity()
    with pytest.raises(ValueError, match="blend mode"):
        refuse_mapper_features(mapper)


# Camera


def random_camera(rng):
    camera = vtkCamera()
    camera.SetPosition(rng.normal(size=3) * 50)
    camera.SetFocalPoint(rng.normal(size=3) * 5)
    camera.SetViewUp(rng.normal(size=3))
    camera.SetViewAngle(rng.uniform(5, 100))
    camera.SetParallelScale(rng.uniform(1, 50))
    camera.SetWindowCenter(*rng.uniform(-0.7, 0.7, 2))
    camera.SetParallelProjection(bool(rng.integers(2)))
    return camera


def on_film(camera, aspect, point):
    """Film coordinates from -1 to 1, by the definition of `Camera`."""
    right, up, forward = camera.frame
    v = np.subtract(point, camera.position)
    if camera.parallel_scale is None:
        half_height = math.tan(math.radians(camera.view_angle) / 2) * (v @ forward)
    else:
        half_height = camera.parallel_scale
    x, y = camera.window_centre
    return v @ right / half_height / aspect - x, v @ up / half_height - y


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("horizontal", [False, True])
def test_points_land_where_vtk_projects_them(seed, horizontal):
    rng = np.random.default_rng(seed)
    vtk_camera, aspect = random_camera(rng), rng.uniform(0.5, 2)
    vtk_camera.SetUseHorizontalViewAngle(horizontal)
    camera = camera_of(vtk_camera, aspect=aspect)
    to_film = matrix_of(vtk_camera.GetCompositeProjectionTransformMatrix(aspect, -1, 1))
    for point in np.array(camera.focal_point) + rng.normal(size=(5, 3)):
        x, y, _, w = to_film @ (*point, 1.0)
        assert on_film(camera, aspect, point) == pytest.approx((x / w, y / w), abs=1e-9)


def test_camera_goes_to_vtk_and_back():
    camera = camera_of(random_camera(np.random.default_rng(3)))
    assert camera_of(vtk_camera_of(camera)) == camera


def test_depth_of_field_is_asked_for_by_a_focal_distance_or_a_lens():
    # As VTK's ray tracer has it: a focal distance of 0 is none, the focal disk a diameter
    camera = vtkCamera()
    camera.SetFocalDisk(7.0)
    assert camera_of(camera).lens is None
    camera.SetFocalDistance(12.0)
    assert camera_of(camera).lens == Lens(3.5, 12.0)
    assert camera_of(camera, Lens(2.0)).lens == Lens(2.0)


def test_lens_and_eyes_go_to_vtk_and_back():
    camera = replace(
        camera_of(random_camera(np.random.default_rng(3))),
        lens=Lens(2.5, 40.0),
        stereo=Stereo("right", 3.0),
    )
    assert camera_of(vtk_camera_of(camera), eyes="right") == camera
    # Focus on the focal point
    near = replace(camera, lens=Lens(1.0))
    assert camera_of(vtk_camera_of(near)).lens == Lens(1.0, near.distance)
    assert camera_of(vtk_camera_of(replace(camera, lens=None))).lens is None


def test_headlight_follows_a_panorama_too():
    light = vtkLight()
    light.SetLightTypeToHeadlight()
    ahead = Camera((1, 2, 3), (1, 9, 3), panorama=True)
    assert light_of(light, ahead) == light_of(light, replace(ahead, panorama=False))


def test_vtk_has_no_panorama():
    with pytest.raises(ValueError, match="panorama"):
        vtk_camera_of(Camera((0, 0, 0), (0, 1, 0), panorama=True))


def explicit_projection(camera):
    camera.SetExplicitProjectionTransformMatrix(vtkMatrix4x4())
    camera.UseExplicitProjectionTransformMatrixOn()


def model_transform(camera):
    matrix = vtkMatrix4x4()
    matrix.SetElement(0, 3, 1.0)
    camera.SetModelTransformMatrix(matrix)


@pytest.mark.parametrize(
    ("change", "feature"),
    [
        (lambda c: c.SetViewShear(0.1, 0.0, 1.0), "view shear"),
        (lambda c: c.SetUserTransform(vtkTransform()), "a user transform"),
        (lambda c: c.SetUserViewTransform(vtkTransform()), "a user view transform"),
        (model_transform, "a model transform"),
        (explicit_projection, "an explicit projection matrix"),
        (lambda c: c.UseOffAxisProjectionOn(), "off-axis projection"),
    ],
)
def test_views_that_cannot_be_expressed_are_refused(change, feature):
    camera = vtkCamera()
    change(camera)
    with pytest.raises(ValueError, match=f"uses {feature}, which is not supported yet"):
        camera_of(camera)


def test_horizontal_view_angle_needs_the_aspect():
    camera = vtkCamera()
    camera.UseHorizontalViewAngleOn()
    with pytest.raises(ValueError, match="aspect is needed"):
        camera_of(camera)


@pytest.mark.parametrize("aspect", [0.5, 1.0, 2.0])
def test_default_camera_sees_every_corner(aspect):
    volume = volume_of(image_with())
    camera = default_camera(volume, aspect)
    film = np.array([on_film(camera, aspect, corner) for corner in volume.corners])
    assert 0.3 < np.abs(film).max() < 1.0


# Lights


@pytest.mark.parametrize("kind", ["Headlight", "CameraLight", "SceneLight"])
@pytest.mark.parametrize("positional", [False, True])
def test_lights_stand_where_a_renderer_puts_them(kind, positional):
    camera = random_camera(np.random.default_rng(5))
    light = vtkLight()
    getattr(light, f"SetLightTypeTo{kind}")()
    light.SetPosition(0.3, 0.4, 1.0)
    light.SetFocalPoint(0.1, 0.0, 0.0)
    light.SetPositional(positional)
    time = light.GetMTime()
    found = [light_of(light, camera), light_of(light, camera_of(camera))]
    assert light.GetMTime() == time
    renderer = vtkRenderer()
    renderer.SetActiveCamera(camera)
    renderer.AddLight(light)
    renderer.UpdateLightsGeometryToFollowCamera()
    position = np.array(light.GetTransformedPosition())
    axis = np.array(light.GetTransformedFocalPoint()) - position
    for converted in found:
        assert isinstance(converted, PointLight if positional else DirectionalLight)
        assert converted.direction == pytest.approx(axis / np.linalg.norm(axis), abs=1e-9)
        if positional:
            assert converted.position == pytest.approx(position, abs=1e-9)


def test_headlight_follows_the_camera():
    camera = vtkCamera()
    camera.SetPosition(0, 0, 10)
    assert default_headlight(camera).direction == (0.0, 0.0, -1.0)
    assert default_headlight(camera).irradiance == (math.pi,) * 3
    camera.Azimuth(90)
    assert default_headlight(camera).direction == pytest.approx((-1.0, 0.0, 0.0), abs=1e-12)


def test_power_attenuation_and_cone():
    light, camera = vtkLight(), vtkCamera()
    light.SetLightTypeToSceneLight()
    light.SetPositional(True)
    light.SetIntensity(2.0)
    light.SetColor(1.0, 0.5, 0.25)
    light.SetAttenuationValues(0.5, 0.1, 0.01)
    light.SetConeAngle(20)
    light.SetExponent(3)
    spot = light_of(light, camera)
    assert spot.intensity == pytest.approx((2 * math.pi, math.pi, 0.5 * math.pi))
    assert spot.attenuation == (0.5, 0.1, 0.01)
    assert (spot.cone_angle, spot.exponent) == (20.0, 3.0)
    light.SetConeAngle(90)
    everywhere = light_of(light, camera)
    assert (everywhere.cone_angle, everywhere.exponent) == (180.0, 0.0)


def test_collections_and_sequences_without_those_switched_off():
    on, off, camera = vtkLight(), vtkLight(), vtkCamera()
    off.SwitchOff()
    collection = vtkLightCollection()
    collection.AddItem(on)
    collection.AddItem(off)
    sky = ConstantEnvironment(0.5)
    assert lights_of(collection, camera) == (light_of(on, camera),)
    assert lights_of([off, sky, on], camera) == (sky, light_of(on, camera))
    with pytest.raises(TypeError, match=r"lights are vtkLight or .*, got 'sun'"):
        lights_of(["sun"], camera)


# Images


def test_images_have_the_bottom_row_first():
    values = np.arange(6, dtype=np.float32).reshape(2, 3)
    colours = np.zeros((2, 3, 4), np.uint8)
    image = image_of_arrays({"depth": values, "rgba": colours})
    assert image.GetDimensions() == (3, 2, 1)
    assert image.GetScalarComponentAsFloat(0, 0, 0, 0) == 3.0
    assert image.GetPointData().GetArray("rgba").GetNumberOfComponents() == 4
    assert image.GetPointData().GetScalars().GetName() == "depth"
    np.testing.assert_array_equal(array_of_image(image, "depth")[..., 0], values)
    with pytest.raises(ValueError, match="no point array 'radiance'"):
        array_of_image(image, "radiance")
