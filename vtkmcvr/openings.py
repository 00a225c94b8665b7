"""How much of each pixel a backdrop leaves open, from the eye on: for rays that stand for a pixel.

Where a technique sends one ray through a pixel, the places of the backdrop are edges on its way,
each of which covers a share of all that lies behind. So silhouettes are smooth without more rays.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import packed
from .backdrop import Backdrop, Veils
from .pack import f32, vector64

# Share of a pixel that counts as none
CLOSED = 1e-6


@dataclass(frozen=True, eq=False)
class Openings:
    """Edges of a backdrop, pixel by pixel, nearest first.

    Attributes
    ----------
    packed : vtkmcvr.packed.Openings
        For kernels, which write what the volume lets through to each edge.
    colour : array (n, 4)
        What an edge shows: premultiplied, times the share of the pixel that it covers.
    size : (rows, columns)
        Of the pixels.
    fine : int
        How many of them make one of the film's side.
    """

    packed: packed.Openings
    colour: NDArray[np.float32]
    size: tuple[int, int]
    fine: int

    def behind(self) -> NDArray[np.float64]:
        """What the backdrop shows through the volume, (H, W, 4), premultiplied."""
        rows, columns = self.size
        pixel = np.repeat(np.arange(rows * columns), np.diff(self.packed.first))
        seen = self.colour * self.packed.through[:, None]
        total = [np.bincount(pixel, channel, rows * columns) for channel in seen.T]
        blocks = np.stack(total, axis=-1).reshape(
            rows // self.fine, self.fine, columns // self.fine, self.fine, 4
        )
        return blocks.mean(axis=(1, 3))


def openings_of(backdrop: Backdrop, forward: NDArray[np.float64], fine: int = 1) -> Openings:
    """Edges of a backdrop in pixels `fine` times finer than the film's.

    Parameters
    ----------
    backdrop : Backdrop
    forward : array (3,)
        View axis.
    fine : int
        Each of the finer pixels has the places that lie in it, or the nearest one.
    """
    _, height, width = backdrop.depth.shape
    rows, columns = height * fine, width * fine
    i, j = np.indices((height, width)) * fine
    parts = []
    for a, b in np.ndindex(fine, fine):
        pixel = ((i + a) * columns + j + b).ravel()
        members = _members(backdrop, a, b, fine)
        parts += [_edges(backdrop, place, pixel, 1 / len(members)) for place in members]
    pixel, depth, share, colour = (np.concatenate(part) for part in zip(*parts, strict=True))
    # Nothing to see but the background: no edges
    any_there = np.zeros(rows * columns, bool)
    any_there[pixel[np.isfinite(depth)]] = True
    kept = np.flatnonzero(any_there[pixel])
    order = kept[np.lexsort((depth[kept], pixel[kept]))]
    counts = np.bincount(pixel[order], minlength=rows * columns)
    first = np.concatenate([[0], np.cumsum(counts)])
    total = np.concatenate([[0.0], np.cumsum(share[order])])
    left = 1 - (total[1:] - np.repeat(total[first[:-1]], counts))
    left[left < CLOSED] = 0
    result = packed.Openings(
        first, depth[order], left.astype(f32), np.zeros(len(order), f32),
        first[:-1].reshape(rows, columns).copy(), vector64(forward),
    )  # fmt: skip
    return Openings(result, colour[order], (rows, columns), fine)


class Edges(NamedTuple):
    """Pixel, depth, share that is covered and colour times that share, of edges in any order."""

    pixel: NDArray[np.int64]
    depth: NDArray[np.float32]
    share: NDArray[np.float64]
    colour: NDArray[np.float32]


def _members(backdrop: Backdrop, a: int, b: int, fine: int) -> list[int]:
    """Places in a finer pixel of each pixel, row a and column b, or the nearest one."""
    cell = np.minimum((backdrop.offsets * fine).astype(int), fine - 1)
    inside = np.flatnonzero((cell == (b, a)).all(axis=1)).tolist()
    middle = (np.array((b, a)) + 0.5) / fine
    return inside or [int(((backdrop.offsets - middle) ** 2).sum(axis=1).argmin())]


def _edges(backdrop: Backdrop, place: int, pixel: NDArray[np.int64], weight: float) -> Edges:
    """Veils of a place, and the backdrop behind them."""
    open_to = np.full(len(pixel), weight)
    veils = _veil_edges(backdrop.veils, place, pixel, open_to)
    colour = backdrop.colour[place].reshape(-1, 4) / f32(255)
    colour[:, :3] *= colour[:, 3:]
    opaque = Edges(
        pixel, backdrop.depth[place].ravel(), open_to, (colour * open_to[:, None]).astype(f32)
    )
    if veils is None:
        return opaque
    both: list[tuple[NDArray, NDArray]] = list(zip(veils, opaque, strict=True))  # type: ignore[arg-type]
    return Edges._make(map(np.concatenate, both))


def _veil_edges(
    veils: Veils | None, place: int, pixel: NDArray[np.int64], open_to: NDArray[np.float64]
) -> Edges | None:
    """Veils of a place; `open_to`, the share open before them, becomes that behind them."""
    if veils is None:
        return None
    begin = veils.first[place * len(pixel) : (place + 1) * len(pixel) + 1]
    counts, here = np.diff(begin), slice(begin[0], begin[-1])
    rank = np.arange(begin[0], begin[-1]) - np.repeat(begin[:-1], counts)
    owner = np.repeat(np.arange(len(pixel)), counts)
    colour = veils.colour[here] / f32(255)
    share = np.zeros(len(owner))
    for k in range(int(counts.max(initial=0))):
        at = rank == k
        share[at] = open_to[owner[at]] * colour[at, 3]
        open_to[owner[at]] -= share[at]
    colour[:, 3] = 1
    return Edges(pixel[owner], veils.depth[here], share, (colour * share[:, None]).astype(f32))
