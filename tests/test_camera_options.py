"""What the camera's command-line options make of a scene, short of rendering it."""

import argparse

import numpy as np
import pytest

from vtkmcvr.cli import main
from vtkmcvr.commands.camera_options import add_camera_options, camera_options
from vtkmcvr.front import scene_of
from vtkmcvr.phantom import head_phantom
from vtkmcvr.scene import Volume

HEAD = Volume.from_grid(*head_phantom(24))
OPTIONS = {"preset": "ct-bone", "size": (40, 30)}


def scene_with(*arguments):
    parser = argparse.ArgumentParser()
    add_camera_options(parser)
    options = camera_options(HEAD, OPTIONS, parser.parse_args(arguments))
    return scene_of(HEAD, **options).scene


PLAIN = scene_with()


def test_without_options_the_view_stays_as_it_is():
    assert PLAIN.camera == scene_of(HEAD, **OPTIONS).scene.camera
    assert PLAIN.camera.lens is None
    assert PLAIN.sampler == "sobol"
    assert scene_with("--sampler", "independent").sampler == "independent"


def test_lens_is_sharp_at_the_focal_point_or_at_a_pixel():
    lens = scene_with("--aperture", "3", "--blades", "6").camera.lens
    assert (lens.radius, lens.blades, lens.focus_distance) == (3.0, 6, None)
    near = scene_with("--aperture", "3", "--focus", "20,15").camera
    # The middle of the film shows the face, on the near side of the head's middle
    assert near.distance - HEAD.radius < near.lens.focus_distance < near.distance


def test_parallel_projection_keeps_the_focal_plane():
    camera = scene_with("--projection", "parallel").camera
    half_angle = np.radians(PLAIN.camera.view_angle) / 2
    assert camera.parallel_scale == pytest.approx(np.tan(half_angle) * PLAIN.camera.distance)
    assert camera.position == PLAIN.camera.position


def test_panorama_is_from_the_middle_and_lit():
    scene = scene_with("--projection", "panorama")
    assert scene.camera.panorama
    assert scene.camera.position == PLAIN.camera.focal_point
    np.testing.assert_allclose(scene.camera.frame, PLAIN.camera.frame, atol=1e-12)
    # What is far away lets the light of the look in
    assert scene.shadow_reach == pytest.approx(0.1 * HEAD.radius)
    assert PLAIN.shadow_reach == np.inf


def test_eyes():
    assert scene_with("--eyes", "both").camera.stereo.eyes == "both"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--focus", "3,4"], "--focus needs a lens"),
        (["--aperture", "2", "--focus", "400,4"], "not on the film of 40 x 30"),
        (["--aperture", "2", "--focus", "0,0"], "nothing to focus on"),
        (["--aperture", "-2"], "lens.radius must be at least 0"),
        (["--aperture", "2", "--blades", "2"], "lens.blades is 0"),
        (["--projection", "fisheye"], "projection is perspective, parallel or panorama"),
        (["--eyes", "third"], "stereo.eyes is one of"),
        (["--sampler", "halton"], "sampler is one of"),
    ],
)
def test_bad_options_are_named(arguments, message):
    with pytest.raises(ValueError, match=message):
        scene_with(*arguments)


def test_focus_is_two_numbers(capsys):
    with pytest.raises(SystemExit):
        main(["demo", "--focus", "3;4"])
    assert "focus is COLUMN,ROW" in capsys.readouterr().err
