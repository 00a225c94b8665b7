"""Multi-frame DICOM files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from made_dicom import positions, write_multiframe, write_slice
from made_volumes import OBLIQUE, ORIGIN, SPACING, VOXELS, error_of, voxels
from pydicom.uid import MRImageStorage

from vtkmcvr.readers import modality, notes, read, units


@pytest.mark.parametrize("order", [[0, 1, 2, 3, 4], [4, 3, 2, 1, 0], [2, 0, 4, 1, 3]])
def test_frames_are_sorted_by_position(tmp_path: Path, order: list[int]) -> None:
    places = [positions(5)[k] for k in order]
    for target in (tmp_path / "frames", tmp_path / "folder" / "a.dcm"):
        write_multiframe(target, places, pixels=VOXELS[order])
    for source in (tmp_path / "frames", tmp_path / "folder"):
        image = read(source)
        np.testing.assert_array_equal(voxels(image), 2 * VOXELS + 5)
        np.testing.assert_allclose(image.spacing, SPACING)
        np.testing.assert_allclose(image.origin, ORIGIN)
        np.testing.assert_allclose(image.direction_matrix, OBLIQUE, atol=1e-6)
        assert (modality(image), units(image)) == ("MR", "")


def test_bad_multiframe(tmp_path: Path) -> None:
    path = tmp_path / "a.dcm"
    places = positions(5)
    write_multiframe(path, places[:4] + places[:1])
    assert "2 slices lie at one position" in error_of(path)
    write_multiframe(path, places, frames=4)
    assert "the header places another number of frames than it has" in error_of(path)
    write_multiframe(path, places)
    path.write_bytes(path.read_bytes()[:-20])
    assert "the pixels of a slice cannot be decoded" in error_of(path)


def test_each_frame_is_rescaled_by_its_own_slope(tmp_path: Path) -> None:
    rescales = [(1.0, 0.0), (2.0, -7.0), (0.5, 3.0), (1.0, 9.0), (4.0, 0.0)]
    image = read(write_multiframe(tmp_path / "a.dcm", positions(5), rescales))
    slopes, intercepts = np.reshape(rescales, (5, 2, 1, 1)).transpose(1, 0, 2, 3)
    np.testing.assert_array_equal(voxels(image), VOXELS * slopes + intercepts)


def test_frames_of_several_files_become_one_stack(tmp_path: Path) -> None:
    for name, part in (("b", slice(0, 2)), ("a", slice(2, 5))):
        places, pixels = positions(5)[part], VOXELS[part]
        write_multiframe(tmp_path / "s" / name, places, pixels=pixels, frames=len(places))
    np.testing.assert_array_equal(voxels(read(tmp_path / "s")), 2 * VOXELS + 5)


def test_frames_without_a_place_are_noted(tmp_path: Path) -> None:
    path = tmp_path / "a.dcm"
    write_slice(path, VOXELS, None, SOPClassUID=MRImageStorage, NumberOfFrames=5)
    image = read(path)
    assert any("no place for its frames" in note for note in notes(image))
