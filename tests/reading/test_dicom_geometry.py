"""Planes of DICOM slices: one regular stack, or a sentence about why not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_dicom import NORMAL, positions, write_series
from made_volumes import VOXELS, affine, error_of, voxels

from vtkmcvr.readers import VolumeReadError, notes, read
from vtkmcvr.reading.dicom_geometry import Plane, judge_stack


def test_gantry_tilt_stays_as_shear(tmp_path: Path) -> None:
    step = 4.0 * NORMAL + np.array([0.0, 0.0, 1.0])
    image = read(write_series(tmp_path / "ct", places=positions(5, step)))
    np.testing.assert_allclose(image.spacing[2], np.sqrt(17.0), rtol=1e-6)
    np.testing.assert_allclose(affine(image)[:3, 2], step, atol=1e-6)
    assert any("sheared by 14.0 degrees" in note for note in notes(image))


def test_small_irregularity_is_allowed_and_noted(tmp_path: Path) -> None:
    places = positions(5)
    places[2] = list(np.array(places[2]) + 0.02 * NORMAL)
    image = read(write_series(tmp_path / "ct", places=places))
    assert "slices lie up to 0.020 mm off the even step of 2.5000 mm" in notes(image)


def test_missing_slice(tmp_path: Path) -> None:
    places = positions(7)
    message = error_of(write_series(tmp_path / "ct", places=places[:2] + places[4:]))
    assert "series 4 (CT): 2 missing slices between slice 2 and slice 3 of 5" in message
    assert "7.500 mm where 2.500 mm is usual, and steps may differ by 0.050 mm" in message


def test_uneven_step(tmp_path: Path) -> None:
    places = positions(5)
    places[4] = list(np.array(places[4]) + 0.5 * NORMAL)
    assert "an uneven step between slice 4 and slice 5 of 5" in error_of(
        write_series(tmp_path / "ct", places=places)
    )


def test_slices_beside_the_line(tmp_path: Path) -> None:
    places = positions(5)
    places[2] = [places[2][0], places[2][1], places[2][2] + 0.6]
    message = error_of(write_series(tmp_path / "ct", places=places))
    assert "do not lie on one straight line with an even step: slice 3 of 5 is 0.600 mm" in message


def test_drifting_step() -> None:
    heights = np.cumsum([0.0] + [0.99] * 200 + [1.005] * 201)
    planes = [Plane((0.0, 0.0, z), (1, 0, 0, 0, 1, 0), (1.0, 1.0)) for z in heights]
    with pytest.raises(VolumeReadError, match="half a voxel is allowed"):
        judge_stack(planes, "series 1 (CT)")


def test_several_slices_at_one_position(tmp_path: Path) -> None:
    places = positions(4)
    message = error_of(write_series(tmp_path / "ct", places=[*places, places[1]]))
    assert "2 slices lie at one position (slice 2 of 4, -29.20 mm)" in message


def test_four_dimensional_series(tmp_path: Path) -> None:
    places = positions(3) * 2
    folder = write_series(
        tmp_path / "mr", VOXELS[[0, 1, 2, 0, 1, 2]], places, EchoTime=(5, 5, 5, 9, 9, 9)
    )
    message = error_of(folder)
    assert "2 volumes that share their positions and differ in echo time" in message
    assert "choose one with time=0 to time=1" in message
    np.testing.assert_array_equal(voxels(read(folder, time=1)), VOXELS[[0, 1, 2]])


def test_mixed_orientations(tmp_path: Path) -> None:
    axial, sagittal = [1, 0, 0, 0, 1, 0], [0, 1, 0, 0, 0, -1]
    folder = write_series(
        tmp_path / "mr", ImageOrientationPatient=(axial, axial, axial, sagittal, sagittal)
    )
    assert "different orientations (2 sagittal, 3 axial)" in error_of(folder)


@settings(max_examples=40, deadline=None)
@given(
    st.permutations(range(6)),
    st.floats(0.1, 20.0),
    st.floats(-0.5, 0.5),
    st.tuples(*[st.floats(-1e4, 1e4)] * 3),
)
def test_stack_geometry_does_not_depend_on_the_order(
    order: list[int], step: float, tilt: float, origin: tuple[float, float, float]
) -> None:
    along = step * np.array([0.0, np.sin(tilt), np.cos(tilt)])
    places = [tuple(np.array(origin) + k * along) for k in order]
    planes = [Plane(place, (1, 0, 0, 0, 1, 0), (2.0, 3.0)) for place in places]
    geometry = judge_stack(planes, "series 1 (CT)")
    assert [order[index] for index in geometry.order] == list(range(6))
    np.testing.assert_allclose(geometry.spacing, [3.0, 2.0, step], rtol=1e-7)
    np.testing.assert_allclose(geometry.direction[:, 2] * step, along, atol=1e-7)
