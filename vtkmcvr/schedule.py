"""Passes and tiles on a thread pool: when to stop, how much at a time. No pixel depends on it."""

from __future__ import annotations

import logging
import math
import os
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import packed
from .accuracy import ImageError, error_of, samples_for, totals_of
from .adaptive import QUARTERS, Density, goals, level_of, level_with
from .sight import fill_black, nothing_seen
from .tiles import Launcher, render_tile

logger = logging.getLogger("vtkmcvr")

Tile = tuple[int, int, int, int]
Compiled = TypeVar("Compiled")

# Work between two looks at abort and deadline, and length of a pass, in seconds
TILE_SECONDS, PASS_SECONDS, POLL_SECONDS = 0.01, 0.5, 0.02
# The first is before the time of a path is known
FIRST_TILE, LARGEST_TILE = 32, 64
# Work that a pause waits for: a frame is about to be drawn
PAUSABLE_SECONDS = 0.004
PAUSE_SECONDS = 1.0
COMPILE_MESSAGE_AFTER = 1.0
UNLIMITED = 2**40
# Before an error is believed: samples of a pixel, and paths in all, so that a light that one path
# in 100 000 finds has been found
LEAST_SAMPLES, LEAST_PATHS = 16, 2**20
# Paths without any light after which a picture is taken to be black
DARK_PATHS = 2**24


@dataclass(frozen=True)
class Progress:
    """State of a running render, as the progress callback sees it.

    Attributes
    ----------
    fraction : float
        Share of the work done by the stop rule that will be met first, [0, 1].
    samples : int
        Samples per pixel that are complete; the mean over pixels where they are adaptive.
    seconds : float
        Time since the start, compilation included.
    """

    fraction: float
    samples: int
    seconds: float


@dataclass(frozen=True)
class StopRules:
    """Whichever is met first ends the render.

    Parameters
    ----------
    samples : int, optional
        Samples per pixel to reach; the mean over pixels where they are adaptive.
    seconds : float, optional
        Time to spend, compilation not counted.
    nrms : float, optional
        Error to reach: the upper end of its 95 % interval. A picture that stays black ends too.
    abort : callable, optional
        Asked every few hundredths of a second; True ends the render.
    running : threading.Event, optional
        While it is not set, no tile is begun, but for no longer than `PAUSE_SECONDS` at a time.
    """

    samples: int | None
    seconds: float | None
    abort: Callable[[], bool] | None
    nrms: float | None = None
    running: threading.Event | None = None


def run(
    scene: packed.Scene,
    film: packed.Film,
    rules: StopRules,
    seed: int,
    threads: int,
    progress: Callable[[Progress], object] | None = None,
    density: Density | None = None,
) -> tuple[str, float]:
    """Add samples to the film until a rule is met. Returns (which rule, seconds of rendering).

    `density` says where they go; None: everywhere alike. Where there is nothing to see, nothing is
    compiled or traced.
    """
    if nothing_seen(scene):
        stopped_by = fill_black(film, rules.samples, density)
        if progress is not None:
            progress(Progress(1.0, level_of(film.count, density), 0.0))
        return stopped_by, 0.0
    launch = compiling(lambda: Launcher(film, scene, np.zeros_like(film.count), np.int64(seed)))
    runner = Runner(scene, film, rules, seed, threads, progress, density, launch)
    with ThreadPoolExecutor(threads, thread_name_prefix="vtkmcvr") as pool:
        stopped_by = runner.run(pool)
    return stopped_by, time.perf_counter() - runner.start


def fill_up(scene: packed.Scene, film: packed.Film, counts: NDArray[np.int64], seed: int) -> None:
    """Bring every pixel up to a number of samples of its own, as a run that was cut off left it."""
    height, width = counts.shape
    render_tile(film, scene, 0, height, 0, width, np.ascontiguousarray(counts), np.int64(seed))


