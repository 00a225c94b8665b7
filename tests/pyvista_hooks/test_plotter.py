"""`plotter.mcvr`: who draws, when a picture begins anew, and that nothing is left behind."""

import subprocess
import sys
import warnings

import numpy as np
import pytest
import pyvista as pv
from plotters import SIZE, add, blob, look, pixels, plotter
from vtkmodules.vtkCommonDataModel import vtkPlane


@pytest.fixture
def scene():
    target = plotter()
    volume = add(target)
    look(target)
    yield target, volume
    target.close()


def restarts(target):
    return sum(view.restarts for view in target.mcvr._live.views)


def test_nothing_heavy_is_imported_before_it_is_used():
    code = (
        "import sys, pyvista\n"
        "assert 'mcvr' in dir(pyvista.ImageData()) and 'mcvr' in dir(pyvista.Plotter())\n"
        "assert not any(name.startswith('vtkmcvr') for name in sys.modules)\n"
        "pyvista.Plotter(off_screen=True).mcvr, pyvista.ImageData().mcvr\n"
        "heavy = {'numba', 'SimpleITK', 'pydicom', 'scipy', 'vtkmcvr.kernels.path'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_first_screenshot_is_finished_and_disable_restores_all(scene):
    target, volume = scene
    before = pixels(target)
    props = target.renderer.GetViewProps().GetNumberOfItems()
    target.mcvr.enable(samples=20)
    ours = pixels(target)
    assert target.mcvr.samples == 20 and target.mcvr.done
    assert np.abs(ours - before).mean() > 1
    assert volume.GetVisibility()
    target.mcvr.disable()
    assert not target.mcvr.enabled
    assert target.renderer.GetViewProps().GetNumberOfItems() == props
    np.testing.assert_array_equal(pixels(target), before)


def test_the_same_seed_gives_the_same_bytes(scene):
    target, _ = scene
    target.mcvr.enable(samples=4, seed=3)
    first = pixels(target)
    target.mcvr.enable(seed=4)
    other = pixels(target)
    target.mcvr.enable(seed=3)
    np.testing.assert_array_equal(pixels(target), first)
    assert np.abs(other - first).max() > 0


EDITS = {
    "camera": lambda target, volume: look(target, (3, 2, 6)),
    "zoom": lambda target, volume: target.camera.zoom(1.2),
    "projection": lambda target, volume: target.enable_parallel_projection(),
    "opacity": lambda target, volume: volume.prop.GetScalarOpacity().AddPoint(0.5, 0.3),
    "colour": lambda target, volume: volume.prop.GetRGBTransferFunction().AddRGBPoint(0.5, 1, 0, 0),
    "unit distance": lambda target, volume: setattr(volume.prop, "opacity_unit_distance", 0.2),
    "shading": lambda target, volume: volume.prop.SetScatteringAnisotropy(0.3),
    "place": lambda target, volume: volume.SetPosition(0.2, 0, 0),
    "light": lambda target, volume: setattr(target.renderer.lights[0], "position", (9, 0, 1)),
    "light off": lambda target, volume: setattr(target.renderer.lights[0], "intensity", 0.5),
    "clip": lambda target, volume: volume.mapper.AddClippingPlane(plane()),
    "cropping": lambda target, volume: crop(volume),
    "voxels": lambda target, volume: edit_voxels(volume),
    "window": lambda target, volume: setattr(target, "window_size", [80, 60]),
    "mesh": lambda target, volume: target.add_mesh(pv.Sphere(radius=0.4, center=(1, 1, 0))),
}


def plane():
    result = vtkPlane()
    result.SetNormal(1, 0, 0)
    return result


def crop(volume):
    volume.mapper.CroppingOn()
    volume.mapper.SetCroppingRegionPlanes(-0.5, 0.5, -0.5, 0.5, -0.5, 0.5)


def edit_voxels(volume):
    image = volume.mapper.GetDataSetInput()
    image.GetPointData().GetScalars().SetTuple1(2456, 0.9)
    image.GetPointData().GetScalars().Modified()
    image.Modified()


@pytest.mark.parametrize("name", EDITS)
def test_an_edit_begins_a_new_picture_once(scene, name):
    target, volume = scene
    target.mcvr.enable(samples=1)
    before = pixels(target)
    assert restarts(target) == 1
    pixels(target)
    assert restarts(target) == 1
    EDITS[name](target, volume)
    after = pixels(target)
    assert restarts(target) == 2
    pixels(target)
    assert restarts(target) == 2
    assert before.shape != after.shape or np.abs(before - after).max() > 0


def test_what_is_no_part_of_the_picture_begins_none(scene):
    target, _ = scene
    target.mcvr.enable(samples=1)
    pixels(target)
    target.set_background("navy")
    target.add_text("words")
    target.renderer.ResetCameraClippingRange()
    navy = pixels(target)
    assert restarts(target) == 1
    np.testing.assert_allclose(navy[2, -2], (0, 0, 128))


def test_a_moved_clip_plane_of_a_widget_begins_a_new_picture(scene):
    target, volume = scene
    target.mcvr.enable(samples=1)
    widget = target.add_volume_clip_plane(volume, normal="x", interaction_event="always")
    before = pixels(target)
    done = restarts(target)
    widget.SetOrigin(0.5, 0, 0)
    widget.InvokeEvent("InteractionEvent")
    after = pixels(target)
    assert restarts(target) == done + 1
    assert np.abs(before - after).max() > 10


def test_a_hidden_volume_is_not_drawn(scene):
    target, volume = scene
    target.mcvr.enable(samples=2)
    shown = pixels(target)
    volume.SetVisibility(False)
    empty = pixels(target)
    assert (empty == empty[0, 0]).all()
    volume.SetVisibility(True)
    np.testing.assert_array_equal(pixels(target), shown)


def test_volumes_added_later_are_drawn(scene):
    target, _ = scene
    target.mcvr.enable(samples=2)
    pixels(target)
    other = blob()
    other.origin = (0.2, -1, -1)
    add(target, other, cmap="hot")
    pixels(target)
    assert len(target.mcvr.picture.plan.scene.layers) == 1


def test_subplots_have_pictures_of_their_own():
    target = plotter((2 * SIZE[0], SIZE[1]), shape=(1, 2))
    for column in (0, 1):
        target.subplot(0, column)
        add(target)
        look(target, (2.5, 3.0 - 6 * column, 6.0))
    target.mcvr.enable(samples=16)
    target.show(auto_close=False)
    both = pixels(target)
    sizes = []
    for column in (0, 1):
        target.subplot(0, column)
        sizes.append(target.mcvr.picture.size)
    target.close()
    assert sizes == [SIZE, SIZE]
    one = plotter()
    add(one)
    look(one)
    one.mcvr.enable(samples=16)
    alone = pixels(one)
    one.close()
    # Beside the frame that PyVista draws around subplots
    np.testing.assert_array_equal(both[3:-3, 3 : SIZE[0] - 3], alone[3:-3, 3:-3])


@pytest.mark.parametrize("parallel", [False, True])
def test_an_enlarged_screenshot_shows_the_same_view(scene, parallel):
    target, _ = scene
    target.add_mesh(pv.Sphere(radius=0.4, center=(0.5, 0.5, 0.8)), color="red", lighting=False)
    if parallel:
        target.enable_parallel_projection()
    target.mcvr.enable(samples=64)
    small = pixels(target)
    large = pixels(target, scale=2)
    assert large.shape[:2] == (2 * SIZE[1], 2 * SIZE[0])
    mean = large.reshape(SIZE[1], 2, SIZE[0], 2, 3).mean(axis=(1, 3))
    assert np.abs(mean - small).mean() < 2


def test_a_transparent_screenshot_has_the_volumes_alpha(scene):
    target, _ = scene
    target.mcvr.enable(samples=16)
    target.render()
    image = target.screenshot(None, transparent_background=True, return_img=True)
    alpha = target.mcvr.picture.alpha
    assert image.shape[2] == 4
    np.testing.assert_allclose(image[..., 3] / 255, alpha, atol=0.02)


def test_movies_hold_finished_frames(scene, tmp_path):
    imageio = pytest.importorskip("imageio", reason="movies need imageio")
    target, volume = scene
    target.mcvr.enable(samples=8, progressive=None)
    target.open_gif(tmp_path / "orbit.gif")
    target.show(auto_close=False)
    samples = []
    for step in range(3):
        target.camera.azimuth = 20 * step
        target.write_frame()
        samples.append(target.mcvr.samples)
    # The next step of a series: other voxels in the same volume
    volume.mapper.SetInputData(blob(15))
    target.write_frame()
    samples.append(target.mcvr.samples)
    target.mwriter.close()
    assert samples == [8] * 4
    frames = imageio.mimread(tmp_path / "orbit.gif")
    assert len(frames) >= 4


def test_an_orbit_has_finished_frames(scene, tmp_path):
    pytest.importorskip("imageio", reason="movies need imageio")
    target, _ = scene
    target.mcvr.enable(samples=4)
    target.open_gif(tmp_path / "orbit.gif")
    target.show(auto_close=False)
    seen = []
    target.add_on_render_callback(lambda *_: seen.append(target.mcvr.samples))
    target.orbit_on_path(target.generate_orbital_path(n_points=3), write_frames=True)
    target.mwriter.close()
    assert seen and set(seen) == {4}


def test_what_cannot_be_rendered_is_said_before_anything_changes():
    target = plotter()
    grid = pv.RectilinearGrid(*(np.array([0.0, 1.0, 3.0]),) * 3)
    grid["density"] = np.arange(27.0)
    target.add_volume(grid, show_scalar_bar=False)
    props = target.renderer.GetViewProps().GetNumberOfItems()
    with pytest.raises(TypeError, match="vtkImageData"):
        target.mcvr.enable()
    assert not target.mcvr.enabled
    assert target.renderer.GetViewProps().GetNumberOfItems() == props
    target.close()
    target = plotter()
    add(target, blending="maximum")
    with pytest.raises(ValueError, match="SetBlendModeToComposite"):
        target.mcvr.enable()
    target.close()


def test_volumes_that_scatter_in_different_ways_are_refused(scene):
    target, _ = scene
    other = add(target, blob(9))
    other.prop.SetScatteringAnisotropy(0.5)
    with pytest.raises(ValueError, match=r"anisotropies are 0, 0\.5"):
        target.mcvr.enable(samples=1)
    assert not target.mcvr.enabled


def test_what_stops_being_possible_is_left_to_vtk_with_a_warning(scene):
    target, volume = scene
    target.mcvr.enable(samples=2)
    pixels(target)
    volume.mapper.SetBlendModeToMaximumIntensity()
    with pytest.warns(RuntimeWarning, match="drawn by VTK.*blend mode"):
        theirs = pixels(target)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        target.render()
    target.mcvr.disable()
    np.testing.assert_array_equal(pixels(target), theirs)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"sample": 3}, "sample"),
        ({"technique": "magic"}, "monte-carlo, occlusion"),
        ({"nrms": -1}, "nrms must be above 0"),
        ({"meshes": "both"}, "drawn, traced"),
        ({"lighting": [3]}, "Light"),
    ],
)
def test_bad_settings_are_refused(scene, settings, words):
    with pytest.raises((TypeError, ValueError), match=words):
        scene[0].mcvr.enable(**settings)


def test_before_enable_there_is_no_picture(scene):
    with pytest.raises(RuntimeError, match=r"enable\(\) first"):
        scene[0].mcvr.picture  # noqa: B018


def test_a_background_image_stays_behind(scene, tmp_path):
    target, _ = scene
    picture = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    picture[:, : SIZE[0] // 2] = (0, 0, 200)
    image = pv.ImageData(dimensions=(*SIZE, 1))
    image.point_data["rgb"] = picture[::-1].reshape(-1, 3)
    image.save(tmp_path / "behind.png")
    target.add_background_image(str(tmp_path / "behind.png"))
    target.add_mesh(pv.Sphere(radius=0.4, center=(0.5, 0.5, 0.8)), color="red", lighting=False)
    plain = pixels(target)
    target.mcvr.enable(samples=4)
    ours = pixels(target)
    # The corners show the image, as VTK draws it, but for the very border
    for corner in (np.s_[1:6, 1:6], np.s_[-6:-1, 1:6], np.s_[1:6, -6:-1]):
        np.testing.assert_array_equal(ours[corner], plain[corner])
    assert np.abs(ours - plain).max() > 10
