"""Series that are no plain box: several volumes, doubled and odd slices, uneven steps, tilt."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from made_dicom import NORMAL, positions, write_series, write_slice
from made_volumes import SHAPE, VOXELS, affine, error_of, real, voxels

from vtkmcvr.readers import notes, read, time_steps

AXIAL = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]


def series_of(folder: Path, volumes: int, places: int = 3, **attributes: object) -> Path:
    """Write `volumes` volumes at the same places; volume v holds VOXELS + 1000 v."""
    pixels = np.concatenate([VOXELS[:places] + 1000 * v for v in range(volumes)])
    return write_series(folder, pixels, positions(places) * volumes, **attributes)


@pytest.mark.parametrize(
    ("attribute", "values", "times"),
    [
        ("TemporalPositionIdentifier", (1, 2, 3), [0, 1, 2]),
        ("TriggerTime", (0.0, 40.5, 81.0), [0, 0.0405, 0.081]),
        ("AcquisitionTime", ("120000.5", "120004.5", "120101"), [0, 4, 60.5]),
        ("AcquisitionNumber", (5, 6, 10), [0, 1, 2]),
    ],
)
def test_time_series(tmp_path: Path, attribute: str, values: tuple, times: list[float]) -> None:
    each = tuple(value for value in values for _ in range(3))
    folder = series_of(tmp_path / "a", 3, **{attribute: each})
    assert time_steps(folder) == pytest.approx(times)
    np.testing.assert_array_equal(voxels(read(folder)), VOXELS[:3])
    assert "volume 0 of 0 to 2 read (time steps); choose another with time=" in notes(read(folder))
    np.testing.assert_array_equal(voxels(read(folder, time=2)), VOXELS[:3] + 2000)


def test_cine_whose_clock_differs_from_slice_to_slice(tmp_path: Path) -> None:
    clock = (0.0, 3.0, 5.0, 50.0, 52.0, 51.0)
    folder = series_of(tmp_path / "a", 2, TriggerTime=clock)
    np.testing.assert_array_equal(voxels(read(folder, time=1)), VOXELS[:3] + 1000)


def test_numbers_put_slices_in_order_where_nothing_else_does(tmp_path: Path) -> None:
    folder = series_of(tmp_path / "a", 2, InstanceNumber=(4, 5, 6, 1, 2, 3))
    np.testing.assert_array_equal(voxels(read(folder, time=0)), VOXELS[:3] + 1000)


@pytest.mark.parametrize(
    ("attribute", "values", "name"),
    [
        ("EchoTime", (4.6, 12.0), "echo time"),
        ("DiffusionBValue", (0.0, 1000.0), "b-value"),
        ("ImageType", (["ORIGINAL", "PRIMARY", "M"], ["ORIGINAL", "PRIMARY", "P"]), "image type"),
    ],
)
def test_volumes_that_are_no_time_steps_must_be_chosen(
    tmp_path: Path, attribute: str, values: tuple, name: str
) -> None:
    each = tuple(value for value in values for _ in range(3))
    folder = series_of(tmp_path / "a", 2, **{attribute: each})
    message = error_of(folder)
    assert f"2 volumes that share their positions and differ in {name}" in message
    assert "choose one with time=0 to time=1" in message
    for index in (0, 1):
        np.testing.assert_array_equal(voxels(read(folder, time=index)), VOXELS[:3] + 1000 * index)
    assert "there is no volume with time=2; allowed is 0 to 1" in error_of(folder, time=2)


def test_slices_that_nothing_tells_apart(tmp_path: Path) -> None:
    folder = series_of(tmp_path / "a", 2)
    assert "2 slices lie at one position (slice 1 of 3" in error_of(folder)
    image = read(folder, ignore="duplicates")
    assert image.dimensions[2] == 3
    assert "3 slices left out: another one lies at their position" in notes(image)


def test_interleaved_image_types(tmp_path: Path) -> None:
    kinds = tuple([["ORIGINAL", "PRIMARY"]] * 5 + [["DERIVED", "SECONDARY", "MPR"]] * 2)
    pixels = np.concatenate([VOXELS, VOXELS[:2] - 9])
    folder = write_series(tmp_path / "a", pixels, positions(5) + positions(2), ImageType=kinds)
    message = error_of(folder)
    assert "2 slices lie at one position (slice 1 of 5" in message
    assert "differ in image type" in message
    assert "give ignore='image types' to keep the most frequent image type, or" in message
    image = read(folder, ignore="image-types")
    np.testing.assert_array_equal(voxels(image), VOXELS)
    assert "2 slices left out: other image types" in notes(image)


def test_orientations_and_sizes_can_be_left_out(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "a")
    write_slice(folder / "scout", VOXELS[0], [0, 0, 0], ImageOrientationPatient=AXIAL)
    assert "give ignore='orientations' to keep the most frequent one" in error_of(folder)
    np.testing.assert_array_equal(voxels(read(folder, ignore="orientations")), VOXELS)
    write_slice(folder / "small", VOXELS[0, :3], positions(6)[5])
    assert "give ignore='orientations'" in error_of(folder, ignore="sizes")
    image = read(folder, ignore=("orientations", "sizes"))
    np.testing.assert_array_equal(voxels(image), VOXELS)
    write_slice(folder / "nowhere", VOXELS[0], None)
    assert "1 of 8 slices have no position" in error_of(folder)
    image = read(folder, ignore=("orientations", "sizes", "unplaced"))
    np.testing.assert_array_equal(voxels(image), VOXELS)


def test_unknown_choices_are_refused(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "a")
    with pytest.raises(ValueError, match="ignore must be among 'damaged', 'duplicates'"):
        read(folder, ignore="gaps")
    with pytest.raises(ValueError, match="units must be 'suv'"):
        read(folder, units="HU")
    with pytest.raises(ValueError, match="time must be 0 or more"):
        read(folder, time=-1)
    with pytest.raises(TypeError, match="time must be a whole number"):
        read(folder, time=0.5)
    with pytest.raises(ValueError, match="spacing must be 3 finite numbers"):
        read(folder, spacing=(1, 2))


# Resampling


def ramp(points: np.ndarray) -> np.ndarray:
    """A field that linear interpolation gives exactly, at points (..., 3)."""
    return 40.0 * points[..., 0] - 24.0 * points[..., 1] + 60.0 * points[..., 2] + 500.0


def axial_series(folder: Path, places: list[list[float]]) -> Path:
    """Write axial slices of `ramp` with pixels of 1 mm; values are whole."""
    j, i = np.indices((12, 10))
    points = np.stack([i, j, np.zeros_like(i)], axis=-1)
    pixels = np.stack([ramp(points + place) for place in places]).astype(np.int16)
    geometry = {"ImageOrientationPatient": AXIAL, "PixelSpacing": [1.0, 1.0]}
    return write_series(folder, pixels, places, **geometry)


def points_of(image: object) -> np.ndarray:
    i, j, k = np.indices(image.dimensions)
    index = np.stack([i, j, k, np.ones_like(i)], axis=-1).transpose(2, 1, 0, 3)
    return (index @ affine(image).T)[..., :3]


def test_missing_slice_is_interpolated_at_its_place(tmp_path: Path) -> None:
    folder = axial_series(tmp_path / "a", [[0, 0, z] for z in (0, 2, 4, 8, 10)])
    assert "1 missing slice" in error_of(folder)
    image = read(folder, resample=True)
    assert image.dimensions == (10, 12, 6)
    np.testing.assert_allclose(image.spacing, (1, 1, 2))
    np.testing.assert_array_equal(voxels(image), ramp(points_of(image)))
    assert "5 slices at uneven steps resampled to 6 with a step of 2 mm" in notes(image)


def test_uneven_steps_are_resampled_by_true_position(tmp_path: Path) -> None:
    folder = axial_series(tmp_path / "a", [[0, 0, z] for z in (0, 1, 3, 6, 8, 10, 13)])
    assert "an uneven step" in error_of(folder) or "missing slice" in error_of(folder)
    image = read(folder, resample=True)
    np.testing.assert_allclose(voxels(image), ramp(points_of(image)), atol=0.51)


def test_gantry_tilt_is_kept_or_made_a_box(tmp_path: Path) -> None:
    folder = axial_series(tmp_path / "a", [[0.0, 0.5 * k, 2.0 * k] for k in range(8)])
    sheared = read(folder)
    np.testing.assert_allclose(affine(sheared)[:3, 2], [0, 0.5, 2])
    np.testing.assert_array_equal(voxels(sheared), ramp(points_of(sheared)))
    image = read(folder, resample=True)
    np.testing.assert_allclose(image.direction_matrix, np.eye(3), atol=1e-9)
    np.testing.assert_allclose(image.spacing, (1, 1, 2))
    assert image.dimensions == (10, 16, 8)
    assert "sheared, resampled to a box" in notes(image)
    # Outside the slices there is the lowest value; inside, the field itself.
    points = points_of(image)
    inside = points[..., 1] - 0.25 * points[..., 2]
    known = (inside >= 0) & (inside <= 11)
    np.testing.assert_allclose(voxels(image)[known], ramp(points)[known], atol=0.51)
    assert set(voxels(image)[(inside < -0.5) | (inside > 11.5)]) == {voxels(sheared).min()}


def test_tilted_and_uneven_at_once(tmp_path: Path) -> None:
    folder = axial_series(tmp_path / "a", [[0.0, 0.25 * z, z] for z in (0.0, 2, 4, 8, 10, 16)])
    image = read(folder, resample=True)
    points = points_of(image)
    inside = points[..., 1] - 0.25 * points[..., 2]
    known = (inside >= 1) & (inside <= 10)
    np.testing.assert_allclose(voxels(image)[known], ramp(points)[known], atol=1.1)


def test_shifted_slices_are_put_where_they_lie(tmp_path: Path) -> None:
    places = [[0.0, 0.0, 2.0 * k] for k in range(6)]
    places[3] = [1.5, -0.75, 6.0]
    folder = axial_series(tmp_path / "a", places)
    assert "do not lie on one straight line" in error_of(folder)
    image = read(folder, resample=True)
    inner = (slice(None), slice(1, -1), slice(2, -2))
    np.testing.assert_allclose(voxels(image)[inner], ramp(points_of(image))[inner], atol=0.51)


def test_resampling_leaves_a_plain_box_alone(tmp_path: Path) -> None:
    image = read(write_series(tmp_path / "a"), resample=True)
    np.testing.assert_array_equal(voxels(image), VOXELS)
    assert image.dimensions == SHAPE[::-1]


def test_colours_are_resampled_too(tmp_path: Path) -> None:
    places = [list(np.array([1.0, 2.0, 3.0]) + z * NORMAL) for z in (0, 2, 4, 8)]
    pixels = np.arange(4 * 6 * 7 * 3).reshape(4, 6, 7, 3).astype(np.uint8)
    colours = {"SamplesPerPixel": 3, "PhotometricInterpretation": "RGB", "BitsAllocated": 8,
               "BitsStored": 8, "HighBit": 7, "PlanarConfiguration": 0, "Rows": 6,
               "Columns": 7}  # fmt: skip
    image = read(write_series(tmp_path / "a", pixels, places, **colours), resample=True)
    assert voxels(image).shape == (5, 6, 7, 3)
    np.testing.assert_array_equal(voxels(image)[[0, 1, 2, 4]], pixels)
    between = (pixels[2].astype(float) + pixels[3]) / 2
    np.testing.assert_allclose(voxels(image)[3], between, atol=0.51)


@pytest.mark.parametrize(
    ("name", "options", "size", "spacing"),
    [
        ("hard_missing_slice_4", {"resample": True}, (512, 512, 5), 5.0),
        ("hard_gantry_tilt_4", {"resample": True}, (512, 521, 4), 4.8515),
        ("hard_mixed_orientation_4", {"ignore": "orientations"}, (288, 288, 2), 3.3),
    ],
)
def test_advice_about_hard_series_works(
    name: str, options: dict, size: tuple[int, int, int], spacing: float
) -> None:
    image = read(real(f"dicom/{name}"), **options)
    assert image.dimensions == size
    np.testing.assert_allclose(image.spacing[2], spacing, atol=1e-3)
    direction = np.asarray(image.direction_matrix)
    np.testing.assert_allclose(direction.T @ direction, np.eye(3), atol=1e-5)


def test_one_position_stays_no_volume() -> None:
    message = error_of(real("dicom/hard_same_position_4"), ignore="duplicates")
    assert "has one slice, which is a 2-D image" in message
