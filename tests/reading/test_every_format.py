"""Voxels, their types and their place survive, whatever the format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista
import SimpleITK
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from made_volumes import OBLIQUE, ORIGIN, SHAPE, SPACING, VOXELS, itk_image, save, voxels

from vtkmcvr.readers import notes, read
from vtkmcvr.reading.compact import compact_values


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("name", ["a.nrrd", "a.nhdr", "a.nii", "a.nii.gz", "a.mha", "a.mhd"])
def test_values_and_oblique_geometry_survive(tmp_path: Path, name: str, compressed: bool) -> None:
    image = read(save(tmp_path / name, gz=compressed))
    assert isinstance(image, pyvista.ImageData)
    assert image.dimensions == SHAPE[::-1]
    assert image.active_scalars_name == "values"
    np.testing.assert_array_equal(voxels(image), VOXELS)
    np.testing.assert_allclose(image.spacing, SPACING, rtol=1e-6)
    np.testing.assert_allclose(image.origin, ORIGIN, rtol=1e-6)
    np.testing.assert_allclose(image.direction_matrix, OBLIQUE, atol=1e-6)
    assert any("direction is not the identity" in note for note in notes(image))


def test_x_runs_fastest_in_one_contiguous_array(tmp_path: Path) -> None:
    image = read(save(tmp_path / "a.nrrd"))
    assert image.GetScalarComponentAsDouble(3, 2, 1, 0) == VOXELS[1, 2, 3]
    assert np.asarray(image.active_scalars).flags.c_contiguous


@pytest.mark.parametrize(
    ("stored", "kept"),
    [
        (VOXELS.astype(np.uint8), np.uint8),
        (VOXELS, np.int16),
        (VOXELS.astype(np.uint16), np.uint16),
        (VOXELS.astype(np.int32), np.int16),
        (VOXELS.astype(np.int32) + 40_000, np.uint16),
        (VOXELS.astype(np.int32) * 1000, np.int32),
        (VOXELS.astype(np.float32), np.float32),
        (VOXELS.astype(np.float64), np.int16),
        (VOXELS.astype(np.float64) / 3, np.float32),
        (VOXELS.astype(np.float64) * 1e300, np.float64),
    ],
)
def test_type_is_the_smallest_that_holds_the_values(
    tmp_path: Path, stored: np.ndarray, kept: type
) -> None:
    image = read(save(tmp_path / "a.nrrd", stored))
    assert voxels(image).dtype == kept
    np.testing.assert_allclose(voxels(image), stored, rtol=1e-7)
    assert any(note.startswith("stored as") for note in notes(image)) == (stored.dtype != kept)


@settings(max_examples=60, deadline=None)
@given(arrays(np.float64, (2, 2, 2), elements=st.floats(width=64, allow_subnormal=False)))
def test_compact_values_never_change_by_more_than_float32_rounding(values: np.ndarray) -> None:
    compact = compact_values(values, [])
    np.testing.assert_allclose(compact.astype(np.float64), values, rtol=1e-7, atol=1e-37)


def test_nan_and_infinity_are_counted(tmp_path: Path) -> None:
    values = VOXELS.astype(np.float64)
    values[0, 0, :3] = np.nan, np.inf, -np.inf
    image = read(save(tmp_path / "a.mha", values))
    assert voxels(image).dtype == np.float32
    assert {"NaN values: 1", "infinite values: 2"} <= set(notes(image))


@pytest.mark.parametrize("count", [2, 3, 4])
def test_components_are_kept(tmp_path: Path, count: int) -> None:
    colours = np.stack([VOXELS + n for n in range(count)], axis=-1)
    image = read(save(tmp_path / "a.nrrd", colours, vector=True))
    np.testing.assert_array_equal(voxels(image), colours)


def test_one_volume_in_four_dimensions_is_read(tmp_path: Path) -> None:
    image = read(save(tmp_path / "a.nrrd", VOXELS[None]))
    np.testing.assert_array_equal(voxels(image), VOXELS)


def test_shear_is_kept_and_noted(tmp_path: Path) -> None:
    angle = np.radians(14.0)
    image = itk_image()
    image.SetDirection([1, 0, 0, 0, 1, np.sin(angle), 0, 0, np.cos(angle)])
    SimpleITK.WriteImage(image, str(tmp_path / "a.nrrd"))
    loaded = read(tmp_path / "a.nrrd")
    np.testing.assert_allclose(loaded.direction_matrix[:, 2], [0, np.sin(angle), np.cos(angle)])
    assert any("sheared by 14.0 degrees" in note for note in notes(loaded))


def test_left_handed_axes_are_noted(tmp_path: Path) -> None:
    image = itk_image()
    image.SetDirection([-1, 0, 0, 0, 1, 0, 0, 0, 1])
    SimpleITK.WriteImage(image, str(tmp_path / "a.nrrd"))
    assert "the index axes are left-handed" in notes(read(tmp_path / "a.nrrd"))
