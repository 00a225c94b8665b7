"""Judge where a stack of DICOM planes lies in the world, and whether it is one regular volume."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .errors import VolumeReadError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

STEP_TOLERANCE = 0.02
STEP_TOLERANCE_MM = 0.01
SAME_POSITION_MM = 1e-3
ORIENTATION_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Plane:
    """Where one slice or frame lies: DICOM attributes of the image plane, lengths in mm.

    Attributes
    ----------
    position : tuple of 3 floats
        ImagePositionPatient: centre of the first pixel.
    orientation : tuple of 6 floats
        ImageOrientationPatient: direction of growing column index, then of growing row index.
    pixel_spacing : tuple of 2 floats
        PixelSpacing: between rows, then between columns.
    """

    position: tuple[float, ...]
    orientation: tuple[float, ...]
    pixel_spacing: tuple[float, ...]


@dataclass(frozen=True)
class StackGeometry:
    """A regular stack: its place in the LPS world (mm) and the order of its planes.

    Attributes
    ----------
    origin, spacing : ndarray, shape (3,)
        Centre of the first voxel and step along i (column), j (row) and k (slice).
    direction : ndarray, shape (3, 3)
        Columns are the unit vectors of i, j and k; k is not at a right angle after gantry tilt.
    order : list of int
        Indices of the given planes from the first slice to the last.
    notes : list of str
        Deviations that are allowed but worth knowing.
    uneven : ndarray, shape (planes, 3), or None
        Positions in their order, where the planes have to be resampled to become this grid.
    """

    origin: NDArray[np.float64]
    spacing: NDArray[np.float64]
    direction: NDArray[np.float64]
    order: list[int]
    notes: list[str]
    uneven: NDArray[np.float64] | None = None


def judge_stack(planes: Sequence[Plane], label: str, *, resample: bool = False) -> StackGeometry:
    """Sort planes along their normal and find the one regular grid they lie on.

    Parameters
    ----------
    planes : sequence of Plane
        Two or more planes, in any order.
    label : str
        How to name the stack in an error, such as "series 4 (CT)".
    resample : bool, optional
        Whether uneven planes are allowed, because they will be resampled.

    Returns
    -------
    StackGeometry
        The grid. Its slice step is the mean one, so the first and last slice are exact.

    Raises
    ------
    VolumeReadError
        If orientations are mixed, or positions are shared, uneven or not along a line.
    """
    rows, columns = plane_axes(planes, label)
    spacing = _pixel_spacing(planes, label)
    normal = np.cross(columns, rows)
    positions = np.array([plane.position for plane in planes], dtype=np.float64)
    order = np.argsort(positions @ normal, kind="stable")
    positions = positions[order]
    _check_distinct(positions @ normal, label)
    noted: list[str] = []
    uneven = None
    try:
        _check_even(positions @ normal, label)
        noted = _deviation_notes(positions, normal, min(spacing), label)
    except VolumeReadError:
        if not resample:
            raise
        uneven = positions
    mean_step = (positions[-1] - positions[0]) / (len(positions) - 1)
    step = float(np.linalg.norm(mean_step))
    return StackGeometry(
        origin=positions[0],
        spacing=np.array([spacing[1], spacing[0], step]),
        direction=np.column_stack([columns, rows, mean_step / step]),
        order=[int(index) for index in order],
        notes=noted,
        uneven=uneven,
    )


def heights_of(planes: Sequence[Plane]) -> NDArray[np.float64]:
    """Return the position of each plane along the normal of the first, in mm."""
    columns, rows = np.reshape(planes[0].orientation, (2, 3))
    positions = np.array([plane.position for plane in planes], dtype=np.float64)
    return positions @ np.cross(columns, rows)


def plane_axes(
    planes: Sequence[Plane], label: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the unit vectors of growing row index and of growing column index.

    Raises
    ------
    VolumeReadError
        If the planes have different orientations, or an orientation is none.
    """
    orientations = np.array([plane.orientation for plane in planes], dtype=np.float64)
    if not np.allclose(orientations, orientations[0], rtol=0.0, atol=ORIENTATION_TOLERANCE):
        raise VolumeReadError(_mixed_orientations(orientations, label))
    columns, rows = orientations[0, :3], orientations[0, 3:]
    lengths = np.linalg.norm(columns), np.linalg.norm(rows)
    if min(lengths) < 0.5 or abs(columns @ rows) > ORIENTATION_TOLERANCE:
        raise VolumeReadError(
            f"{label}: the image orientation is not two perpendicular directions, so the volume "
            "has no place in space; export the series again."
        )
    return rows / lengths[1], columns / lengths[0]


