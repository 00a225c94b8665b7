"""Which parts of a volume are left out: clip shapes, and VTK's cropping regions.

A cut sets the extinction to zero, for camera rays and for shadow rays alike: light falls in through
an opened side.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import checks

Vector = tuple[float, float, float]

# Region flags of vtkVolumeMapper: bit x + 3 y + 9 z, each 0 (below), 1 (between) or 2 (above)
SUBVOLUME = 0x2000
FENCE = 0x2EBFEBA
CROSS = 0x417410
ALL_REGIONS = 2**27 - 1


def _keep(value: object) -> None:
    if value not in ("inside", "outside"):
        raise ValueError(f"keep is inside or outside, got {value!r}")


def rotation(name: str, value: object) -> NDArray[np.float64]:
    """Return a 3x3 matrix of orthonormal columns, or say what is wrong with it."""
    m = np.asarray(value, np.float64)
    if m.shape != (3, 3) or not np.allclose(m.T @ m, np.eye(3), atol=1e-6):
        raise ValueError(f"{name} must be a 3x3 matrix of orthonormal columns, got {value!r}")
    return m


@dataclass(frozen=True)
class Plane:
    """Half-space: what lies on the side to which the normal points is kept, as VTK does.

    Parameters
    ----------
    origin : 3 floats
        Point of the plane, world coordinates.
    normal : 3 floats
    """

    origin: Vector
    normal: Vector

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin", checks.vector("plane.origin", self.origin))
        object.__setattr__(self, "normal", checks.direction("plane.normal", self.normal))


@dataclass(frozen=True)
class Sphere:
    """Ball that is kept, or cut out.

    Parameters
    ----------
    centre : 3 floats
        World coordinates.
    radius : float
        World units, > 0.
    keep : {"inside", "outside"}
    """

    centre: Vector
    radius: float
    keep: str = "inside"

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", checks.vector("sphere.centre", self.centre))
        checks.number("sphere.radius", self.radius, above=0.0)
        _keep(self.keep)


@dataclass(frozen=True, eq=False)
class Box:
    """Box that is kept, or cut out.

    Parameters
    ----------
    centre : 3 floats
        World coordinates.
    size : 3 floats
        Edge lengths along the axes, world units, > 0.
    axes : array (3, 3)
        Columns are the box's axes, orthonormal.
    keep : {"inside", "outside"}
    """

    centre: Vector
    size: Vector
    axes: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    keep: str = "inside"

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", checks.vector("box.centre", self.centre))
        size = checks.vector("box.size", self.size)
        for edge in size:
            checks.number("box.size", edge, above=0.0)
        object.__setattr__(self, "size", size)
        object.__setattr__(self, "axes", rotation("box.axes", self.axes))
        _keep(self.keep)

    @classmethod
    def from_bounds(cls, bounds: tuple[float, ...], keep: str = "inside") -> Box:
        """Box of bounds (x0, x1, y0, y1, z0, z1), world coordinates."""
        b = np.asarray(bounds, np.float64)
        if b.shape != (6,):
            raise ValueError(f"bounds are (x0, x1, y0, y1, z0, z1), got {bounds!r}")
        low, high = b[::2], b[1::2]
        return cls(tuple(((low + high) / 2).tolist()), tuple((high - low).tolist()), keep=keep)


Shape = Plane | Sphere | Box


@dataclass(frozen=True)
class Cropping:
    """Cropping regions of vtkVolumeMapper: two planes along each index axis make 27 regions.

    Parameters
    ----------
    lower, upper : 3 floats
        Where the planes are along (i, j, k), in index coordinates: regions follow the volume's own
        axes, however it is turned. lower <= upper.
    flags : int
        Regions to keep, 27 bits: region x + 3 y + 9 z, where x, y and z are 0 below the lower
        plane, 1 between, 2 above the upper one. `SUBVOLUME`, `FENCE`, `CROSS` as in VTK.
    """

    lower: Vector
    upper: Vector
    flags: int = SUBVOLUME

    def __post_init__(self) -> None:
        lower = checks.vector("cropping.lower", self.lower)
        upper = checks.vector("cropping.upper", self.upper)
        if any(a > b for a, b in zip(lower, upper, strict=True)):
            raise ValueError(f"cropping.lower must not be above upper, got {lower} and {upper}")
        if checks.whole("cropping.flags", self.flags, least=0) > ALL_REGIONS:
            raise ValueError(f"cropping.flags has 27 bits, got {self.flags:#x}")
        object.__setattr__(self, "lower", lower)
        object.__setattr__(self, "upper", upper)

    @property
    def kept(self) -> NDArray[np.bool_]:
        """Whether each region is kept, [z, y, x]."""
        bits = (self.flags >> np.arange(27)) & 1
        return bits.astype(bool).reshape(3, 3, 3)


def shapes(value: object) -> tuple[Shape, ...]:
    """Return a tuple of clip shapes; one shape stands for itself."""
    found = (value,) if isinstance(value, Shape) else tuple(value)  # type: ignore[arg-type]
    for shape in found:
        if not isinstance(shape, Shape):
            raise TypeError(f"clip takes Plane, Sphere and Box, got {type(shape).__name__}")
    return found
