"""Command line: clip, crop, mask, labels, floor."""

import argparse

import numpy as np
import pytest
from scenes import blob, slab

from vtkmcvr.commands.cutting import (
    add_cutting_options,
    cutting_options,
    floor_under,
)
from vtkmcvr.commands.labelling import coloured_labels
from vtkmcvr.cutting import SUBVOLUME, Plane
from vtkmcvr.front import scene_of
from vtkmcvr.recorded_facts import Segment
from vtkmcvr.scene import Volume


def parsed(*words):
    parser = argparse.ArgumentParser()
    add_cutting_options(parser)
    return parser.parse_args(words)


def options_of(data, *words):
    return cutting_options(data, {"size": (20, 16)}, parsed(*words))


def test_nothing_given_changes_nothing():
    given = {"size": (20, 16)}
    assert cutting_options(None, given, parsed()) is given


def test_clip_is_in_world_coordinates_or_percent_of_the_extent():
    vol = slab((4, 6, 8), centre=(10, 0, 0))
    options = options_of(vol, "--clip", "x=9:11.5", "--clip", "z=:75%")
    assert options["clip"] == (
        Plane((9, 0, 0), (1, 0, 0)), Plane((11.5, 0, 0), (-1, 0, 0)), Plane((0, 0, 2), (0, 0, -1))
    )  # fmt: skip


@pytest.mark.parametrize("text", ["y", "w=1:", "x=:", "x=a:", "x=1", "=1:2"])
def test_bad_clip_says_what_is_allowed(text):
    with pytest.raises(ValueError, match="--clip"):
        options_of(blob(), "--clip", text)


def test_crop_is_in_voxels():
    crop = options_of(blob(17), "--crop", "2:9,:,:4.5")["crop"]
    assert (crop.lower, crop.upper, crop.flags) == ((2, 0, 0), (9, 16, 4.5), SUBVOLUME)


@pytest.mark.parametrize("text", ["1:2", "1:2,3:4,5", "a:,:,:", "9:2,:,:"])
def test_bad_crop_says_what_is_allowed(text):
    with pytest.raises(ValueError, match=r"--crop|cropping\.lower"):
        options_of(blob(), "--crop", text)


def written(path, values, spacing=(0.125, 0.125, 0.125), origin=(-1, -1, -1)):
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(values)
    image.SetSpacing(spacing)
    image.SetOrigin(origin)
    sitk.WriteImage(image, str(path))
    return str(path)


def test_mask_and_labels_are_files_on_the_same_grid(tmp_path):
    vol = blob(17)
    np.testing.assert_array_equal(vol.corners[0], (-1, -1, -1))
    labels = (vol.values * 3).astype(np.uint8)
    path = written(tmp_path / "labels.nrrd", labels)
    np.testing.assert_array_equal(options_of(vol, "--mask", path)["mask"], labels)
    found = options_of(vol, "--labels", path)["labels"]
    assert sorted(found.transfers) == [1, 2, 3][: int(labels.max())]
    other = written(tmp_path / "other.nrrd", labels, origin=(0, 0, 0))
    with pytest.raises(ValueError, match=r"another grid.*resample"):
        options_of(vol, "--mask", other)


def test_labels_have_the_opacity_of_the_look_and_colours_of_their_own():
    transfer = scene_of(blob()).scene.transfer
    labels = coloured_labels(np.arange(27).reshape(3, 3, 3), transfer)
    assert len(labels.transfers) == 26
    assert labels.transfers[1].opacity == transfer.opacity
    assert labels.transfers[1].colour != labels.transfers[2].colour
    named = [Segment(5, "liver", (1.0, 0.0, 0.0)), Segment(9, "spleen", (1.0, 0.0, 0.0))]
    labels = coloured_labels(np.arange(27).reshape(3, 3, 3), transfer, named)
    red, green, blue = labels.transfers[5].colour(0.0)
    assert red > 20 * green
    assert green == blue
    assert labels.transfers[5] is labels.transfers[9]


def test_floor_is_just_under_what_is_seen():
    # A ball of radius about 1 in the middle of a cube: seen values start near the ball's end
    scene = scene_of(blob(33)).scene
    floor = floor_under(scene)
    assert floor.normal == (0, 0, 1)
    assert -1.05 < floor.centre[2] < -0.5
    (receiver,) = options_of(blob(33), "--floor")["receivers"]
    assert receiver == floor
    lying = Volume(np.zeros((4, 4, 4)))
    assert floor_under(scene_of(lying).scene).centre[2] < 0
