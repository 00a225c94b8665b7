"""Autofocus finds the depth of what a pixel shows."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import medium, noise, render, scene, slab, volume

import vtkmcvr
from vtkmcvr.scene import Camera, Lens, Stereo

# From the origin along +y
AHEAD = Camera((0, 0, 0), (0, 10, 0), view_angle=60)


def plates():
    """Opaque plates: at depth 8 in the left half of the view, at depth 12 in the right half."""
    values = np.zeros((3, 9, 33), np.float32)
    values[:, 2, :16] = 1
    values[:, 6, 17:] = 1
    return volume(values, (1.0, 1.0, 40.0), (0, 10, 0))


def test_autofocus_measures_depth_along_the_axis():
    # The plates' soft faces, half a unit before they are opaque, are opaque within 1e-3
    pick = scene(plates(), medium(1e4), AHEAD, (64, 48))
    for pixel, depth in (((12, 24), 7), ((25, 2), 7), ((50, 24), 11), ((60, 45), 11)):
        assert vtkmcvr.autofocus(pick, pixel) == pytest.approx(depth, abs=0.02)


def test_autofocus_is_the_mean_depth_in_a_cloud():
    # Optical depth 2 over 4 units from depth 8: the mean of an exponential cut off at 2
    mean = 8 + 4 / 2 * (1 - 2 * np.exp(-2) / (1 - np.exp(-2)))
    cloud = scene(slab((40, 4, 40), centre=(0, 10, 0)), medium(0.5), AHEAD, (65, 49))
    found = [vtkmcvr.autofocus(cloud, (32, 24), radius=0.1, seed=s) for s in range(16)]
    # The spread of depths is 1.1, that of 256 x 86 % of them 0.075
    assert np.mean(found) == pytest.approx(mean, abs=4.5 * 0.075 / 4)


def test_autofocus_ignores_lens_and_lights():
    pick = scene(plates(), medium(1e4), AHEAD, (64, 48))
    blurred = replace(pick, camera=replace(AHEAD, lens=Lens(3.0, 2.0)))
    assert vtkmcvr.autofocus(blurred, (50, 24)) == vtkmcvr.autofocus(pick, (50, 24))


def test_autofocus_in_either_eye():
    both = replace(AHEAD, stereo=Stereo(angle=10.0))
    pick = scene(plates(), medium(1e4), both, (128, 48))
    assert vtkmcvr.autofocus(pick, (8, 24)) == pytest.approx(7, abs=0.02)
    assert vtkmcvr.autofocus(pick, (120, 24)) == pytest.approx(11, abs=0.02)


def test_focusing_makes_the_picked_pixel_sharp():
    # Stripes two units wide at depth 12. Focused on depth 8, a lens of radius 4 spreads a point of
    # theirs over a disk of radius 4 (12 - 8) / 8 = 2: nothing is left of them
    values = np.zeros((3, 3, 65), np.float32)
    values[:, 1, np.arange(65) // 8 % 2 == 1] = 1
    stripes = volume(values, (0.25, 0.25, 40.0), (0, 12, 0))
    pick = scene(stripes, medium(1e4), AHEAD, (48, 48))
    focus = vtkmcvr.autofocus(pick, (22, 24), radius=4.0)
    assert focus == pytest.approx(12, abs=0.3)

    def contrast(distance):
        lens = Lens(4.0, distance)
        picture = render(replace(pick, camera=replace(AHEAD, lens=lens)), 64)
        return picture.alpha[16:32, 12:36].mean(axis=0).std()

    assert contrast(focus) > 0.35
    assert contrast(8.0) < 0.1


@pytest.mark.parametrize(
    ("changes", "pixel", "message"),
    [
        ({}, (64, 0), r"pixel \(64, 0\) is not on the film of 64 x 48"),
        ({}, (-1, 0), "pixel must be at least 0"),
        ({}, (1.5, 0), "pixel must be a whole number"),
        ({"transfer": medium(0.0)}, (5, 5), "nothing to focus on"),
        ({"camera": replace(AHEAD, panorama=True)}, (5, 5), "panorama has no lens"),
    ],
)
def test_what_cannot_be_focused_is_said(changes, pixel, message):
    pick = scene(noise(), **{"camera": AHEAD, "size": (64, 48), **changes})
    with pytest.raises(ValueError, match=message):
        vtkmcvr.autofocus(pick, pixel)
