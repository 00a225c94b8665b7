"""A scalar field on a regular grid, anywhere in the world."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import checks

Vector = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Volume:
    """Scalars on a regular grid.

    Parameters
    ----------
    values : array (k, j, i)
        One real scalar per point, at least two points along each axis. NaN and infinite values are
        "no data": transparent.
    index_to_world : array (4, 4), optional
        Affine map from index coordinates (i, j, k) to world: origin, spacing, direction, user
        matrix.
    colours : array (k, j, i, 3), optional
        Colour of every point, instead of the transfer function's: linear RGB from 0 to 1, or bytes
        that stand for 1/255 each. Linear between points.
    """

    values: NDArray
    index_to_world: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    colours: NDArray | None = None

    def __post_init__(self) -> None:
        values = np.asarray(self.values)
        if values.ndim != 3:
            raise ValueError(
                f"a volume has one scalar per point, shape (k, j, i); got shape {values.shape}"
            )
        if min(values.shape) < 2:
            raise ValueError(
                "a volume needs at least two points along each axis; this is a 2-D image or a "
                f"single slice of {' x '.join(map(str, values.shape[::-1]))} points"
            )
        if values.dtype.kind not in "iufb":
            raise ValueError(f"a volume holds real numbers, got type {values.dtype}")
        object.__setattr__(self, "values", values)
        matrix = checks.affine("volume.index_to_world", self.index_to_world)
        object.__setattr__(self, "index_to_world", matrix)
        if self.colours is not None:
            object.__setattr__(self, "colours", _colours(self.colours, values.shape))

    @classmethod
    def from_grid(
        cls,
        values: NDArray,
        spacing: Vector = (1.0, 1.0, 1.0),
        origin: Vector = (0.0, 0.0, 0.0),
        direction: NDArray | None = None,
    ) -> Volume:
        """Volume of an array (k, j, i), with spacing and origin in world units.

        `direction` is a 3x3 matrix whose columns are the index axes in world coordinates.
        """
        matrix = np.eye(4)
        axes = np.eye(3) if direction is None else np.asarray(direction, np.float64)
        matrix[:3, :3] = axes * np.asarray(checks.vector("spacing", spacing))
        matrix[:3, 3] = checks.vector("origin", origin)
        return cls(values, matrix)

    def flipped(self, axes: str) -> Volume:
        """The volume with some of its index axes ("i", "j", "k") running backwards in the world.

        For files that do not say which way they were stored: "k" turns a head that stands on its
        crown, left and right staying as they are.
        """
        if not axes or set(axes) - set("ijk") or len(set(axes)) < len(axes):
            raise ValueError(f"flip takes axes out of i, j, k, such as k or ij; got {axes!r}")
        matrix = self.index_to_world.copy()
        for axis in ("ijk".index(letter) for letter in axes):
            matrix[:3, 3] += matrix[:3, axis] * (self.shape[axis] - 1)
            matrix[:3, axis] *= -1
        return Volume(self.values, matrix, self.colours)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of points along (i, j, k)."""
        k, j, i = self.values.shape
        return i, j, k

    @property
    def centre(self) -> NDArray[np.float64]:
        """World position of the middle of the grid."""
        middle = (np.array(self.shape) - 1) / 2
        return self.index_to_world[:3, :3] @ middle + self.index_to_world[:3, 3]

    @property
    def spacing(self) -> NDArray[np.float64]:
        """Distance between neighbouring points along (i, j, k), in world units."""
        return np.linalg.norm(self.index_to_world[:3, :3], axis=0)

    @property
    def corners(self) -> NDArray[np.float64]:
        """The eight outer points, (8, 3), in world coordinates."""
        far = np.array(self.shape) - 1
        index = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * far
        return index @ self.index_to_world[:3, :3].T + self.index_to_world[:3, 3]

    @property
    def radius(self) -> float:
        """Radius of the sphere around the corners, in world units."""
        return float(np.linalg.norm(self.corners - self.centre, axis=1).max())


def _colours(colours: NDArray, shape: tuple[int, ...]) -> NDArray:
    """Colours of a grid of that shape: bytes as they are, else float32 from 0 to 1."""
    colours = np.asarray(colours)
    if colours.shape != (*shape, 3):
        raise ValueError(f"colours have shape {(*shape, 3)}, got {colours.shape}")
    if colours.dtype == np.uint8:
        return colours
    colours = colours.astype(np.float32)
    if not (colours.min() >= 0 and colours.max() <= 1):
        raise ValueError(
            f"colours go from 0 to 1 (or are bytes), got {colours.min():g} to {colours.max():g}"
        )
    return colours
