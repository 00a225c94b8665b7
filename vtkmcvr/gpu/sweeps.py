"""Directional occlusion on a device: how many blocks of layers a launch takes."""

from __future__ import annotations

import time
import warnings
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed, schedule
from .device import Device
from .errors import translated
from .fitting import uploaded
from .launches import LAUNCH_SECONDS, QUEUED, WAIT_SECONDS


class SweepDevice(Device):
    """A device that takes light through blocks of layers.

    Attributes
    ----------
    kernel : object
        numba-cuda's, with all that it was compiled for.
    """

    def __init__(self) -> None:
        super().__init__()
        with translated("the device was opened"):
            from ..kernels import cone_cuda
        self._sweeps = cone_cuda
        self.kernel = cone_cuda.sweep_layers
        self._grid = 1

    def compile(self, tables: Any) -> None:
        """Compile, or load from the cache; and see how many threads the device holds at a time."""
        with translated("kernels were compiled"), self._launcher.compiling():
            arguments = (*tables, np.int64(0), np.int64(0))
            self._grid = self._sweeps.most_blocks(self.kernel, arguments)
            self._launch(arguments)
            self.queue.synchronize()

    def sweep(self, tables: Any, first: int, last: int) -> Any:
        """Queue some blocks of layers. Returns a ticket."""
        with translated("a kernel was launched"):
            self._launch((*tables, np.int64(first), np.int64(last)))
            ticket = self._cuda.event(timing=False)
            ticket.record(self.queue)
        return ticket

    def _launch(self, arguments: tuple) -> None:
        with warnings.catch_warnings():
            # That a small picture does not fill the device
            warnings.filterwarnings("ignore", "Grid size")
            self.kernel[self._grid, self._sweeps.THREADS, self.queue](*arguments)

    def upload(self, part: Any) -> Any:
        """Return a packed tuple with its arrays on the device; one named twice is one there too."""
        self._known: dict[int, Any] = {}
        return super().upload(part)

    def _uploaded(self, part: Any) -> Any:
        if not isinstance(part, np.ndarray):
            return super()._uploaded(part)
        if id(part) not in self._known:
            blank = part.size > 1 and not any(part.strides)
            if blank:
                there = self._sweeps.array_of(part.flat[0], part.shape, self.queue)
            else:
                there = super()._uploaded(part)
            self._known[id(part)] = there
        return self._known[id(part)]


def run(
    device: SweepDevice,
    tables: Any,
    blocks: int,
    progress: Callable[[float], object] | None = None,
    abort: Callable[[], bool] | None = None,
) -> tuple[packed.OcclusionFilm, NDArray[np.int64], bool]:
    """Sweep all blocks of layers on a device.

    Parameters
    ----------
    device : SweepDevice
    tables : occlusion.tables.Tables
        Of the host; stay as they are.
    blocks : int
    progress, abort : callable, optional
        Between launches, of which each takes about 30 ms.

    Returns
    -------
    film, work, ended
        The film is read from the device once, at the end; whether the last block was reached.
    """
    [there] = uploaded(device, tables)
    schedule.compiling(lambda: device.compile(there))
    ended = _swept(device, there, blocks, progress, abort)
    return device.download(there.film), device.download(there.work), ended


def _swept(
    device: SweepDevice,
    there: Any,
    blocks: int,
    progress: Callable[[float], object] | None,
    abort: Callable[[], bool] | None,
) -> bool:
    queue: deque[tuple[Any, int]] = deque()
    start, first, size = time.perf_counter(), 0, 1
    while first < blocks or queue:
        if first < blocks:
            last = min(first + size, blocks)
            queue.append((device.sweep(there, first, last), last))
            first = last
        if len(queue) == QUEUED or first == blocks:
            done = _awaited(device, *queue.popleft())
            seconds = (time.perf_counter() - start) / done
            size = int(np.clip(LAUNCH_SECONDS / max(seconds, 1e-9), 1, 4 * size))
            if progress is not None:
                progress(done / blocks)
            if abort is not None and done < blocks and abort():
                for queued in queue:
                    _awaited(device, *queued)
                return False
    return True


def _awaited(device: SweepDevice, ticket: Any, last: int) -> int:
    while not device.finished(ticket):
        time.sleep(WAIT_SECONDS)
    return last
