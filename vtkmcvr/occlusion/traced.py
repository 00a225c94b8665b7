"""Default mode: light in beams of one direction each."""

from __future__ import annotations

import math
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from ..kernels.cone_layers import SEGMENT
from ..kernels.cone_trace import trace_beams
from ..pack import f32
from .beams import Beams
from .raster import Raster
from .sweep import Block

# Beams are summed in this many groups, whatever the number of threads. Of three beams, which lie
# around the cone's axis by thirds of a turn and more, one is in the first two groups: what the eye
# sees little of is lit by these alone.
GROUPS, FAINT_GROUPS = 6, 2
# Beams from which on that is done
MANY = 24
# Rays are taken in bands of rows in which the eye sees so many pixels of a block's layers, but not
# fewer rows: that much of all arrays fits into a core's cache
BAND, TALL = 8192, 32
# Room of a beam's buffer beside the film, pixels, and rows more than the film's
ROOM, MORE_ROWS = 192, 64


class Traced:
    """Beams with their buffers.

    Parameters
    ----------
    raster : Raster
    beams : Beams
    colours : int
        1, or 3 for coloured light.
    """

    groups = GROUPS
    relief = True

    def __init__(self, raster: Raster, beams: Beams, colours: int):
        self.raster, self.beams, self.colours = raster, beams, colours
        self.tiers = len(beams) >= MANY
        self.slants = raster.slants
        self.members = _groups(len(beams))
        routes = beams.routes(raster)
        before = np.cumsum([0, *(len(route.places) for route in routes)])[:-1]
        self.places = np.concatenate([route.places for route in routes])
        self.first = np.array([a + r.first for a, r in zip(before, routes, strict=True)])
        self.table = np.column_stack([beams.sideways, beams.weight]).astype(f32)
        rows, columns = raster.rows + MORE_ROWS, raster.columns + 2 * ROOM
        self.buffers = np.zeros((len(beams), colours, rows, columns), f32)
        self.origins = np.tile(np.array([0, -ROOM, 0]), (len(beams), colours, 1))

    def through(
        self, block: Block, sums: NDArray, weights: NDArray, slots: int, pool: ThreadPoolExecutor
    ) -> list[Future[None]]:
        """Begin to take every beam through a block of layers."""
        return [
            pool.submit(self._group, block, group, sums[group], weights[group], slots)
            for group in range(GROUPS)
        ]

    def _group(self, block: Block, group: int, sums: NDArray, weights: NDArray, slots: int) -> None:
        perspective, layers = self.raster.perspective, block.layers
        depth = self.raster.near + (block.start + np.arange(block.size) + 0.5) * (
            self.raster.thickness
        )
        zooms = (np.ones(block.size) if perspective is None else 1 / depth).astype(f32)
        sums[:, :slots] = 0
        weights[: slots // SEGMENT] = 0
        trace_beams(
            perspective, self.slants, self.beams.cone, self.table, self.members[group],
            self.tiers and group >= FAINT_GROUPS, self.buffers, self.origins, self.places,
            self.first, block.start, zooms, layers,
            layers.depth[None] if layers.tinted is None else layers.tinted,
            block.filled, block.visible, sums, weights,
            np.empty_like(weights) if self.colours > 1 else weights,
            max(1, min(self.raster.rows // TALL, math.ceil(slots / BAND))),
        )  # fmt: skip


def _groups(count: int) -> list[NDArray[np.int64]]:
    """Numbers of the beams in each group."""
    k = np.arange(count)
    faint, others = k[k % 3 == 0], k[k % 3 > 0]
    rest = GROUPS - FAINT_GROUPS
    return [
        *(faint[g::FAINT_GROUPS] for g in range(FAINT_GROUPS)),
        *(others[g::rest] for g in range(rest)),
    ]
