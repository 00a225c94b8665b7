"""What another renderer draws around the volume: where rays end, what they show on their way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Veils:
    """Translucent surfaces before a backdrop, at its places of every pixel, nearest first.

    Each covers what lies behind it by its opacity, and scatters no ray.

    Parameters
    ----------
    first : array (places H W + 1,)
        Where the surfaces of place p, row i and column j begin: entry (p H + i) W + j. The last
        entry is the number of surfaces.
    depth : array (n,)
        Distance along the view axis, world units, nearer than the backdrop's own.
    colour : array (n, 4)
        Bytes, straight alpha, as displayed.
    """

    first: NDArray[np.int64]
    depth: NDArray[np.float32]
    colour: NDArray[np.uint8]

    def __post_init__(self) -> None:
        first = np.ascontiguousarray(self.first, np.int64)
        depth = np.ascontiguousarray(self.depth, np.float32)
        colour = np.ascontiguousarray(self.colour)
        if first.ndim != 1 or not len(first) or first[0] != 0 or (np.diff(first) < 0).any():
            raise ValueError("veils.first counts up from 0, one entry per place and pixel, and one")
        if depth.shape != (first[-1],) or colour.shape != (first[-1], 4):
            raise ValueError(
                f"veils are {first[-1]} depths and as many colours of 4 bytes, got shapes "
                f"{depth.shape} and {colour.shape}"
            )
        if colour.dtype != np.uint8 or not (depth >= 0).all():
            raise ValueError("veils have colours of bytes and depths >= 0")
        later = np.diff(depth, prepend=0) < 0
        later[first[:-1][first[:-1] < len(depth)]] = False
        if later.any():
            raise ValueError("the veils of a place come nearest first")
        for name, value in (("first", first), ("depth", depth), ("colour", colour)):
            object.__setattr__(self, name, value)

    @classmethod
    def of_layers(cls, depth: NDArray[np.float32], colour: NDArray[np.uint8]) -> Veils:
        """Veils of layers over all places, (layers, places, H, W) and (..., 4), nearest first.

        A depth of inf: nothing there.
        """
        depth, colour = np.moveaxis(depth, 0, -1), np.moveaxis(colour, 0, -2)
        there = np.isfinite(depth)
        first = np.concatenate([[0], np.cumsum(there.sum(axis=-1))])
        return cls(first, depth[there], colour[there])

    @classmethod
    def joined(cls, parts: Sequence[Veils]) -> Veils | None:
        """Veils of the places of several backdrops, one after another; None of none."""
        if not parts:
            return None
        first = [
            part.first[1:] + before for part, before in zip(parts, _starts(parts), strict=True)
        ]
        return cls(
            np.concatenate([[0], *first]),
            np.concatenate([part.depth for part in parts]),
            np.concatenate([part.colour for part in parts]),
        )

    @property
    def counts(self) -> NDArray[np.int64]:
        """Number of surfaces of each place and pixel, (places H W,)."""
        return np.diff(self.first)

    def at(self, where: NDArray[np.int64]) -> Veils:
        """Veils of some of the places and pixels, by their entries in `first`."""
        counts = self.counts[where]
        first = np.concatenate([[0], np.cumsum(counts)])
        entries = np.repeat(self.first[where] - first[:-1], counts) + np.arange(first[-1])
        return Veils(first, self.depth[entries], self.colour[entries])


def _starts(parts: Sequence[Veils]) -> NDArray[np.int64]:
    """Number of veils before each part."""
    return np.cumsum([0, *(len(part.depth) for part in parts)])[:-1]


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
    veils : Veils, optional
        Translucent surfaces nearer than that.
    """

    depth: NDArray[np.float32]
    colour: NDArray[np.uint8]
    offsets: NDArray[np.float64]
    veils: Veils | None = None

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
        if self.veils is not None and len(self.veils.first) != depth.size + 1:
            raise ValueError(
                f"veils are given for {len(self.veils.first) - 1} places and pixels, the backdrop "
                f"has {depth.size}"
            )
        for name, value in (("depth", depth), ("colour", colour), ("offsets", offsets)):
            object.__setattr__(self, name, value)

    @property
    def veiled(self) -> NDArray[np.bool_] | None:
        """Pixels, (H, W), that any veil covers in part; None: there are no veils."""
        if self.veils is None:
            return None
        return np.any(self.veils.counts.reshape(self.depth.shape), axis=0)


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
