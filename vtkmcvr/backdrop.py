"""Opaque things that another renderer draws around the volume: where rays end, what they show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Backdrop:
    """Depth and colour of what stands around the volume, at one or more places of every pixel.

    A camera ray ends where the backdrop is; what lies nearer covers it. Depth is looked up at the
    place nearest to the ray's own, so that a few places, spread evenly, make smooth edges.

    Parameters
    ----------
    depth : array (places, H, W)
        Distance along the view axis from the camera's plane, world units; inf: nothing there.
    colour : array (places, H, W, 4)
        What is seen there: bytes, straight alpha, as displayed. The film keeps the mean over the
        rays that meet nothing before.
    offsets : array (places, 2)
        Positions (x, y) in the pixel, from its upper left corner, 0 to 1.
    """

    depth: NDArray[np.float32]
    colour: NDArray[np.uint8]
    offsets: NDArray[np.float64]

    def __post_init__(self) -> None:
        depth = np.ascontiguousarray(self.depth, np.float32)
        colour = np.ascontiguousarray(self.colour)
        offsets = np.ascontiguousarray(self.offsets, np.float64)
        if depth.ndim != 3 or not depth.size:
            raise ValueError(f"backdrop.depth has shape (places, H, W), got {depth.shape}")
        if colour.shape != (*depth.shape, 4) or colour.dtype != np.uint8:
            raise ValueError(
                f"backdrop.colour must be bytes of shape {(*depth.shape, 4)}, got "
                f"{colour.dtype} of shape {colour.shape}"
            )
        if offsets.shape != (len(depth), 2) or not ((offsets >= 0) & (offsets <= 1)).all():
            raise ValueError(
                f"backdrop.offsets are {len(depth)} positions from 0 to 1, got {self.offsets!r}"
            )
        if np.isnan(depth).any() or (depth < 0).any():
            raise ValueError("backdrop.depth must be distances >= 0, inf where nothing is")
        for name, value in (("depth", depth), ("colour", colour), ("offsets", offsets)):
            object.__setattr__(self, name, value)


def check_backdrop(backdrop: object, size: tuple[int, int]) -> None:
    """Raise unless `backdrop` is None or a Backdrop of a film of this size."""
    if backdrop is None:
        return
    if not isinstance(backdrop, Backdrop):
        raise TypeError(f"backdrop takes a Backdrop, got {type(backdrop).__name__}")
    _, height, width = backdrop.depth.shape
    if (width, height) != tuple(size):
        raise ValueError(
            f"the backdrop is of {width} x {height} pixels, the film of {size[0]} x {size[1]}"
        )
