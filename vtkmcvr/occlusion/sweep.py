"""Front to back through blocks of layers: fill them, take the light through, add to the picture."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from time import perf_counter
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..kernels.cone_compose import compose_rows
from ..kernels.cone_layers import ROWS, SEGMENT, fill_rows, number_runs
from ..pack import f32
from .medium import Filling
from .raster import Raster

# Layers worked on at a time, and most pixels of them
MOST_LAYERS, BLOCK_PIXELS = 8, 2**22

Strip = tuple[int, int]


@dataclass
class Work:
    """What a picture took.

    Attributes
    ----------
    naive : int
        Pixels times layers: what a loop over everything visits.
    looked_up, seen : int
        Of these, those in which the scalar was looked up, and those that the eye saw.
    seconds : dict
        By stage; stages overlap on several threads.
    """

    naive: int = 0
    looked_up: int = 0
    seen: int = 0
    seconds: dict[str, float] = field(default_factory=lambda: dict.fromkeys(("wait", "light"), 0.0))


class Block(NamedTuple):
    """Layers `start` to `start + size`, being filled or full."""

    start: int
    size: int
    place: packed.LayerBlock
    layers: packed.Layers
    filled: packed.Runs
    visible: packed.Runs


class Light(Protocol):
    """How light gets through the layers: beams, or one buffer."""

    groups: int
    colours: int

    def through(
        self, block: Block, sums: NDArray, weights: NDArray, pool: ThreadPoolExecutor
    ) -> None:
        """Take the light through a block; write what the eye sees of it, by slot.

        `sums` (groups, colours, slots), `weights` (groups, 1, slots).
        """


class Sweep:
    """All layers, a block at a time; while light goes through one block, the next is filled.

    Parameters
    ----------
    raster : Raster
    filling : Filling
    light : Light
    shade : packed.Shade, optional
    film : packed.OcclusionFilm
        Is added to.
    """

    def __init__(
        self,
        raster: Raster,
        filling: Filling,
        light: Light,
        shade: packed.Shade | None,
        film: packed.OcclusionFilm,
    ):
        self.raster, self.filling, self.light = raster, filling, light
        self.shade, self.film = shade, film
        height, width = film.alpha.shape
        left, top = raster.left, raster.top
        edges = (-left, -top, width - left, height - top)
        self.image = tuple(np.int64(v) for v in edges)
        pixels = raster.rows * raster.columns
        self.work = Work(raster.count * pixels)
        self.depth = int(np.clip(BLOCK_PIXELS // max(pixels, 1), 1, MOST_LAYERS))
        self.stores = [self._store() for _ in range(2)]
        self.transmittance = np.ones((raster.rows, raster.columns), f32)
        self.sums = np.zeros((light.groups, light.colours, 0), f32)
        self.weights = np.zeros((light.groups, 1, 0), f32)

    def _store(self) -> tuple[packed.Layers, packed.Runs, packed.Runs]:
        rows, columns = self.raster.rows, self.raster.columns
        plane = (self.depth, rows, columns)
        layers = packed.Layers(
            np.zeros(plane, f32),
            None if self.filling.bleeding is None else np.zeros((3, *plane), f32),
            *(np.zeros(plane, f32) for _ in range(3)),
        )
        return layers, _runs(*plane), _runs(*plane)

    def run(
        self,
        threads: int,
        progress: Callable[[float], object] | None = None,
        abort: Callable[[], bool] | None = None,
    ) -> bool:
        """Sweep all layers. Returns whether it came to the end."""
        count, rows = self.raster.count, self.raster.rows
        chunk = max(ROWS, -(-rows // (4 * threads) // ROWS) * ROWS)
        self.strips = [(a, min(a + chunk, rows)) for a in range(0, rows, chunk)]
        starts = range(0, count, self.depth)
        with ThreadPoolExecutor(threads, thread_name_prefix="vtkmcvr") as pool:
            following = self._begin(pool, 0) if count else None
            for start in starts:
                assert following is not None
                block, jobs = following
                begin = perf_counter()
                self.work.looked_up += sum(job.result() for job in jobs)
                following = self._begin(pool, start + self.depth)
                self.work.seconds["wait"] += perf_counter() - begin
                self._light(pool, block)
                if progress is not None:
                    progress(min(1.0, (start + self.depth) / count))
                if abort is not None and abort():
                    return following is None
        return True

    def _begin(
        self, pool: ThreadPoolExecutor, start: int
    ) -> tuple[Block, list[Future[int]]] | None:
        """Begin to fill the block at a layer; None beyond the last."""
        n = min(self.depth, self.raster.count - start)
        if n <= 0:
            return None
        layers, filled, visible = self.stores[start // self.depth % 2]
        part = packed.Layers(
            layers.depth[:n],
            None if layers.tinted is None else layers.tinted[:, :n],
            *(a[:n] for a in layers[2:]),
        )
        block = Block(
            start, n, self.raster.block(start), part, _first(filled, n), _first(visible, n)
        )
        return block, [pool.submit(self._fill, block, strip) for strip in self.strips]

    def _fill(self, block: Block, strip: Strip) -> int:
        f = self.filling
        return fill_rows(
            f.medium, f.transfer, f.integrals, block.place, self.raster.perspective,
            f32(f.bleeding or 0), block.layers, block.filled, block.visible, self.transmittance,
            self.image, f32(f.opaque), f.skip, *strip,
        )  # fmt: skip

    def _light(self, pool: ThreadPoolExecutor, block: Block) -> None:
        begin = perf_counter()
        slots = int(number_runs(block.visible))
        self.work.seen += slots
        if slots > self.sums.shape[2]:
            self.sums = np.zeros((*self.sums.shape[:2], slots), f32)
            self.weights = np.zeros((*self.weights.shape[:2], slots), f32)
        self.light.through(block, self.sums, self.weights, pool)
        jobs = [pool.submit(self._compose, block, strip) for strip in self.strips]
        for job in jobs:
            job.result()
        self.work.seconds["light"] += perf_counter() - begin

    def _compose(self, block: Block, strip: Strip) -> None:
        f = self.filling
        compose_rows(
            f.medium, f.transfer, f.integrals, block.place, self.raster.perspective, self.shade,
            block.layers, block.visible, self.sums, self.weights, self.film, self.image, *strip,
        )  # fmt: skip


def _first(runs: packed.Runs, n: int) -> packed.Runs:
    """Runs of the first layers."""
    return packed.Runs(runs.flags[:n], runs.count[:n], runs.start[:n], runs.end[:n], runs.slot[:n])


def _runs(count: int, rows: int, columns: int) -> packed.Runs:
    segments = -(-columns // SEGMENT)
    most = (count, rows, segments // 2 + 1)
    return packed.Runs(
        np.zeros((count, rows, segments), np.bool_), np.zeros((count, rows), np.int32),
        np.zeros(most, np.int32), np.zeros(most, np.int32), np.zeros(most, np.int64),
    )  # fmt: skip
