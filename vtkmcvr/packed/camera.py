"""Cameras, lenses and the points of a pixel."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Matrix64, Vector, Vector64


class Panorama(NamedTuple):
    """The camera's directions are (longitude, latitude, unused) in this frame, in radians."""

    right: Vector64
    up: Vector64
    forward: Vector64


class SideBySide(NamedTuple):
    """The camera is the left eye's; the right eye's film lies on its right."""

    columns: np.int64  # of one eye
    origin: Vector64  # to be added for the right eye
    direction: Vector64


class Camera(NamedTuple):
    """Affine map from film to rays.

    At film position (x, y) in pixels, row 0 on top, the ray starts at
    origin + x origin_x + y origin_y and heads along direction + x direction_x + y direction_y
    (not normalised).
    """

    origin: Vector64
    origin_x: Vector64
    origin_y: Vector64
    direction: Vector64
    direction_x: Vector64
    direction_y: Vector64
    index_from_world: Matrix64
    index_of_centre: Vector64  # index position of the volume's centre
    filter: NDArray[np.float32]  # inverse distribution of the pixel filter, offsets in pixels
    panorama: Panorama | None
    side_by_side: SideBySide | None


class Lens(NamedTuple):
    """Thin lens: points of the focal plane are sharp."""

    radius: np.float32
    focus_distance: np.float32  # along the axis, to the focal plane
    right: Vector
    up: Vector
    axis: Vector
    corners: NDArray[np.float32] | None  # (n + 1, 2) of a polygonal aperture of radius 1; closed


class Sobol(NamedTuple):
    """Leading dimensions of a path are scrambled Sobol points instead of independent numbers."""

    key: np.uint64  # of a batch, plus an increment for each set of points drawn; 0 in the scene
    place: np.uint64  # of a sample in its batch; 0 in the scene
    sets: np.int64  # sets of points, in one or two dimensions, still to be drawn by a path
