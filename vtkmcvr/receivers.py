"""Opaque surfaces that stand around a volume, receive its shadow and cast their own.

Both sides of a surface scatter light; none lets any through.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import checks
from .cutting import rotation

Vector = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class Receiver:
    """Base of all receivers: what the surface looks like.

    Parameters
    ----------
    colour : colour
        Diffuse reflectance, linear RGB, [0, 1].
    specular : colour
        Reflectance of a glossy coat at normal incidence, [0, 1]; 0: plain Lambert.
    exponent : float
        Blinn exponent of the coat, >= 0.
    """

    colour: Vector | float = 0.5
    specular: Vector | float = 0.0
    exponent: float = 30.0

    def __post_init__(self) -> None:
        for name in ("colour", "specular"):
            rgb = checks.colour(f"receiver.{name}", getattr(self, name))
            if max(rgb) > 1:
                raise ValueError(f"receiver.{name} goes from 0 to 1, got {rgb}")
            object.__setattr__(self, name, rgb)
        checks.number("receiver.exponent", self.exponent, least=0.0, most=1e6)


@dataclass(frozen=True)
class PlaneReceiver(Receiver):
    """Plane, or a rectangle of it.

    Parameters
    ----------
    centre : 3 floats
        World coordinates.
    normal : 3 floats
    size : (width, height), optional
        World units, > 0. None: the plane has no end.
    up : 3 floats
        Direction of the height, as far as the normal leaves it.
    """

    centre: Vector
    normal: Vector
    size: tuple[float, float] | None = None
    up: Vector = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "centre", checks.vector("plane.centre", self.centre))
        object.__setattr__(self, "normal", checks.direction("plane.normal", self.normal))
        checks.direction("plane.up", self.up)
        if self.size is not None:
            for name, value in zip(("width", "height"), self.size, strict=True):
                checks.number(f"plane {name}", value, above=0.0)

    @property
    def frame(self) -> NDArray[np.float64]:
        """Unit vectors as columns: along the width, along the height, normal."""
        normal = np.array(self.normal)
        up = np.array(checks.direction("up", self.up))
        if abs(normal @ up) > 1 - 1e-9:
            up = np.eye(3)[int(np.argmin(np.abs(normal)))]
        right = np.cross(up, normal)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(normal, right), normal], axis=1)


@dataclass(frozen=True, eq=False)
class BoxReceiver(Receiver):
    """Box.

    Parameters
    ----------
    centre : 3 floats
        World coordinates.
    size : 3 floats
        Edge lengths along the axes, world units, > 0.
    axes : array (3, 3)
        Columns are the box's axes, orthonormal.
    """

    centre: Vector
    size: Vector
    axes: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "centre", checks.vector("box.centre", self.centre))
        object.__setattr__(self, "size", checks.vector("box.size", self.size))
        for edge in self.size:
            checks.number("box.size", edge, above=0.0)
        object.__setattr__(self, "axes", rotation("box.axes", self.axes))


@dataclass(frozen=True)
class SphereReceiver(Receiver):
    """Sphere.

    Parameters
    ----------
    centre : 3 floats
        World coordinates.
    radius : float
        World units, > 0.
    """

    centre: Vector
    radius: float

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "centre", checks.vector("sphere.centre", self.centre))
        checks.number("sphere.radius", self.radius, above=0.0)


@dataclass(frozen=True, eq=False)
class MeshReceiver(Receiver):
    """Triangle mesh.

    Parameters
    ----------
    points : array (n, 3)
        World coordinates; kept in float64 until they are taken relative to the volume.
    triangles : array (m, 3)
        Indices of points. Triangles without area are left out.
    normals : array (n, 3), optional
        Normals at the points, of any length, which shading interpolates. None: flat triangles.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    normals: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        points = _rows("points", self.points, np.float64)
        triangles = np.asarray(self.triangles)
        if triangles.dtype.kind not in "iu":
            raise ValueError(f"mesh.triangles are indices, got type {triangles.dtype}")
        triangles = _rows("triangles", triangles, np.int64)
        if triangles.min() < 0 or triangles.max() >= len(points):
            raise ValueError(
                f"mesh.triangles index {len(points)} points, got {triangles.min()} to "
                f"{triangles.max()}"
            )
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "triangles", triangles)
        if self.normals is not None:
            normals = _rows("normals", self.normals, np.float64)
            if normals.shape != points.shape:
                raise ValueError(f"mesh has {len(points)} points and {len(normals)} normals")
            object.__setattr__(self, "normals", normals)


def _rows(name: str, value: object, dtype: type) -> NDArray:
    rows: NDArray = np.ascontiguousarray(value, dtype)
    if rows.ndim != 2 or rows.shape[1] != 3 or not len(rows):
        raise ValueError(f"mesh.{name} has shape (n, 3), got {rows.shape}")
    if not np.isfinite(rows).all():
        raise ValueError(f"mesh.{name} must be finite")
    return rows


def receivers(value: object) -> tuple[Receiver, ...]:
    """Return a tuple of receivers; one receiver stands for itself."""
    found = (value,) if isinstance(value, Receiver) else tuple(value)  # type: ignore[arg-type]
    for receiver in found:
        if not isinstance(receiver, Receiver) or type(receiver) is Receiver:
            raise TypeError(
                "receivers are PlaneReceiver, BoxReceiver, SphereReceiver and MeshReceiver, got "
                f"{type(receiver).__name__}"
            )
    return found
