"""Front to back through blocks of layers: fill them, take the light through, add to the picture."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..kernels.cone_compose import compose_rows
from ..kernels.cone_fill import MOST_LAYERS, fill_rows
from ..kernels.cone_layers import ROWS, SEGMENT
from ..kernels.cone_look import close_rows, look_rows
from ..kernels.cone_runs import clear_rows, list_runs
from ..pack import f32
from .medium import Filling
from .raster import Raster

# Most pixels of the layers worked on at a time
BLOCK_PIXELS = 2**22
# Strips of rows to each thread: more even out what there is in them
STRIPS = 2

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
    """

    naive: int = 0
    looked_up: int = 0
    seen: int = 0


class Block(NamedTuple):
    """Layers `start` to `start + size`, being filled or full."""

    start: int
    size: int
    places: tuple[packed.LayerBlock, ...]
    layers: packed.Layers
    filled: packed.Runs
    visible: packed.Runs


class Light(Protocol):
    """How light gets through the layers: beams, or one buffer.

    `tiers`: faint stretches are lit by fewer directions; `relief`: rays of light go by pixels.
    """

    groups: int
    colours: int
    tiers: bool
    relief: bool

    def through(
        self, block: Block, sums: NDArray, weights: NDArray, slots: int, pool: ThreadPoolExecutor
    ) -> list[Future[None]]:
        """Begin to take the light through a block; write what the eye sees of it, by slot.

        `sums` (groups, colours, >= slots), `weights` (groups, >= segments, 2).
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
    openings : packed.Openings, optional
        Of a backdrop, in pixels of the film.
    """

    def __init__(
        self,
        raster: Raster,
        filling: Filling,
        light: Light,
        shade: packed.Shade | None,
        film: packed.OcclusionFilm,
        openings: packed.Openings | None = None,
    ):
        self.raster, self.filling, self.light = raster, filling, light
        self.shade, self.film, self.openings = shade, film, openings
        height, width = film.alpha.shape
        left, top = raster.left, raster.top
        edges = (-left, -top, width - left, height - top)
        self.image = tuple(np.int64(v) for v in edges)
        pixels = raster.rows * raster.columns
        self.work = Work(raster.count * pixels)
        self.depth = int(np.clip(BLOCK_PIXELS // max(pixels, 1), 1, MOST_LAYERS))
        self.stores = [self._store() for _ in range(2)]
        self.eye = self._eye()
        self.sums = np.zeros((light.groups, light.colours, 0), f32)
        self.weights = np.zeros((light.groups, 0, 2), f32)

    def _eye(self) -> packed.Eye:
        plane = (self.raster.rows, self.raster.columns)
        reach = np.tile(np.array([plane[1], 0], np.int32), (plane[0], 1))
        return packed.Eye(np.ones(plane, f32), np.ones(plane, f32), np.zeros(plane, f32), reach)

    def _store(self) -> tuple[packed.Layers, packed.Runs, packed.Runs]:
        rows, columns = self.raster.rows, self.raster.columns
        plane = (self.depth, rows, columns)
        depth = np.zeros(plane, f32)
        colours = (3, *plane)
        several = len(self.filling.volumes) > 1
        relief = self.light.relief and self.filling.bleeding is None
        layers = packed.Layers(
            depth,
            np.zeros(plane, f32) if self.filling.limited else depth,
            None if self.filling.bleeding is None else np.zeros(colours, f32),
            np.zeros(colours, f32) if several else None,
            np.zeros(plane, f32),
            np.zeros(plane, f32),
            np.zeros(plane, f32),
            np.zeros(plane, f32) if relief else None,
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
        chunk = max(ROWS, -(-rows // (STRIPS * threads) // ROWS) * ROWS)
        self.strips = [(a, min(a + chunk, rows)) for a in range(0, rows, chunk)]
        before: Block | None = None
        volumes = range(len(self.filling.volumes))
        self.lanes = {s: [self.filling.lanes(v) for v in volumes] for s in self.strips}
        with ThreadPoolExecutor(threads, thread_name_prefix="vtkmcvr") as pool:
            following = self._begin(pool, 0)
            while following is not None:
                block, jobs = following
                self.work.looked_up += sum(job.result() for job in jobs)
                dark = self._view(pool, before, block)
                end = block.start + block.size
                lighting = self._light(pool, block)
                following = None if dark else self._begin(pool, end)
                for job in lighting:
                    job.result()
                before = block
                if progress is not None:
                    progress(1.0 if dark else end / count)
                if abort is not None and abort():
                    break
            ended = following is None
            self._view(pool, before, None)
        if ended:
            self._close()
        return ended

    def _close(self) -> None:
        """Let the backdrop show through what is left of view rays, where there is one."""
        if self.openings is None:
            return
        left = np.ones_like(self.film.alpha)
        first, top, end, bottom = (int(v) for v in self.image)
        rows = slice(max(top, 0), min(bottom, self.raster.rows))
        columns = slice(max(first, 0), min(end, self.raster.columns))
        eye = self.eye.whole if self.filling.limited else self.eye.light
        there = eye[rows, columns]
        i, j = rows.start - top, columns.start - first
        left[i : i + there.shape[0], j : j + there.shape[1]] = there
        close_rows(self.openings, left, 0, len(left))

    def _begin(
        self, pool: ThreadPoolExecutor, start: int
    ) -> tuple[Block, list[Future[int]]] | None:
        """Begin to fill the block at a layer; None beyond the last."""
        n = min(self.depth, self.raster.count - start)
        if n <= 0:
            return None
        layers, filled, visible = self.stores[start // self.depth % 2]
        part = packed.Layers._make(_first_layers(a, n) for a in layers)
        places = tuple(self.raster.block(start, volume) for volume in self.filling.volumes)
        block = Block(start, n, places, part, _first(filled, n), _first(visible, n))
        return block, [pool.submit(self._fill, block, strip) for strip in self.strips]

    def _fill(self, block: Block, strip: Strip) -> int:
        clear_rows(block.layers, block.filled, *strip)
        bleeding = f32(self.filling.bleeding or 0)
        return sum(
            fill_rows(
                volume.medium, volume.transfer, volume.integrals, place, bleeding, block.layers,
                block.filled, self.lanes[strip][number], number > 0, self.filling.skip, *strip,
            )
            for number, (volume, place) in enumerate(
                zip(self.filling.volumes, block.places, strict=True)
            )
        )  # fmt: skip

    def _view(self, pool: ThreadPoolExecutor, lit: Block | None, filled: Block | None) -> bool:
        """Add a lit block to the picture, and look through the next. Returns whether all is dark.

        Of the same rows in one go: the first half of what an eye sees of a block is light.
        """

        def rows(strip: Strip) -> bool:
            if lit is not None:
                self._compose(lit, strip)
            return filled is None or self._look(filled, strip)

        return all(list(pool.map(rows, self.strips)))

    def _look(self, block: Block, strip: Strip) -> bool:
        """Look through a block. Returns whether no view ray goes on."""
        f = self.filling
        return bool(look_rows(
            self.raster.perspective, block.places[0], block.layers, block.filled, block.visible,
            self.eye, self.openings, self.film, self.image, f32(f.opaque), f.limited,
            self.light.tiers, *strip,
        ))  # fmt: skip

    def _light(self, pool: ThreadPoolExecutor, block: Block) -> list[Future[None]]:
        """Begin to take the light through a block."""
        list_runs(block.filled)
        slots = int(list_runs(block.visible))
        self.work.seen += slots
        if slots > self.sums.shape[2]:
            self.sums = np.empty((*self.sums.shape[:2], slots), f32)
            self.weights = np.empty((len(self.weights), slots // SEGMENT, 2), f32)
        return self.light.through(block, self.sums, self.weights, slots, pool)

    def _compose(self, block: Block, strip: Strip) -> None:
        volume = self.filling.volumes[0]
        compose_rows(
            volume.medium, volume.transfer, volume.integrals, block.places[0],
            self.raster.perspective, self.shade, block.layers, block.visible, self.sums,
            self.weights, self.film, self.image, *strip,
        )  # fmt: skip


def _first_layers(a: NDArray | None, n: int) -> NDArray | None:
    """The first layers, contiguous: of colours, which come before them, a new array."""
    if a is None or n == a.shape[-3]:
        return a
    return a[:n] if a.ndim == 3 else np.zeros((len(a), n, *a.shape[2:]), f32)


def _first(runs: packed.Runs, n: int) -> packed.Runs:
    """Runs of the first layers."""
    return packed.Runs._make((*(a[:n] for a in runs[:5]), *runs[5:]))


def _runs(count: int, rows: int, columns: int) -> packed.Runs:
    segments = columns // SEGMENT
    most = (count, rows, segments // 2 + 1)
    number = math.prod(most)
    return packed.Runs(
        np.zeros((count, rows, segments), np.uint8), np.zeros((count, rows), np.int32),
        np.zeros(most, np.int32), np.zeros(most, np.int32),
        np.zeros((count, rows + 1), np.int64), np.zeros((number, 3), np.int32),
        np.zeros(number, np.int64), np.zeros(count + 1, np.int64),
    )  # fmt: skip
