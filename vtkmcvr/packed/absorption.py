"""Emission and absorption along a ray."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Matrix, Matrix64, Vector64
from .layers import Integrals
from .volume import Medium, Transfer


class Phong(NamedTuple):
    """Light of a lamp at the eye, from the gradient alone, as VTK shades volumes."""

    ambient: np.float32
    diffuse: np.float32
    specular: np.float32
    power: np.float32


class Absorber(NamedTuple):
    """One volume of a picture by emission and absorption."""

    medium: Medium
    transfer: Transfer
    integrals: Integrals
    phong: Phong | None
    world_from_index_gradient: Matrix | None  # where gradients are looked up
    index_from_world: Matrix64  # directions
    index_of_centre: Vector64  # index position, in this volume, of the first volume's centre


class March(NamedTuple):
    """How rays are cut into steps."""

    per_voxel: np.float64  # steps while a ray moves by one along an index axis; 0: see `per_length`
    per_length: np.float64  # steps per world unit, else 0
    opaque: np.float32  # transmittance at which a ray ends
    skip: np.bool_  # leap over empty space
    rays: np.int64  # n of the n x n rays of a pixel


class RayFilm(NamedTuple):
    """Means over the rays of a pixel, [row, column]; colours and depth times opacity."""

    radiance: NDArray[np.float32]  # (H, W, 3)
    alpha: NDArray[np.float32]
    depth: NDArray[np.float32]  # distance from the eye
    albedo: NDArray[np.float32] | None  # (H, W, 3)
    normal: NDArray[np.float32] | None  # (H, W, 3) world normals toward the eye
