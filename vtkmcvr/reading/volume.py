"""A volume between its file and its image, and what makes it one regular 3-D volume."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..recorded_facts import Segment
from ..volume_info import count_nonfinite
from .errors import fail

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

SHEAR_TOLERANCE_DEGREES = 0.1


@dataclass
class LoadedVolume:
    """Voxels and their place in the world, before they become an image.

    Attributes
    ----------
    values : ndarray
        Voxels, shape (k, j, i) or (k, j, i, components).
    spacing, origin : ndarray, shape (3,)
        Step along each index axis and centre of voxel (0, 0, 0), in mm.
    direction : ndarray, shape (3, 3)
        Columns are the unit vectors of the index axes in the LPS world.
    notes : list of str
        What the reader noticed.
    modality, units : str
        DICOM modality and unit of the values, empty where unknown.
    segments : list of Segment
        What the values of a label map mean; empty for other volumes.
    """

    values: NDArray[Any]
    spacing: NDArray[np.float64]
    origin: NDArray[np.float64]
    direction: NDArray[np.float64]
    notes: list[str] = field(default_factory=list)
    modality: str = ""
    units: str = ""
    segments: list[Segment] = field(default_factory=list)


def check_dimension(source: Path, size: Sequence[int]) -> None:
    """Refuse an image that is flat along an axis; `size` runs from i on.

    Raises
    ------
    VolumeReadError
        If it has fewer than 3 axes, or fewer than 2 voxels along one.
    """
    if len(size) < 3 or min(size[:3]) < 2:
        fail(source, _too_flat(size[:3]))


def _too_flat(size: Sequence[int]) -> str:
    shape = " x ".join(str(n) for n in size)
    return f"a 2-D image ({shape}) is not a volume; give one with 2 or more voxels along each axis"


def check_geometry(source: Path, volume: LoadedVolume) -> None:
    """Refuse a place in the world that is no place.

    Raises
    ------
    VolumeReadError
        If a number is not finite, a spacing not above 0 or the direction singular.
    """
    numbers = (volume.spacing, volume.origin, volume.direction)
    if not all(np.isfinite(part).all() for part in numbers):
        fail(source, "origin, spacing or direction is not a finite number; export the file again")
    if volume.spacing.min() <= 0.0:
        fail(source, "the voxel spacing must be above 0 along each axis; export the file again")
    if abs(np.linalg.det(volume.direction)) < 1e-6:
        fail(source, "the direction matrix is singular (two axes coincide); export the file again")


def volume_notes(volume: LoadedVolume) -> list[str]:
    """Note odd axes and values that are not finite."""
    return _direction_notes(volume.direction) + _nonfinite_notes(volume.values)


def _direction_notes(direction: NDArray[np.float64]) -> list[str]:
    noted = []
    if not np.allclose(direction, np.eye(3), atol=1e-6):
        noted.append("direction is not the identity: the axes are turned or flipped against LPS")
    if np.linalg.det(direction) < 0.0:
        noted.append("the index axes are left-handed")
    cosines = np.abs(direction.T @ direction - np.eye(3)).max()
    shear = float(np.degrees(np.arcsin(min(cosines, 1.0))))
    if shear > SHEAR_TOLERANCE_DEGREES:
        noted.append(f"sheared by {shear:.1f} degrees (gantry tilt), kept in the direction matrix")
    return noted


def _nonfinite_notes(values: NDArray[Any]) -> list[str]:
    nan, infinite = count_nonfinite(values)
    counts = ((nan, "NaN"), (infinite, "infinite"))
    return [f"{name} values: {count}" for count, name in counts if count]
