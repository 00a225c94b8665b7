"""`vtkmcvr view`: the window shows what `vtkmcvr render` does, and its keys change the picture."""

from dataclasses import replace

import numpy as np
import pytest
import pyvista as pv

import vtkmcvr
from vtkmcvr.cli import main
from vtkmcvr.curves import ColourCurve
from vtkmcvr.phases import HenyeyGreenstein
from vtkmcvr.pyvista_hooks.viewer import Viewer

SIZE, SAMPLES = (64, 48), 16


def head():
    return vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(32))


@pytest.fixture
def viewer(tmp_path, monkeypatch):
    monkeypatch.setattr(pv, "OFF_SCREEN", True)
    dressed = vtkmcvr.scene_of(head(), preset="ct-bone", size=SIZE)
    made = Viewer(dressed, tmp_path / "kept.png", samples=SAMPLES, seed=1)
    made.show()
    yield made
    made.close()


def test_the_window_shows_what_render_does(viewer):
    ours = viewer.plotter.mcvr.picture
    expected = vtkmcvr.render(head(), preset="ct-bone", size=SIZE, samples=SAMPLES, seed=1)
    np.testing.assert_allclose(ours.plan.scene.camera.position, expected.plan.scene.camera.position)
    # Means over 3072 pixels of 16 samples, some third of them of the skull: a standard error of a
    # share is below 0.5 / sqrt(49152) = 0.0023; five of them, twice
    assert abs(ours.alpha.mean() - expected.alpha.mean()) < 0.025
    # Light of some 16 000 paths with a relative deviation of about 2, and highlights that a volume
    # property can only say approximately
    assert ours.radiance.mean() == pytest.approx(expected.radiance.mean(), rel=0.06)


def test_what_a_look_leaves_out_is_left_out(viewer):
    scene = viewer.plotter.mcvr.picture.plan.scene
    dressed = vtkmcvr.scene_of(head(), preset="ct-bone", size=SIZE).scene
    assert (scene.mask is None) == (dressed.mask is None)
    if dressed.mask is not None:
        np.testing.assert_array_equal(scene.mask.values != 0, dressed.mask != 0)


def test_keys_change_the_technique_in_turn(viewer):
    seen = []
    for _ in range(3):
        viewer.next_technique()
        seen.append(viewer.plotter.mcvr.settings.technique)
    assert seen == ["occlusion", "emission-absorption", "monte-carlo"]


@pytest.mark.slow
def test_a_plane_cuts_until_it_is_taken_away(viewer):
    whole = viewer.plotter.mcvr.picture.alpha
    viewer.clip()
    viewer.plotter.render()
    cut = viewer.plotter.mcvr.picture.alpha
    assert cut.mean() < 0.8 * whole.mean()
    viewer.clip()
    viewer.plotter.render()
    np.testing.assert_array_equal(viewer.plotter.mcvr.picture.alpha, whole)


def test_the_editor_comes_and_goes(viewer):
    viewer.edit_opacity()
    assert viewer.plotter.renderer._charts is not None and len(viewer.plotter.renderer._charts) == 1
    viewer.edit_opacity()
    assert len(viewer.plotter.renderer._charts) == 0


def test_a_lamp_lights_it_instead_of_the_studio(viewer):
    viewer.add_lamp()
    viewer.plotter.render()
    assert len(viewer.plotter.mcvr.picture.plan.scene.lights) == 1


def test_the_picture_is_kept_with_its_recipe(viewer, tmp_path):
    viewer.keep()
    assert pv.read(tmp_path / "kept.png").dimensions[:2] == SIZE


def test_command_writes_the_finished_picture(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(pv, "OFF_SCREEN", True)
    np.save(tmp_path / "head.npy", head().values)
    out = tmp_path / "seen.png"
    command = ["view", str(tmp_path / "head.npy"), "--preset", "ct-bone", "--size", "64x48"]
    assert main([*command, "--samples", "4", "-o", str(out)]) == 0
    assert out.stat().st_size > 1000
    assert "opacity editor" in capsys.readouterr().out


def test_without_a_display_it_says_so(monkeypatch, capsys):
    monkeypatch.setattr(pv, "OFF_SCREEN", False)
    monkeypatch.setattr(pv, "system_supports_plotting", lambda: False)
    assert main(["view"]) == 2
    assert "no display" in capsys.readouterr().err


def test_what_the_window_leaves_out_is_said(viewer, tmp_path):
    assert viewer.limits == ()
    dressed = vtkmcvr.scene_of(head(), preset="ct-bone", size=SIZE)
    glowing = replace(
        dressed.scene.transfer, emission=ColourCurve(((0, 0, 0, 0), (9, 1, 1, 1))),
    )  # fmt: skip
    scene = replace(dressed.scene, transfer=glowing, phase=HenyeyGreenstein(0.5))
    limited = Viewer(replace(dressed, scene=scene), tmp_path / "kept.png", samples=1)
    assert [("emission" in x, "phase" in x) for x in limited.limits] == [(1, 0), (0, 1)]
    limited.close()


def test_colours_by_voxel_are_refused(tmp_path):
    volume = head()
    colours = np.zeros((*volume.values.shape, 3), np.uint8)
    dressed = vtkmcvr.scene_of(
        vtkmcvr.Volume(volume.values, volume.index_to_world, colours), preset="ct-bone", size=SIZE
    )
    with pytest.raises(ValueError, match="one scalar a voxel"):
        Viewer(dressed, tmp_path / "kept.png")
