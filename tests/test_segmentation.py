"""Label maps beside a volume: shown, hidden, highlighted, from Python and the command line."""

import numpy as np
import pytest
import SimpleITK
from real_volumes import real_path

from vtkmcvr.cli import main
from vtkmcvr.front import scene_of
from vtkmcvr.phantom import head_phantom
from vtkmcvr.recorded_facts import Segment
from vtkmcvr.scene import Volume
from vtkmcvr.segmentation import Segmentation, paint

NAMES = (
    Segment(1, "liver", (0.8, 0.2, 0.2)), Segment(2, "kidney_left", (0.2, 0.8, 0.2)),
    Segment(3, "kidney_right", (0.2, 0.2, 0.8)), Segment(9, "absent", (0.5, 0.5, 0.5)),
)  # fmt: skip


def label_map(**chosen):
    values = np.zeros((20, 24, 28), np.uint8)
    values[3:9, 4:20, 4:12] = 1
    values[12:17, 4:10, 6:20] = 2
    values[12:17, 14:20, 6:20] = 3
    return Segmentation(Volume.from_grid(values, (1.0, 1.0, 2.0)), NAMES, **chosen)


def test_names_may_have_wildcards_and_numbers():
    assert label_map().shown == (1, 2, 3)
    assert label_map(show=["Kidney*"]).shown == (2, 3)
    assert label_map(show=["kidney left", 1]).shown == (1, 2)
    assert label_map(show="3").shown == (3,)
    assert label_map(hide=["liver"]).shown == (2, 3)
    assert label_map(show=["*"], hide=["kidney*"]).shown == (1,)
    # Known to the file, but in no voxel
    assert label_map(show=["absent", "liver"]).shown == (1,)
    with pytest.raises(ValueError, match=r"show: no label is called 'spleen'; there are 1 liver"):
        label_map(show=["spleen"])


def test_labels_without_a_name_are_named_by_number():
    bare = Segmentation(label_map().volume)
    assert [segment.name for segment in bare.names.values()] == ["1", "2", "3"]
    assert len({segment.colour for segment in bare.names.values()}) == 3


def test_solids_cover_their_labels_in_their_colours():
    chosen = label_map(show=["kidney*"])
    layer = chosen.solids()
    values = chosen.volume.values
    inside = (values == 2) | (values == 3)
    # Half occupancy, the surface, lies at the border of the label to within its blur
    assert (layer.volume.values[inside] > 100).mean() > 0.9
    assert layer.volume.values[values == 1].max() < 100
    np.testing.assert_array_equal(layer.labels.values[inside], values[inside])
    # Wherever the blur reaches there is a label to colour it
    assert (layer.labels.values[layer.volume.values > 40] != 0).all()
    colour = layer.labels.transfers[2].colour(0.0)
    np.testing.assert_allclose(colour, paint(NAMES[1].colour))
    assert set(layer.labels.transfers) == {2, 3}


def test_highlight_leaves_the_others_faint():
    transfers = label_map(highlight=["liver"]).solids().labels.transfers
    assert set(transfers) == {1, 2, 3}
    assert transfers[1].opacity(255.0) > 0.9
    assert transfers[2].opacity(255.0) < 0.05


def test_hidden_and_solid_labels_leave_the_volume_beside():
    values = label_map().volume.values
    hidden = label_map(hide=["liver"])
    assert hidden.only_hides
    np.testing.assert_array_equal(hidden.mask() == 0, values == 1)
    shown = label_map(show=["kidney*"], hide=["liver"])
    np.testing.assert_array_equal(shown.mask() == 0, values > 0)


def head_with_labels():
    head = head_phantom(32)
    volume = Volume.from_grid(*head)
    values = np.zeros(volume.values.shape, np.uint8)
    values[10:20, 10:20, 10:20] = 1
    values[22:26, 10:20, 10:20] = 2
    return volume, Segmentation(Volume(values, volume.index_to_world), NAMES)


def test_a_scene_with_solids_frames_and_counts_them():
    volume, all_labels = head_with_labels()
    dressed = scene_of(volume, preset="ct-bone", segmentation=all_labels, size=(16, 12))
    assert len(dressed.scene.layers) == 1
    assert "2 of 2 labels are solids" in dressed.notes
    hiding = Segmentation(all_labels.volume, NAMES, hide=["liver"])
    dressed = scene_of(volume, preset="ct-bone", segmentation=hiding, size=(16, 12))
    assert dressed.scene.layers == ()
    assert not dressed.scene.mask[12, 12, 12]
    other = Segmentation(Volume.from_grid(np.ones((4, 4, 4), np.uint8)))
    with pytest.raises(ValueError, match="the segmentation must have the volume's grid"):
        scene_of(volume, segmentation=other)


