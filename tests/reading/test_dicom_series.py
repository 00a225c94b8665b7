"""A DICOM series: sorted, rescaled, and with its unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from made_dicom import positions, write_series, write_slice
from made_volumes import OBLIQUE, ORIGIN, SECRET, SPACING, VOXELS, error_of, voxels

from vtkmcvr.readers import modality, notes, read, units


def test_series_is_sorted_by_position_with_exact_geometry(tmp_path: Path) -> None:
    image = read(write_series(tmp_path / "ct"))
    np.testing.assert_array_equal(voxels(image), VOXELS)
    assert voxels(image).dtype == np.int16
    np.testing.assert_allclose(image.spacing, SPACING)
    np.testing.assert_allclose(image.origin, ORIGIN)
    np.testing.assert_allclose(image.direction_matrix, OBLIQUE * [1, 1, 1], atol=1e-6)
    assert (modality(image), units(image)) == ("CT", "HU")
    assert "read as DICOM series" in notes(image)
    assert SECRET not in " ".join(notes(image))


def test_hounsfield_rescale(tmp_path: Path) -> None:
    stored = (VOXELS + 40).astype(np.uint16)
    image = read(write_series(tmp_path / "ct", stored, RescaleIntercept=-1024))
    np.testing.assert_array_equal(voxels(image), stored.astype(np.int16) - 1024)
    assert voxels(image).dtype == np.int16
    assert "rescaled: value = 1 x stored + -1024" in notes(image)


def test_each_slice_is_rescaled_exactly_when_the_first_is_whole(tmp_path: Path) -> None:
    slopes, intercepts = (1, 0.5, 0.25, 2, 1), (0, -3.25, 7, 100, 0)
    folder = write_series(tmp_path / "mr", RescaleSlope=slopes, RescaleIntercept=intercepts)
    expected = VOXELS * np.reshape(slopes, (5, 1, 1)) + np.reshape(intercepts, (5, 1, 1))
    image = read(folder)
    np.testing.assert_array_equal(voxels(image), expected)
    assert any("differ between slices" in note for note in notes(image))


def test_units_are_hu_only_for_rescaled_ct(tmp_path: Path) -> None:
    assert units(read(write_series(tmp_path / "mr", Modality="MR"))) == ""
    unspecified = read(write_series(tmp_path / "us", RescaleType="US"))
    assert units(unspecified) == ""
    assert "the rescale type is not HU" in notes(unspecified)
    raw = write_series(
        tmp_path / "raw", VOXELS.astype(np.uint16), RescaleSlope=None, RescaleIntercept=None
    )
    assert units(read(raw)) == ""
    assert any("stored unsigned without rescale" in note for note in notes(read(raw)))
    pet = read(write_series(tmp_path / "pet", Modality="PT", Units="BQML"))
    assert "unit of the values: BQML" in notes(pet)


def test_useless_headers(tmp_path: Path) -> None:
    skewed = write_series(tmp_path / "a", ImageOrientationPatient=[1, 0, 0, 1, 0, 0])
    assert "not two perpendicular directions" in error_of(skewed)
    zoomed = write_series(tmp_path / "b", PixelSpacing=tuple([[1, 1]] * 4 + [[2, 2]]))
    assert "the pixel spacing differs between the slices" in error_of(zoomed)
    nowhere = write_series(tmp_path / "c", PixelSpacing=None)
    assert "5 of 5 slices have no position, orientation or pixel spacing" in error_of(nowhere)
    constant = write_series(tmp_path / "d", RescaleSlope=0)
    assert "a rescale slope of 0" in error_of(constant)


def test_sizes_differ(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "ct")
    write_slice(folder / "other", VOXELS[0, :3], positions(6)[5])
    assert "slices of different size (5 of 6 x 7, 1 of 3 x 7)" in error_of(folder)


def test_single_slice_file(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "ct")
    np.testing.assert_array_equal(voxels(read(folder / "4-99")), VOXELS)
    assert "'series' is only for DICOM folders" in error_of(folder / "4-99", series=4)
    write_slice(tmp_path / "plan.dcm", VOXELS[0], None, Rows=None, Columns=None)
    assert "a DICOM file without an image" in error_of(tmp_path / "plan.dcm")
