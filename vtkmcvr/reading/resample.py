"""Bring slices at uneven positions, and sheared volumes, onto a box with even steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .volume import LoadedVolume

RIGHT_ANGLE = 1e-4


def resample_slices(
    values: NDArray[Any], positions: NDArray[np.float64], axes: NDArray[np.float64],
    spacing: NDArray[np.float64],
) -> tuple[NDArray[Any], NDArray[np.float64]]:  # fmt: skip
    """Interpolate slices linearly between their true positions.

    Parameters
    ----------
    values : ndarray, shape (slices, rows, columns) or (slices, rows, columns, components)
        Slices in the order of their positions.
    positions : ndarray, shape (slices, 3)
        Centre of the first pixel of each slice, in mm.
    axes : ndarray, shape (3, 3)
        Columns: unit vectors of growing column index, growing row index, and the normal.
    spacing : ndarray, shape (2,)
        Between columns and between rows, in mm.

    Returns
    -------
    resampled : ndarray
        Slices with the median step between them, of the type of `values`.
    ends : ndarray, shape (2, 3)
        Position of the first and of the last of them.
    """
    place = positions @ axes
    heights = place[:, 2]
    step = float(np.median(np.diff(heights)))
    count = round((heights[-1] - heights[0]) / step) + 1
    wanted = np.linspace(place[0], place[-1], max(count, 2))
    result = np.empty((len(wanted), *values.shape[1:]), values.dtype)
    for k, target in enumerate(wanted):
        above = int(np.clip(np.searchsorted(heights, target[2]), 1, len(heights) - 1))
        weight = (target[2] - heights[above - 1]) / (heights[above] - heights[above - 1])
        parts = [
            _shifted(values[index], (place[index, :2] - target[:2]) / spacing)
            for index in (above - 1, above)
        ]
        blend = parts[0] + np.float32(weight) * (parts[1] - parts[0])
        result[k] = np.rint(blend) if values.dtype.kind in "iu" else blend
    return result, positions[0] + np.array([[0.0], [1.0]]) * (positions[-1] - positions[0])


def _shifted(plane: NDArray[Any], columns_rows: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return the slice moved by part of a pixel; its border pixels go on outside."""
    moved = plane.astype(np.float32)
    for axis, shift in ((1, columns_rows[0]), (0, columns_rows[1])):
        if abs(shift) > 1e-6:
            at = np.clip(np.arange(plane.shape[axis]) - shift, 0, plane.shape[axis] - 1)
            low = np.floor(at).astype(int)
            high = np.minimum(low + 1, plane.shape[axis] - 1)
            shape = [1] * moved.ndim
            shape[axis] = -1
            part = (at - low).astype(np.float32).reshape(shape)
            moved = moved.take(low, axis) * (1 - part) + moved.take(high, axis) * part
    return moved


def is_sheared(direction: NDArray[np.float64]) -> bool:
    """Say whether the columns of `direction` are not at right angles."""
    return bool(np.abs(direction.T @ direction - np.eye(3)).max() > RIGHT_ANGLE)


def to_box(volume: LoadedVolume) -> LoadedVolume:
    """Resample a sheared volume linearly onto the box around it; outside is its lowest value."""
    import SimpleITK

    from .itk import image_from_volume

    axes = _right_angled(volume.direction)
    corners = np.array(np.meshgrid(*[(0, n - 1) for n in volume.values.shape[2::-1]]))
    world = corners.reshape(3, -1).T * volume.spacing @ volume.direction.T + volume.origin
    inside = world @ axes
    low, high = inside.min(axis=0), inside.max(axis=0)
    spacing = volume.spacing * np.abs(np.sum(axes * volume.direction, axis=0))
    size = [int(n) for n in np.ceil((high - low) / spacing - 1e-6) + 1]
    filter_ = SimpleITK.ResampleImageFilter()
    filter_.SetSize(size)
    filter_.SetOutputSpacing([float(x) for x in spacing])
    filter_.SetOutputOrigin([float(x) for x in axes @ low])
    filter_.SetOutputDirection([float(x) for x in axes.ravel()])
    filter_.SetInterpolator(SimpleITK.sitkLinear)
    filter_.SetDefaultPixelValue(_lowest(volume.values))
    kind = volume.values.dtype
    if kind.kind in "iu":
        # ITK would cut off the fractions of interpolated whole numbers.
        volume.values = volume.values.astype(np.float32 if kind.itemsize < 4 else np.float64)
    moved = SimpleITK.GetArrayFromImage(filter_.Execute(image_from_volume(volume)))
    volume.values = np.rint(moved).astype(kind) if kind.kind in "iu" else moved
    volume.spacing, volume.origin, volume.direction = spacing, axes @ low, axes
    volume.notes.append("sheared, resampled to a box")
    return volume


def _lowest(values: NDArray[Any]) -> float:
    finite = values[np.isfinite(values)] if values.dtype.kind == "f" else values
    return float(finite.min()) if finite.size else 0.0


def _right_angled(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Keep i, turn j in its plane with i, and k onto their normal, on the side it is on."""
    i = direction[:, 0]
    j = direction[:, 1] - (direction[:, 1] @ i) * i
    j = j / np.linalg.norm(j)
    k = np.cross(i, j)
    return np.column_stack([i, j, k * np.sign(k @ direction[:, 2])])