def test_a_label_map_itself_becomes_solids():
    scene = scene_of(label_map().volume, size=(16, 12))
    assert scene.preset == "labels"
    assert set(scene.scene.labels.transfers) == {1, 2, 3}
    assert "look labels: 3 of 3 labels" in scene.notes


def saved(path, volume):
    image = SimpleITK.GetImageFromArray(volume.values)
    matrix = volume.index_to_world
    image.SetSpacing([float(x) for x in volume.spacing])
    image.SetOrigin([float(x) for x in matrix[:3, 3]])
    image.SetDirection((matrix[:3, :3] / volume.spacing).ravel().tolist())
    SimpleITK.WriteImage(image, str(path))
    return str(path)


SMALL = ["--size", "16x12", "--samples", "1", "--threads", "1"]


@pytest.mark.parametrize("flip", [[], ["--flip", "k"]])
def test_command_line_shows_and_hides(tmp_path, capsys, flip):
    volume, labels = head_with_labels()
    head = saved(tmp_path / "head.nrrd", volume)
    beside = saved(tmp_path / "labels.nrrd", labels.volume)
    (tmp_path / "labels.ctbl").write_text("1 liver 200 50 50 255\n2 spleen 50 200 50 255\n")
    out = str(tmp_path / "a.png")
    base = ["render", head, "-o", out, *SMALL, *flip, "--preset", "ct-bone"]
    assert main([*base, "--labels", beside]) == 0
    assert main([*base, "--mask", beside]) == 0
    assert main([*base, "--labels", beside, "--hide", "liver"]) == 0
    assert "1 of 2 labels are hidden" in capsys.readouterr().out
    again = ["replay", out, "-o", str(tmp_path / "b.png"), "--input", head]
    assert main([*again, "--labels", beside]) == 0
    assert "the same bits" in capsys.readouterr().out
    assert main(again) == 2
    capsys.readouterr()
    assert main([*base, "--labels", beside, "--show", "lung"]) == 2
    assert "no label is called 'lung'; there are 1 liver, 2 spleen" in capsys.readouterr().err


def test_command_line_takes_the_labels_of_a_label_map(tmp_path, capsys):
    path = saved(tmp_path / "labels.nrrd", label_map().volume)
    out = str(tmp_path / "a.png")
    assert main(["render", path, "-o", out, *SMALL, "--show", "1,2"]) == 0
    assert "look labels: 2 of 3 labels" in capsys.readouterr().out
    assert main(["replay", out, "-o", str(tmp_path / "b.png"), "--input", path]) == 0
    assert "the same bits" in capsys.readouterr().out
    assert main(["replay", out, "-o", out, "--labels", path]) == 2
    assert "--labels needs --input" in capsys.readouterr().err


def test_flip_turns_volume_and_labels_alike(tmp_path):
    import argparse

    from vtkmcvr.commands.cutting import add_cutting_options, cutting_options

    volume, labels = head_with_labels()
    beside = saved(tmp_path / "labels.nrrd", labels.volume)
    parser = argparse.ArgumentParser()
    add_cutting_options(parser)
    parser.add_argument("--flip")
    args = parser.parse_args(["--labels", beside, "--show", "1", "--flip", "jk"])
    found = cutting_options(volume.flipped("jk"), {"size": (8, 6)}, args)["segmentation"]
    np.testing.assert_array_equal(found.volume.values, labels.volume.values)
    np.testing.assert_array_equal(found.volume.index_to_world, volume.flipped("jk").index_to_world)


def test_classes_of_a_real_segmentation_by_name():
    import vtkmcvr

    image = vtkmcvr.read(real_path("nifti/example_ct.nii.gz"))
    labels = vtkmcvr.read_labels(real_path("nifti/example_ct_labels.nii.gz"), like=image)
    chosen = Segmentation.of(labels, show=["kidney_*", "vertebrae_L?"])
    assert [chosen.names[value].name for value in chosen.shown] == [
        "kidney_right", "kidney_left", "vertebrae_L5", "vertebrae_L4", "vertebrae_L3",
        "vertebrae_L2", "vertebrae_L1",
    ]  # fmt: skip
    assert len(chosen.segments) == 117
