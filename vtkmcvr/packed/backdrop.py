"""What another renderer draws around the volumes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Vector64


class Backdrop(NamedTuple):
    """Opaque things that another renderer draws: camera rays end there."""

    depth: NDArray[np.float32]  # (places, H, W) along the view axis
    colour: NDArray[np.uint8]  # (places, H, W, 4) as displayed
    offsets: NDArray[np.float64]  # (places, 2) position in the pixel
    axis: Vector64
    veils: Veils | None


class Veils(NamedTuple):
    """Translucent surfaces before a backdrop, nearest first."""

    first: NDArray[np.int64]  # (places H W + 1,) of each place, row and column
    depth: NDArray[np.float32]  # (n,) along the view axis
    colour: NDArray[np.uint8]  # (n, 4) as displayed, straight alpha


class Openings(NamedTuple):
    """Edges of a backdrop in each pixel, nearest first: what is behind is covered in part."""

    first: NDArray[np.int64]  # (rows columns + 1,)
    depth: NDArray[np.float32]  # (n,) along the view axis
    left: NDArray[np.float32]  # (n,) share of the pixel that is open behind it
    through: NDArray[np.float32]  # (n,) transmittance of the volume up to it, written by kernels
    next: NDArray[np.int64]  # (rows, columns) first edge that rays have not passed yet
    axis: Vector64
