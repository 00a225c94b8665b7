"""Passes as launches on a device: how much at a time, progress and abort in between."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import packed, schedule
from ..adaptive import Density
from ..schedule import Progress, StopRules
from .fitting import uploaded

# A launch takes this long, so that an abort is heard and a desktop stays alive; two are queued, so
# that the device never waits for us
LAUNCH_SECONDS, QUEUED = 0.03, 2
# Enough for every multiprocessor; also the first launch, which nothing is known of
LEAST_PATHS = 2**16
# Rows of a launch are a multiple of a block's
ROWS = 8
WAIT_SECONDS = 0.0002


class Launch(NamedTuple):
    """Rows from `start` to before `end`, up to a number of samples of the mean pixel."""

    start: int
    end: int
    level: int
    paths: int


class Queued(NamedTuple):
    """A launch under way."""

    ticket: Any
    paths: int
    since: float


class OnDevice(NamedTuple):
    """What a render needs, in a device's memory."""

    scene: Any
    film: Any
    unlimited: Any  # (H, W) samples of a pixel where nothing limits them


@dataclass
class Pace:
    """Paths of a device while it was at work, and the seconds of that."""

    paths: int = 0
    busy: float = 0.0

    @property
    def rate(self) -> float:
        """Paths per second; 0 before anything is known."""
        return self.paths / self.busy if self.busy > 0 else 0.0


def placed(device: Any, scene: packed.Scene, film: packed.Film, seed: int) -> OnDevice:
    """Copy scene and film to a device, and compile for them or load from the cache."""
    unlimited = np.full(film.count.shape, schedule.UNLIMITED, np.int64)
    there = OnDevice(*uploaded(device, scene, film, unlimited))
    schedule.compiling(lambda: device.compile(there.film, there.scene, there.unlimited, seed))
    return there


class DeviceRun(schedule.Runner):
    """One render on a device, by the stop rules of the CPU's; the host's film stays as it is.

    Parameters
    ----------
    device : CudaDevice
    there : OnDevice
    scene, film, rules, seed, progress, density
        As for `vtkmcvr.schedule.run`; of the film on the host, the samples that there are.
    pace : Pace
        What is known of the device; kept up to date.
    """

    def __init__(
        self,
        device: Any,
        there: OnDevice,
        scene: packed.Scene,
        film: packed.Film,
        rules: StopRules,
        seed: int,
        progress: Callable[[Progress], object] | None,
        density: Density | None,
        pace: Pace,
    ):
        self.device, self.there, self.pace = device, there, pace
        super().__init__(scene, film, rules, seed, 1, progress, density)
        self.level, self.idle_since = self.first, self.start

    def result(self) -> packed.Film:
        """Film with all samples so far, on the host."""
        return self.device.download(self.there.film)

    def fill_up(self, counts: NDArray[np.int64]) -> None:
        """Bring every pixel up to a number of samples of its own."""
        wanted = self.device.upload(counts)
        self.level = int(self.result().count.min())
        self._work_off(int(counts.max()), lambda level: (wanted, level))

    def _pass(self, pool: object, target: int) -> None:
        self._work_off(target, self._goal_of)

    def _goal_of(self, level: int) -> tuple[Any, int]:
        """Samples of each pixel at a level, on the device, and the most that counts."""
        if self.density is None:
            return self.there.unlimited, level
        return self.device.upload(self._goals(level)), schedule.UNLIMITED

    def _work_off(self, target: int, goal_of: Callable[[int], tuple[Any, int]]) -> None:
        """Queue launches until all pixels have what they get at level `target`."""
        queue: deque[Queued] = deque()
        for launch in self._launches(target):
            if self.rules.running is not None:
                self.rules.running.wait(schedule.PAUSE_SECONDS)
            rows, (goal, cap) = (launch.start, launch.end), goal_of(launch.level)
            ticket = self.device.launch(
                self.there.film, self.there.scene, rows, goal, cap, self.seed
            )
            queue.append(Queued(ticket, launch.paths, time.perf_counter()))
            if len(queue) == QUEUED:
                self._await(queue.popleft())
                self._look()
            if self.halt.is_set():
                break
        while queue:
            self._await(queue.popleft())

    def _launches(self, target: int) -> Iterator[Launch]:
        """Parts of a pass: all rows by some samples, or some rows by one sample."""
        height, width = self.film.count.shape
        while self.level < target:
            paths = max(LEAST_PATHS * self.device.count, int(LAUNCH_SECONDS * self.pace.rate))
            samples = min(max(1, paths // (height * width)), target - self.level)
            least = ROWS * self.device.count
            rows = max(least, paths // width // least * least)
            if paths >= height * width:
                rows = height
            level = self.level + samples
            for start in range(0, height, rows):
                end = min(start + rows, height)
                yield Launch(start, end, level, (end - start) * width * samples)
            self.level = level

    def _await(self, queued: Queued) -> None:
        """Wait for the end of a launch; look at the stop rules meanwhile."""
        looked = time.perf_counter()
        while not self.device.finished(queued.ticket):
            time.sleep(WAIT_SECONDS)
            if time.perf_counter() - looked > schedule.POLL_SECONDS:
                self._look()
                looked = time.perf_counter()
        now = time.perf_counter()
        self.pace.busy += now - max(queued.since, self.idle_since)
        self.pace.paths += queued.paths
        self.idle_since = now
        self.paths += queued.paths

    def _look(self) -> None:
        if self.halt.is_set():
            return
        if self._over():
            self.halt.set()
        else:
            self._report(self.level)

    def _totals(self) -> packed.FilmTotals:
        return self.device.totals(self.there.film)


def run(
    device: Any,
    scene: packed.Scene,
    film: packed.Film,
    rules: StopRules,
    seed: int,
    progress: Callable[[Progress], object] | None = None,
    counts: NDArray[np.int64] | None = None,
    density: Density | None = None,
) -> tuple[packed.Film, str, float]:
    """Add samples on a device until a rule is met; the film given stays as it is.

    Parameters
    ----------
    device : CudaDevice
    scene, film, rules, seed, progress, density
        As for `vtkmcvr.schedule.run`.
    counts : array (H, W), optional
        Samples of each pixel to go on to where the rule was "samples".

    Returns
    -------
    film, stopped_by, seconds
        Compilation and copies of the scene are not counted, that of the film to the host is.
    """
    there = placed(device, scene, film, seed)
    if rules.nrms is not None:
        # Compiles it too
        device.totals(there.film)
    work = DeviceRun(device, there, scene, film, rules, seed, progress, density, Pace())
    stopped_by = work.run(None)
    if counts is not None and stopped_by == "samples":
        work.fill_up(counts)
    result = work.result()
    return result, stopped_by, time.perf_counter() - work.start
