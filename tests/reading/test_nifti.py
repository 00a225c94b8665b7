"""NIfTI: its units and orientation, and what is wrong with bad ones."""

from __future__ import annotations

import gzip
import struct
from pathlib import Path

import numpy as np
import pytest
from made_volumes import SPACING, VOXELS, error_of, save, voxels

from vtkmcvr.readers import notes, read


def test_nifti_lengths_become_mm_and_missing_orientation_is_noted(tmp_path: Path) -> None:
    path = save(tmp_path / "a.nii")
    data = bytearray(path.read_bytes())
    data[123] = (data[123] & ~7) | 3
    path.write_bytes(data)
    image = read(path)
    np.testing.assert_allclose(image.spacing, np.array(SPACING) / 1000, rtol=1e-6)
    assert "lengths converted from um to mm" in notes(image)
    data[252:256] = bytes(4)
    path.write_bytes(data)
    assert any("nothing about left and right" in note for note in notes(read(path)))


def test_four_dimensional_nifti(tmp_path: Path) -> None:
    path = save(tmp_path / "a.nii", np.stack([VOXELS + k for k in range(4)]))
    np.testing.assert_array_equal(voxels(read(path)), VOXELS)
    np.testing.assert_array_equal(voxels(read(path, time=3)), VOXELS + 3)
    assert any("volume 0 of 0 to 3 read (time steps)" in note for note in notes(read(path)))
    assert "there is no volume with time=4; allowed is 0 to 3" in error_of(path, time=4)


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz"])
def test_truncated_nifti_is_refused(tmp_path: Path, name: str) -> None:
    noise = np.random.default_rng(1).integers(-999, 999, (9, 40, 40)).astype(np.int16)
    path = save(tmp_path / name, noise)
    whole = path.read_bytes()
    for kept in (len(whole) - 20, len(whole) // 2):
        path.write_bytes(whole[:kept])
        assert "truncated" in error_of(path)


def test_gzip_in_several_members_is_read(tmp_path: Path) -> None:
    path = save(tmp_path / "a.nii")
    data = path.read_bytes()
    joined = tmp_path / "b.nii.gz"
    joined.write_bytes(gzip.compress(data[:400]) + gzip.compress(data[400:]))
    np.testing.assert_array_equal(voxels(read(joined)), VOXELS)


def test_bad_nifti_header(tmp_path: Path) -> None:
    good = save(tmp_path / "a.nii").read_bytes()
    path = tmp_path / "b.nii"
    for data, problem in (
        (b"text" * 100, "not a NIfTI file"),
        (struct.pack("<i", 540) + good[4:], "not a NIfTI file (its header is damaged)"),
        (good[:344] + b"ni1\0" + good[348:], "a NIfTI header without voxels"),
        (good[:108] + struct.pack("<f", np.nan) + good[112:], "the header is damaged"),
    ):
        path.write_bytes(data)
        assert problem in error_of(path)
    compressed = tmp_path / "c.nii.gz"
    compressed.write_bytes(b"not gzip at all")
    assert "damaged or truncated gzip data" in error_of(compressed)
