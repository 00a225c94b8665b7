"""Looks: which one is chosen, where its nodes land, what is told."""

import numpy as np
import pytest

from vtkmcvr.phantom import head_phantom
from vtkmcvr.presets import LOOKS, choose_look, dress, hu_offset, look_named, threshold
from vtkmcvr.scene import Volume
from vtkmcvr.studio import view_camera

HEAD = head_phantom(48)


def dressed(volume, preset=None, **options):
    return dress(volume, view_camera(volume), preset, size=(8, 6), **options)


def test_hu_is_recognised():
    assert hu_offset(HEAD.values) == 0.0
    assert choose_look(HEAD.values) == "ct-bone"


@pytest.mark.parametrize("offset", [1000, 1024])
def test_hu_stored_unsigned_is_recognised_and_told(offset):
    stored = np.clip(HEAD.values + offset, 0, None).astype(np.uint16)
    assert hu_offset(stored) == -offset
    result = dressed(Volume.from_grid(stored, HEAD.spacing), "ct-bone")
    assert any(f"-{offset}" in note for note in result.notes)
    bone = result.scene.transfer.opacity
    assert bone(450.0 + offset) == pytest.approx(0.75)
    assert bone(149.0 + offset) == 0.0


def test_other_data_is_not_hu():
    ramp = np.arange(4096, dtype=np.uint8).reshape(16, 16, 16)
    assert hu_offset(ramp) is None
    assert choose_look(ramp) == "solid"
    assert choose_look(ramp, modality="MR") == "mr-head"
    assert choose_look(ramp, modality="PT") == choose_look(ramp, units="SUV") == "pet-fusion"


def ct(**shares):
    """CT of air with these shares of the voxels at these HU."""
    values = np.full(20**3, -1000, np.int16)
    start = 0
    for hu, share in shares.values():
        end = start + round(share * values.size)
        values[start:end] = hu
        start = end
    return values.reshape(20, 20, 20)


def test_ct_without_bone_shows_tissue_and_air_alone_is_no_body():
    tissue, bone = (40, 0.4), (900, 0.01)
    assert choose_look(ct(tissue=tissue, bone=bone), "HU") == "ct-bone"
    assert choose_look(ct(tissue=tissue), "HU") == "ct-soft"
    assert choose_look(ct(lung=(-850, 0.4)), "HU") == "solid"


def test_values_of_both_signs_and_labels_are_told_by_their_statistics():
    noise = np.random.default_rng(1).normal(size=(20, 20, 20))
    assert choose_look(noise) == "signed"
    assert choose_look(np.abs(noise)) == "solid"
    blocks = np.zeros((20, 20, 20), np.uint8)
    blocks[2:9], blocks[11:18, 4:] = 3, 7
    assert choose_look(blocks) == "labels"
    measured = np.random.default_rng(2).integers(0, 200, (20, 20, 20)).astype(np.uint8)
    assert choose_look(measured) == "solid"


def test_a_given_shift_wins():
    result = dressed(Volume.from_grid(HEAD.values), "ct-bone", shift=-100.0)
    assert result.scene.transfer.opacity(450.0 + 100.0) == pytest.approx(0.75)


def test_a_hu_look_on_other_data_takes_percentiles_and_says_so():
    volume = Volume.from_grid(np.arange(512, dtype=np.float32).reshape(8, 8, 8))
    result = dressed(volume, "ct-bone")
    assert "do not look like HU" in result.notes[1]
    opacity = result.scene.transfer.opacity
    # The lowest value stands for air, the 99.9th percentile for dense bone.
    assert opacity(0.0) == 0.0
    assert opacity(511.0) > 0.9


def test_the_one_line_tells_range_units_and_optical_depth():
    values = np.full((11, 11, 11), 1000.0, np.float32)
    values[0, 0, 0] = -1000.0
    volume = Volume.from_grid(values, (2.0, 2.0, 2.0))
    line = dressed(volume, "ct-bone", units="HU").notes[0]
    opacity = LOOKS["ct-bone"].opacity
    share = (1000 - opacity[-2][0]) / (opacity[-1][0] - opacity[-2][0])
    alpha = opacity[-2][1] + share * (opacity[-1][1] - opacity[-2][1])
    # 20 mm of the same extinction
    depth = -20 * np.log1p(-alpha)
    told = float(line.split("centre ")[1])
    assert told == pytest.approx(depth, rel=0.01)
    assert "look ct-bone, as asked: values -1000 to 1000 HU, seen from 150 to 1200" in line
    assert "chosen from the values" in dressed(volume).notes[0]
    empty = dressed(Volume.from_grid(values * 0 - 1000.0), "ct-bone", units="HU").notes[0]
    assert empty.endswith("there is nothing to see")


def test_a_field_that_goes_on_beyond_its_faces_is_no_box():
    i, j, k = np.indices((24, 24, 24))
    field = 100.0 + i - 10.0 * (np.hypot(j - 12, k - 12) < 3)
    volume = Volume.from_grid(field)
    level = dressed(volume, "solid").scene.transfer.opacity.nodes[0][0]
    faces = [np.take(field, end, axis) for axis in range(3) for end in (0, -1)]
    assert np.mean(np.concatenate(faces) > level) < 0.5
    assert np.mean(field > level) > 0.02


def test_threshold_splits_two_classes():
    values = np.concatenate([np.full(700, 10.0), np.full(300, 200.0)])
    assert 10 < threshold(values) < 200


def test_relative_look_follows_the_range():
    low = Volume.from_grid((np.arange(4096.0) / 4096).reshape(16, 16, 16))
    high = Volume.from_grid(low.values * 5e6 - 1e6)
    a, b = (dressed(v, "mr-head").scene.transfer for v in (low, high))
    x = np.linspace(0, 1, 9)
    np.testing.assert_allclose(a.opacity(x), b.opacity(x * 5e6 - 1e6), atol=1e-3)


@pytest.mark.parametrize("values", [np.zeros((4, 4, 4)), np.full((4, 4, 4), np.nan)])
def test_constant_and_empty_volumes_can_be_dressed(values):
    result = dressed(Volume.from_grid(values))
    assert result.preset == "solid"
    assert result.notes[0].endswith("there is nothing to see")


def test_unknown_preset_lists_the_looks():
    with pytest.raises(ValueError, match=r"preset is one of ct-bone, .*got 'ct-bnoe'"):
        look_named("ct-bnoe")


def test_the_looks_are_there():
    assert set(LOOKS) == {
        "ct-bone", "ct-skin", "ct-soft", "ct-vessels", "ct-lung", "ct-airways", "ct-heart",
        "mr-head", "mr-brain", "mr-angio", "pet-fusion", "solid", "microct", "signed", "cloud",
        "labels",
    }  # fmt: skip


@pytest.mark.parametrize("look", LOOKS.values(), ids=list(LOOKS))
def test_every_look_has_increasing_nodes_and_colours_where_it_is_seen(look):
    positions = [node[0] for node in look.opacity]
    assert positions == sorted(set(positions))
    assert all(0.0 <= a < 1.0 for _, a in look.opacity)
    assert any(a > 0.2 for _, a in look.opacity)
    assert max(c for _, *rgb in look.colour for c in rgb) >= 0.4