def default_threads() -> int:
    """Number of CPUs that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def compiling(launch: Callable[[], Compiled]) -> Compiled:
    """Call what compiles, or loads from the cache; say so when it takes long."""
    message = "compiling the kernels for this scene's effects (once; they are cached on disk)"
    timer = threading.Timer(COMPILE_MESSAGE_AFTER, logger.warning, [message])
    timer.daemon = True
    timer.start()
    try:
        return launch()
    finally:
        timer.cancel()


class Runner:
    """One render: passes over all pixels, each a list of tiles."""

    def __init__(
        self,
        scene: packed.Scene,
        film: packed.Film,
        rules: StopRules,
        seed: int,
        threads: int,
        progress: Callable[[Progress], object] | None,
        density: Density | None,
        launch: Launcher | None = None,
    ):
        self.scene, self.film, self.rules, self.launch = scene, film, rules, launch
        self.seed, self.threads, self.progress = seed, threads, progress
        self.density = density
        self.goal = UNLIMITED if rules.samples is None else rules.samples
        self.first = level_of(film.count, density)
        self.pixels = film.count.size if density is None else max(1, int(density.sum()) // QUARTERS)
        self.least = level_with(LEAST_SAMPLES, density)
        self.halt = threading.Event()
        self.paths = 0
        self.error: ImageError | None = None
        self.stopped_by = ""
        self.start = time.perf_counter()

    def run(self, pool: Any) -> str:
        """Pass after pass until a rule is met; `pool` does the work."""
        done = self.first
        while done < self.goal:
            target = self._next_target(done)
            self._pass(pool, target)
            if self.halt.is_set():
                return self.stopped_by
            done = target
            self._judge(done)
            self._report(done)
            if self.stopped_by or self._over():
                return self.stopped_by
        return "samples"

    def _next_target(self, done: int) -> int:
        """Samples to reach in the next pass: about half a second, or what is left of the time."""
        if not self.paths:
            return done + 1
        elapsed = time.perf_counter() - self.start
        rate = self.paths / max(elapsed, 1e-6)
        seconds = PASS_SECONDS
        if self.rules.seconds is not None:
            seconds = min(seconds, self.rules.seconds - elapsed)
        more = max(1, int(seconds * rate / self.pixels))
        if self.rules.nrms is not None:
            # Slowly at first: a whole pass may be far more than it takes
            more = min(more, max(3 * done, self.least - done))
        if self.error is not None and math.isfinite(self.error.high):
            assert self.rules.nrms is not None
            enough = samples_for(self.error.high, done, self.rules.nrms)
            enough = max(enough, self.least, LEAST_PATHS / self.pixels)
            more = max(1, min(more, math.ceil(enough) - done))
        return min(done + more, self.goal)

    def _goals(self, target: int) -> NDArray[np.int64]:
        return goals(target, self.film.count.shape, self.density)

    def _totals(self) -> packed.FilmTotals:
        return totals_of(self.film)

    def _judge(self, done: int) -> None:
        """Stop where the error is small enough, or where there is no light at all."""
        if self.rules.nrms is None:
            return
        totals = self._totals()
        self.error = error_of(totals, self.film.mean.size)
        paths = int(totals.paths)
        if done < self.least or paths < LEAST_PATHS:
            return
        if self.error.high <= self.rules.nrms:
            self.stopped_by = "nrms"
        elif not self.error.bright and paths >= DARK_PATHS:
            self.stopped_by = "dark"

    def _pass(self, pool: Any, target: int) -> None:
        assert self.launch is not None
        tiles, lock = iter(list(self._tiles(target))), threading.Lock()
        self.launch.goal[...] = self._goals(target)
        jobs = [pool.submit(self._work, tiles, lock, self.launch) for _ in range(self.threads)]
        try:
            self._watch(jobs)
        except BaseException:
            self.halt.set()
            wait(jobs)
            raise

    def _tiles(self, target: int) -> Iterator[Tile]:
        """Squares that take about `TILE_SECONDS` each, or `PAUSABLE_SECONDS`."""
        height, width = self.film.count.shape
        edge = FIRST_TILE
        if self.paths:
            rate = self.paths / self.threads / max(time.perf_counter() - self.start, 1e-6)
            samples = max(1, target - level_of(self.film.count, self.density))
            seconds = TILE_SECONDS if self.rules.running is None else PAUSABLE_SECONDS
            area = rate * seconds / samples * self.film.count.size / self.pixels
            edge = int(np.clip(math.sqrt(area), 4, LARGEST_TILE))
        for row in range(0, height, edge):
            for column in range(0, width, edge):
                yield row, min(row + edge, height), column, min(column + edge, width)

    def _work(self, tiles: Iterator[Tile], lock: threading.Lock, launch: Launcher) -> None:
        while not self.halt.is_set():
            if self.rules.running is not None:
                self.rules.running.wait(PAUSE_SECONDS)
            with lock:
                tile = next(tiles, None)
            if tile is None:
                return
            row_0, row_1, column_0, column_1 = tile
            here = slice(row_0, row_1), slice(column_0, column_1)
            more = int(np.maximum(launch.goal[here] - self.film.count[here], 0).sum())
            launch(*tile)
            with lock:
                self.paths += more

    def _watch(self, jobs: list[Future]) -> None:
        """Wait for the workers; stop them when a rule says so."""
        pending = set(jobs)
        while pending:
            done, pending = wait(pending, timeout=POLL_SECONDS)
            for job in done:
                job.result()
            if pending and self._over():
                self.halt.set()
            elif pending:
                self._report(level_of(self.film.count, self.density))

    def _over(self) -> bool:
        if self.rules.abort is not None and self.rules.abort():
            self.stopped_by = "user"
        elif (
            self.rules.seconds is not None
            and time.perf_counter() - self.start >= self.rules.seconds
        ):
            self.stopped_by = "seconds"
        return bool(self.stopped_by)

    def _report(self, samples: int) -> None:
        if self.progress is None:
            return
        elapsed = time.perf_counter() - self.start
        fraction = self.paths / max(1, (self.goal - self.first) * self.pixels)
        if self.rules.seconds is not None:
            fraction = max(fraction, elapsed / self.rules.seconds)
        if self.error is not None and self.error.high > 0:
            assert self.rules.nrms is not None
            fraction = max(fraction, (self.rules.nrms / self.error.high) ** 2)
        self.progress(Progress(min(fraction, 1.0), samples, elapsed))
