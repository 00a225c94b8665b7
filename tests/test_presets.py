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
    assert choose_look(ramp, units="HU") == "ct-bone"


def test_a_given_shift_wins():
    result = dressed(Volume.from_grid(HEAD.values), "ct-bone", shift=-100.0)
    assert result.scene.transfer.opacity(450.0 + 100.0) == pytest.approx(0.75)


def test_a_hu_look_on_other_data_says_so():
    volume = Volume.from_grid(np.arange(512, dtype=np.uint8).reshape(8, 8, 8))
    assert "do not look like HU" in dressed(volume, "ct-bone").notes[0]


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
    assert dressed(Volume.from_grid(values)).preset == "solid"


def test_unknown_preset_lists_the_looks():
    with pytest.raises(ValueError, match=r"preset is one of ct-bone, .*got 'ct-bnoe'"):
        look_named("ct-bnoe")


def test_the_three_looks_are_there():
    assert {"ct-bone", "ct-skin", "mr-head"} <= set(LOOKS)
