"""Cuts and surfaces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Matrix, Vector


class Clip(NamedTuple):
    """Planes and balls that bound what is kept: their intersection."""

    planes: NDArray[np.float32]  # (n, 4) a, b, c, e: a i + b j + c k + e is the height, world units
    normals: NDArray[np.float32]  # (n, 3) world, toward what is kept
    spheres: NDArray[np.float32]  # (m, 4) centre in index coordinates, radius in world units
    world_from_index: Matrix  # directions
    depth: np.float32  # world units behind a cut face within which a collision is on it


class Holes(NamedTuple):
    """Boxes and balls that are cut out."""

    planes: NDArray[np.float32]  # (6 n, 4) six faces a box; heights are positive inside
    normals: NDArray[np.float32]  # (6 n, 3) world, into the box
    spheres: NDArray[np.float32]  # (m, 4)
    world_from_index: Matrix
    depth: np.float32


class Regions(NamedTuple):
    """Cropping regions, where the kept ones are not just the middle one."""

    lower: Vector  # index coordinates
    upper: Vector
    flags: np.int32  # bit x + 3 y + 9 z: kept
    normals: Matrix  # world normals of the index axes, upward
    pitch: Vector  # world distance between index planes along each axis
    depth: np.float32


class Mesh(NamedTuple):
    """Opaque triangles in a bounding volume hierarchy, see `kernels.bvh`."""

    bounds: NDArray[np.float32]  # (nodes, 6) lower and upper corner
    first: NDArray[np.int32]  # (nodes,) first child, or first triangle of a leaf
    count: NDArray[np.int32]  # type: ignore[assignment]  # (nodes,) triangles of a leaf, else 0
    axis: NDArray[np.int32]  # (nodes,) along which the children are ordered
    parent: NDArray[np.int32]  # (nodes,) -1 for the root
    triangles: NDArray[np.float32]  # (m, 9) three corners
    normals: NDArray[np.float32]  # (m, 9) at the corners, or (0, 9): flat
    owner: NDArray[np.int32]  # (m,) index of the receiver


class Receivers(NamedTuple):
    """Opaque surfaces: shapes first, then meshes."""

    kind: NDArray[np.int32]  # (n,) of shapes: 0 plane, 1 box, 2 sphere
    local_from_world: NDArray[np.float32]  # (n, 3, 4) into the frame of the unit shape
    colour: NDArray[np.float32]  # (shapes and meshes, 3)
    specular: NDArray[np.float32]  # (shapes and meshes, 3)
    exponent: NDArray[np.float32]  # (shapes and meshes,)
    reach: np.float32  # extent of the finite ones around the volume's centre, world units
