"""`image.mcvr.render` takes PyVista's words as `add_volume` does."""

import numpy as np
import pytest
import pyvista as pv
from plotters import SIZE, blob
from vtkmodules.vtkCommonDataModel import vtkPlane

import vtkmcvr
from vtkmcvr.pictures.display import srgb_encode

OPTIONS = {"window_size": SIZE, "samples": 4, "lighting": "three lights"}


def render(image=None, **options):
    return (blob() if image is None else image).mcvr.render(**{**OPTIONS, **options})


def test_a_picture_shows_itself_and_becomes_an_image_and_an_array(tmp_path):
    picture = render(cmap="viridis", opacity="sigmoid", background="white")
    assert isinstance(picture, vtkmcvr.Picture) and picture.samples == 4
    (tmp_path / "picture.png").write_bytes(picture._repr_png_())
    pixels = pv.read(tmp_path / "picture.png")
    assert pixels.dimensions == (*SIZE, 1)
    array = np.asarray(picture)
    np.testing.assert_array_equal(array, picture.rgba)
    image = picture.to_pyvista()
    assert isinstance(image, pv.ImageData) and image.dimensions == (*SIZE, 1)
    np.testing.assert_array_equal(image["rgba"].reshape(*SIZE[::-1], 4)[::-1], array)
    np.testing.assert_array_equal(array[0, 0], (255, 255, 255, 255))


def test_words_mean_what_they_mean_to_add_volume():
    """Curves of the scene = those of the actor that `add_volume` makes."""
    words = {"cmap": "coolwarm", "opacity": "sigmoid_6", "clim": (0.1, 0.8), "shade": True}
    scene = render(**words, opacity_unit_distance=0.3).plan.scene
    plotter = pv.Plotter(off_screen=True)
    volume = plotter.add_volume(blob(), **words, opacity_unit_distance=0.3)
    x = np.linspace(0.1, 0.8, 30)
    opacity = [volume.prop.GetScalarOpacity().GetValue(v) for v in x]
    np.testing.assert_allclose(scene.transfer.opacity(x), opacity, atol=1e-9)
    shown = [volume.prop.GetRGBTransferFunction().GetColor(v) for v in x]
    # Reflectance in linear light shows as the colour of the map
    np.testing.assert_allclose(srgb_encode(scene.transfer.colour(x)), shown, atol=0.01)
    assert scene.transfer.unit_distance == 0.3 and scene.surface is not None
    plotter.close()


@pytest.mark.parametrize("opacity", ["linear", "linear_r", "geom", "sigmoid_3", [0, 0.2, 0.1], 0.5])
def test_named_ramps_and_arrays_are_opacities(opacity):
    scene = render(opacity=opacity, samples=1).plan.scene
    values = scene.transfer.opacity(np.linspace(0, 1, 9))
    assert ((values >= 0) & (values <= 1)).all() and values.max() > 0


def test_the_camera_is_pyvistas():
    position = [(3, 1, 2), (0, 0, 0), (0, 0, 1)]
    camera = render(cpos=position, zoom=2.0, samples=1).plan.scene.camera
    assert camera.position == (3, 1, 2) and camera.view_angle == pytest.approx(15)
    side = render(cpos="xz", parallel_projection=True, samples=1).plan.scene.camera
    assert side.parallel_scale > 0
    np.testing.assert_allclose(side.frame[2], (0, 1, 0), atol=1e-9)


def test_clipping_planes_keep_the_side_they_point_to():
    plane = vtkPlane()
    plane.SetNormal(1, 0, 0)
    for planes in (plane, [plane, ("x", (-9, 0, 0))], [((1, 0, 0), (0, 0, 0))]):
        scene = render(clipping_planes=planes, samples=1).plan.scene
        assert scene.clip[0].normal == (1, 0, 0)


def test_the_scalars_are_named():
    image = blob()
    image["other"] = image["density"] * 10
    assert render(image, scalars="other", samples=1).plan.scene.volume.values.max() > 5


def test_a_transparent_background_keeps_alpha():
    picture = render(transparent_background=True)
    assert picture.rgba[0, 0, 3] == 0 and picture.rgba[..., 3].max() > 0


def test_lights_of_all_kinds():
    kit = render(lighting="light kit", samples=1).plan.scene
    assert len(kit.lights) == 5
    lamp = pv.Light(position=(1, 2, 3), light_type="scene light")
    sun = vtkmcvr.DirectionalLight((0, 0, -1), 2.0)
    both = render(lighting=[lamp, sun], samples=1).plan.scene
    assert len(both.lights) == 2 and both.lights[1] is sun


def test_bad_words_are_refused():
    with pytest.raises(ValueError, match="light kit, three lights"):
        render(lighting="moon")
    with pytest.raises(ValueError, match="monte-carlo, occlusion"):
        render(technique="magic")
    with pytest.raises(ValueError, match="takes no samples"):
        render(technique="occlusion")
    with pytest.raises(TypeError, match="colour"):
        render(colour="red")


def test_occlusion_is_a_technique_too():
    picture = blob().mcvr.render(window_size=(48, 36), technique="occlusion", opacity="linear")
    assert isinstance(picture, vtkmcvr.OcclusionPicture)
    assert picture.alpha.max() > 0.1 and picture._repr_png_()[:4] == b"\x89PNG"
