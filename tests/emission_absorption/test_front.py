"""Emission and absorption through the front door, the command line, the VTK filter and a replay."""

import json

import numpy as np
import pytest
from scenes import BOX, blob, frontal, medium, scene, volume
from vtk_pictures import GPU, by_vtk, camera_on, difference, image, look, lopsided

import vtkmcvr
from vtkmcvr import EmissionAbsorption, Phong, PlaneReceiver, Surface, render_emission_absorption
from vtkmcvr.cli import main
from vtkmcvr.filters import EmissionAbsorptionFilter, MonteCarloFilter, ToneMapFilter
from vtkmcvr.scene import Camera, Lens
from vtkmcvr.vtk_bridge.scene import array_of_image

TECHNIQUE = "emission-absorption"
SMALL = {"preset": "solid", "size": (24, 18)}


def test_front_door():
    picture = vtkmcvr.render(blob(), technique=TECHNIQUE, **SMALL)
    assert picture.rgba.shape == (18, 24, 4)
    assert picture.recipe["technique"] == TECHNIQUE
    assert picture.samples == 1 and picture.standard_error is None
    json.dumps(picture.facts(), allow_nan=False)
    json.dumps(picture.recipe, allow_nan=False)
    assert "emission and absorption" in str(picture)
    for wrong in ({"samples": 3}, {"nrms": 0.1}, {"backend": "cuda"}):
        with pytest.raises(ValueError, match=TECHNIQUE):
            vtkmcvr.render(blob(), technique=TECHNIQUE, **wrong, **SMALL)
    with pytest.raises(ValueError, match='technique="emission-absorption"'):
        vtkmcvr.render(blob(), emission_absorption=EmissionAbsorption(), **SMALL)
    with pytest.raises(ValueError, match="no noise"):
        picture.denoised()


def test_colours_are_displayed_as_they_are():
    seen = scene(blob(), medium(300.0, (0.25, 0.5, 1.0)), size=(9, 9))
    picture = render_emission_absorption(seen)
    np.testing.assert_allclose(picture.rgba[4, 4], (64, 127.5, 255, 255), atol=0.6)
    darker = picture.with_display(exposure=-1.0)
    np.testing.assert_allclose(darker.rgba[4, 4], (32, 64, 127.5, 255), atol=0.6)


def test_plan_says_what_is_simulated_and_what_is_not():
    camera = Camera((0, -5, 0), (0, 0, 0), lens=Lens(0.1))
    seen = scene(
        blob(), camera=camera, lights=(vtkmcvr.headlight(1.0),),
        surface=Surface(phong=Phong(0.3, 0.5, 0.1, 7)), aovs="normal",
    )  # fmt: skip
    on = {e.name: (e.on, e.reason) for e in render_emission_absorption(seen).plan.effects}
    assert on["emission and absorption"][0] and "0.5 voxels" in on["emission and absorption"][1]
    assert on["shading"][0] and "ambient 0.3" in on["shading"][1] and "power 7" in on["shading"][1]
    for absent in ("shadows", "scattering", "lights", "depth of field"):
        assert not on[absent][0]
    assert on["first-hit AOVs"] == (True, "normal")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"step": 0}, "step must be from 0.001"),
        ({"sample_distance": -1}, "sample_distance must be above 0"),
        ({"rays": 65}, "rays are at most 64"),
        ({"shading": "gouraud"}, "shading is one of scene, none"),
    ],
)
def test_settings_that_cannot_be(settings, words):
    with pytest.raises(ValueError, match=words):
        EmissionAbsorption(**settings)


def test_what_is_not_simulated_is_refused():
    with pytest.raises(ValueError, match="does not know receivers"):
        render_emission_absorption(scene(receivers=PlaneReceiver((0, 0, -1), (0, 0, 1))))
    with pytest.raises(ValueError, match="more than 10000000 steps"):
        render_emission_absorption(scene(), EmissionAbsorption(sample_distance=1e-9))


def test_any_number_of_threads_gives_the_same_bits():
    seen = scene(blob(), surface=Surface(), size=(31, 23))
    one, three = (render_emission_absorption(seen, threads=n) for n in (1, 3))
    np.testing.assert_array_equal(one.radiance, three.radiance)


def test_empty_space_is_leapt_over_without_a_trace():
    # A ball far behind another
    values = np.zeros((17, 129, 17), np.float32)
    values[:, :17] = values[:, -17:] = blob(17).values
    seen = scene(volume(values, (0.1, 0.1, 0.1)), medium(3.0), frontal(1.0, distance=20), (20, 20))
    quick, whole = (
        render_emission_absorption(seen, EmissionAbsorption(skip=skip)) for skip in (True, False)
    )
    np.testing.assert_allclose(quick.radiance, whole.radiance, atol=1.5e-5)
    assert whole.work.looked_up == whole.work.naive == quick.work.naive
    assert quick.work.looked_up < 0.4 * quick.work.naive


