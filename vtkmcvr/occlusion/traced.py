"""Default mode: light in beams of one direction each."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from ..kernels.cone_beams import trace_beam
from ..pack import f32
from .beams import Beams
from .raster import Raster
from .sweep import Block

# Beams are summed in this many groups, whatever the number of threads
GROUPS = 8
# Room of a beam's buffer around the film, pixels
ROOM = 64


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

    def __init__(self, raster: Raster, beams: Beams, colours: int):
        self.raster, self.beams, self.colours = raster, beams, colours
        self.routes = beams.routes(raster)
        rows, columns = raster.rows + 2 * ROOM, raster.columns + 2 * ROOM
        self.buffers = np.zeros((len(beams), colours, rows, columns), f32)
        self.origins = np.full((len(beams), colours, 2), -ROOM, np.int64)

    def through(
        self, block: Block, sums: NDArray, weights: NDArray, pool: ThreadPoolExecutor
    ) -> None:
        """Take every beam through a block of layers."""
        jobs = [
            pool.submit(self._group, block, group, sums[group], weights[group])
            for group in range(GROUPS)
        ]
        for job in jobs:
            job.result()

    def _group(self, block: Block, group: int, sums: NDArray, weights: NDArray) -> None:
        perspective, layers = self.raster.perspective, block.layers
        depth = self.raster.near + (block.start + np.arange(block.size) + 0.5) * (
            self.raster.thickness
        )
        zooms = (np.ones(block.size) if perspective is None else 1 / depth).astype(f32)
        sums[:] = 0
        weights[:] = 0 if perspective is not None else self.beams.weight[group::GROUPS].sum()
        # The weights of the second and third colour are those of the first
        spare = np.empty_like(weights[0]) if self.colours > 1 else weights[0]
        for k in range(group, len(self.beams), GROUPS):
            route = self.routes[k]
            first = route.first[block.start : block.start + block.size + 1]
            places = route.places[first[0] : first[-1]]
            for c in range(self.colours):
                tinted = layers.depth if layers.tinted is None else layers.tinted[c]
                trace_beam(
                    perspective, self.beams.cone, self.beams.beam(k), self.buffers[k, c],
                    self.origins[k, c], places, first - first[0], zooms, layers.depth, tinted,
                    block.filled, block.visible, sums[c], weights[0] if c == 0 else spare,
                )  # fmt: skip