def _mixed_orientations(orientations: NDArray[np.float64], label: str) -> str:
    normals = np.cross(orientations[:, :3], orientations[:, 3:])
    names = ("sagittal", "coronal", "axial")
    counts = Counter(names[int(np.abs(normal).argmax())] for normal in normals)
    found = ", ".join(f"{count} {name}" for name, count in counts.items())
    return (
        f"{label}: the slices have different orientations ({found}), which is no single volume "
        "but may be a localiser; choose another series with series=..., or give "
        "ignore='orientations' to keep the most frequent one."
    )


def _pixel_spacing(planes: Sequence[Plane], label: str) -> NDArray[np.float64]:
    spacings = np.array([plane.pixel_spacing for plane in planes], dtype=np.float64)
    if not np.allclose(spacings, spacings[0], rtol=1e-4, atol=0.0):
        raise VolumeReadError(
            f"{label}: the pixel spacing differs between the slices, but one volume needs the "
            "same spacing in each; give ignore='sizes' to keep the most frequent one, or export "
            "the slices of one reconstruction."
        )
    return spacings[0]


def _check_distinct(heights: NDArray[np.float64], label: str) -> None:
    same = np.flatnonzero(np.diff(heights) <= SAME_POSITION_MM)
    if not len(same):
        return
    first = heights[same[0]]
    count = int(np.sum(np.abs(heights - first) <= SAME_POSITION_MM))
    place = int(np.sum(np.diff(heights[: same[0] + 1]) > SAME_POSITION_MM)) + 1
    distinct = int(np.sum(np.diff(heights) > SAME_POSITION_MM)) + 1
    raise VolumeReadError(
        f"{label}: {count} slices lie at one position (slice {place} of {distinct}, "
        f"{first:.2f} mm), but a volume has one slice at each; give ignore='duplicates' to keep "
        "the first of them."
    )


def _check_even(heights: NDArray[np.float64], label: str) -> None:
    steps = np.diff(heights)
    usual = float(np.median(steps))
    allowed = max(STEP_TOLERANCE * usual, STEP_TOLERANCE_MM)
    deviations = np.abs(steps - usual)
    if deviations.max() <= allowed:
        return
    worst = int(deviations.argmax())
    missing = round(steps[worst] / usual) - 1
    cause = f"{missing} missing slice{'s' * (missing > 1)}" if missing > 0 else "an uneven step"
    raise VolumeReadError(
        f"{label}: {cause} between slice {worst + 1} and slice {worst + 2} of {len(heights)}: the "
        f"step there is {steps[worst]:.3f} mm where {usual:.3f} mm is usual, and steps may differ "
        f"by {allowed:.3f} mm; give resample=True to interpolate at even steps, or export the "
        "complete series again."
    )


def _deviation_notes(
    positions: NDArray[np.float64], normal: NDArray[np.float64], pixel: float, label: str
) -> list[str]:
    """Refuse planes more than half a voxel off the even straight line, and note smaller gaps."""
    steps = np.linspace(0.0, 1.0, len(positions))[:, None]
    off = positions - (positions[0] + steps * (positions[-1] - positions[0]))
    along = off @ normal
    sideways = np.linalg.norm(off - along[:, None] * normal, axis=1)
    half_step = float((positions[-1] - positions[0]) @ normal) / (len(positions) - 1) / 2
    if sideways.max() > pixel / 2 or np.abs(along).max() > half_step:
        worst = int(np.argmax(np.maximum(sideways / pixel, np.abs(along) / (2 * half_step))))
        raise VolumeReadError(
            f"{label}: the slices do not lie on one straight line with an even step: slice "
            f"{worst + 1} of {len(positions)} is {np.linalg.norm(off[worst]):.3f} mm off, and half "
            "a voxel is allowed; give resample=True to interpolate at even steps, or export the "
            "original series."
        )
    largest = float(np.linalg.norm(off, axis=1).max())
    if largest <= STEP_TOLERANCE_MM:
        return []
    return [f"slices lie up to {largest:.3f} mm off the even step of {2 * half_step:.4f} mm"]