def test_progress_and_abort():
    said = []
    seen = scene(blob(), size=(16, 64))
    whole = render_emission_absorption(seen, progress=lambda p: said.append(p.fraction))
    assert said == sorted(said) and said[-1] == 1.0 and whole.stopped_by == "end"
    part = render_emission_absorption(seen, threads=1, abort=lambda: True)
    assert part.stopped_by == "user"
    np.testing.assert_array_equal(part.radiance[:4], whole.radiance[:4])


def test_nothing_to_see():
    picture = render_emission_absorption(scene(blob(), medium(0.0)))
    assert not picture.radiance.any() and not picture.alpha.any()
    assert np.isinf(picture.depth).all()


def test_command_line_and_replay(tmp_path, capsys):
    out, facts, again = tmp_path / "a.npz", tmp_path / "a.json", tmp_path / "b.npz"
    demo = ["demo", "-o", str(out), "--technique", TECHNIQUE, "--size", "32x24", "--step-size", "1",
            "--rays", "2", "--json", str(facts), "--threads", "2"]  # fmt: skip
    assert main(demo) == 0
    assert "2 x 2 rays a pixel" in capsys.readouterr().out
    assert json.loads(facts.read_text())["step"] == 1
    assert main(["replay", str(out), "-o", str(again)]) == 0
    first, second = np.load(out), np.load(again)
    for name in ("radiance", "alpha", "depth", "rgba"):
        np.testing.assert_array_equal(first[name], second[name])
    assert main(["demo", "-o", str(tmp_path / "c.png"), "--rays", "2"]) != 0
    assert "--technique emission-absorption" in capsys.readouterr().err


def filtered(**options):
    data = image(lopsided(), (0.6, 0.5, 1.3))
    made = EmissionAbsorptionFilter(
        film_size=(80, 60), camera=camera_on(data.GetCenter(), 80),
        volume_property=look(0, 1, shade=True), **options,
    )  # fmt: skip
    made.SetInputDataObject(data)
    made.Update()
    return data, made


def test_filter_gives_vtks_picture():
    data, made = filtered(emission_absorption=EmissionAbsorption(0.1), aovs=("albedo", "normal"))
    output = made.GetOutputDataObject(0)
    theirs = by_vtk(data, made.volume_property, GPU(), made.camera, 0.05)
    assert difference(theirs, array_of_image(output, "radiance")) < 0.5
    alpha = array_of_image(output, "radiance")[..., 3]
    normal = np.linalg.norm(array_of_image(output, "normal"), axis=2)
    assert (normal <= alpha + 1e-5).all() and normal.max() > 0.9
    assert array_of_image(output, "albedo").max() > 0.5
    shown = ToneMapFilter(curve="none", gamma=1.0, background=(0.0, 0.0, 0.0))
    shown.SetInputConnection(made.GetOutputPort())
    shown.Update()
    rgb = array_of_image(shown.GetOutputDataObject(0), "rgba")[..., :3] / 255
    assert difference(theirs[..., :3], rgb) < 0.7


def test_filter_renders_again_for_a_change_of_what_counts():
    _, made = filtered()
    first = made.picture
    made.Modified()
    made.Update()
    assert made.picture is first
    made.volume_property.SetAmbient(0.9)
    made.Update()
    assert made.picture is not first
    assert made.picture.radiance.mean() > first.radiance.mean()
    made.emission_absorption = EmissionAbsorption(shading="none")
    made.Update()
    assert not any(e.on for e in made.plan.effects if e.name == "shading")


def test_depth_and_opacity_are_those_of_light_transport():
    data, made = filtered()
    traced = MonteCarloFilter(film_size=(80, 60), camera=made.camera, samples=64,
                              pixel_filter=BOX, volume_property=look(0, 1))  # fmt: skip
    traced.SetInputDataObject(data)
    traced.Update()
    ours, theirs = made.picture, traced.picture
    assert abs(ours.alpha.mean() - theirs.alpha.mean()) < 0.004
    both = (ours.alpha > 0.5) & (theirs.alpha > 0.5)
    # A collision is some 2 away from the mean of its pixel: 64 x 1000 of them have it to 0.01
    assert abs((ours.depth[both] - theirs.depth[both]).mean()) < 0.05
