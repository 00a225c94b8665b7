"""What the command line's options of transport and display make of a scene and a picture."""

import argparse

import numpy as np
import pytest

from vtkmcvr.commands.camera_options import add_camera_options, camera_options
from vtkmcvr.commands.transport_options import (
    add_display_options,
    add_transport_options,
    displayed,
    transport_options,
)
from vtkmcvr.front import scene_of
from vtkmcvr.phantom import head_phantom
from vtkmcvr.pictures.picture import Display
from vtkmcvr.scene import HenyeyGreenstein, Volume

HEAD = Volume.from_grid(*head_phantom(16))
OPTIONS = {"preset": "ct-bone", "size": (8, 6)}


def parsed(*arguments):
    parser = argparse.ArgumentParser()
    add_transport_options(parser)
    add_display_options(parser)
    add_camera_options(parser)
    return parser.parse_args(arguments)


def scene_with(*arguments):
    args = parsed(*arguments)
    options = transport_options(HEAD, OPTIONS, args)
    return scene_of(HEAD, **camera_options(HEAD, options, args)).scene


def test_without_options_the_look_stays_as_it_is():
    assert transport_options(HEAD, OPTIONS, parsed()) == OPTIONS


def test_transport_reaches_the_scene():
    scene = scene_with("--scattering", "multiple", "--g", "0.6", "--estimator", "woodcock")
    assert (scene.scattering, scene.estimator) == ("multiple", "woodcock")
    assert scene.phase == HenyeyGreenstein(0.6)
    assert scene_with("--shadow-reach", "0").shadow_reach == 0


def test_surface_is_the_looks_but_for_what_is_asked():
    look = scene_of(HEAD, **OPTIONS).scene.surface
    surface = scene_with("--gradient-factor", "0.3", "--coat", "ggx").surface
    assert (surface.gradient_factor, surface.coat) == (0.3, "ggx")
    assert (surface.specular, surface.exponent) == (look.specular, look.exponent)


def test_reach_that_is_asked_for_holds_in_a_panorama_too():
    assert scene_with("--projection", "panorama", "--shadow-reach", "7").shadow_reach == 7
    many = scene_with("--projection", "panorama", "--scattering", "multiple")
    assert many.shadow_reach == np.inf


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--scattering", "double", "scattering is one of single, multiple"),
        ("--g", "2", "g"),
        ("--coat", "wax", "coat is one of blinn, ggx"),
        ("--estimator", "guess", "estimator is one of"),
    ],
)
def test_what_cannot_be_is_refused(option, value, message):
    with pytest.raises(ValueError, match=message):
        scene_with(option, value)


def test_display_of_the_picture():
    class Shown:
        def with_display(self, **changes):
            return Display(**changes)

    picture = Shown()
    assert displayed(picture, parsed()) is picture
    both = displayed(picture, parsed("--gamma", "2", "--film-filter", "gaussian-5x5"))
    assert both == Display(gamma=2.0, film_filter="gaussian-5x5")
