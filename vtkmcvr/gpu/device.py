"""A CUDA device: what is in its memory, and launches on it."""

from __future__ import annotations

import warnings
from contextlib import nullcontext
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from . import films
from .errors import CPU_INSTEAD, SMALLER, OutOfDeviceMemory, translated


class Device:
    """A CUDA device with a queue of its own: what is copied to it, and what has ended on it.

    Parameters
    ----------
    number : int, optional
        Of those that are visible; default: the current one. All that is done with another one must
        be done while it is `current`.

    Attributes
    ----------
    name : str
        As the driver calls it, with its compute capability.
    """

    def __init__(self, number: int | None = None) -> None:
        with translated("the device was opened"):
            from numba import cuda

            from ..kernels import cuda as launcher

            # numba-cuda's, of which type checkers know nothing
            self._cuda: Any = cuda
            self._launcher: Any = launcher
            self._context = nullcontext() if number is None else cuda.gpus[number]
            with self._context:
                self._open()

    def _open(self) -> None:
        self.queue = self._cuda.stream()
        device = self._cuda.get_current_device()
        major, minor = device.compute_capability
        self.name = f"{getattr(device, 'name', 'simulator')}, compute capability {major}.{minor}"

    def alike(self) -> list[int]:
        """Numbers of all visible devices that run the very same machine code."""
        with translated("devices were counted"):
            capability = self._cuda.get_current_device().compute_capability
            return [
                number
                for number, device in enumerate(self._cuda.gpus)
                if device.compute_capability == capability
            ]

    def current(self) -> Any:
        """Context in which this device is the current one."""
        return self._context

    def room_for(self, *parts: Any) -> None:
        """Refuse what does not fit into the memory that is free."""
        with translated("its memory was measured"):
            free = self._cuda.current_context().get_memory_info().free
        arrays = {id(array): array for part in parts for array in _arrays(part)}
        needed = sum(array.nbytes for array in arrays.values())
        if needed > free:
            raise OutOfDeviceMemory(
                f"scene and film take {needed / 2**20:.0f} MiB of device memory, {self.name} has "
                f"{free / 2**20:.0f} MiB free: {SMALLER} {CPU_INSTEAD}"
            )

    def upload(self, part: Any) -> Any:
        """Return a packed tuple with its arrays on the device."""
        with translated("scene and film were copied to the device"):
            return self._uploaded(part)

    def _uploaded(self, part: Any) -> Any:
        if isinstance(part, np.ndarray):
            return self._cuda.to_device(np.ascontiguousarray(part), self.queue)
        return _rebuilt(part, self._uploaded) if isinstance(part, tuple) else part

    def download(self, part: Any) -> Any:
        """Return a packed tuple with its arrays back on the host, after all launches."""
        with translated("the film was copied from the device"):
            downloaded = self._downloaded(part)
            self.queue.synchronize()
        return downloaded

    def _downloaded(self, part: Any) -> Any:
        if hasattr(part, "copy_to_host"):
            return part.copy_to_host(stream=self.queue)
        return _rebuilt(part, self._downloaded) if isinstance(part, tuple) else part

    def finished(self, ticket: Any) -> bool:
        """Whether a launch has ended; an error in a kernel shows here."""
        with translated("a kernel ran"):
            return bool(ticket.query())


class CudaDevice(Device):
    """A device that takes samples for the pixels of a film.

    Parameters
    ----------
    number : int, optional
        As of `Device`.
    every, which : int
        Of the bands of rows, every so manieth is taken, from band `which` on.

    Attributes
    ----------
    count : int
        Devices that share the rows.
    """

    count = 1

    def __init__(self, number: int | None = None, every: int = 1, which: int = 0) -> None:
        super().__init__(number)
        self.every, self.which = every, which

    def compile(self, film: Any, scene: Any, goal: Any, seed: int) -> None:
        """Compile, or load from the cache, for this structure of scene."""
        with translated("kernels were compiled"), self._launcher.compiling():
            # Up to no sample
            self._launch(film, scene, (0, goal.shape[0]), goal, 0, seed)
            self.queue.synchronize()

    def launch(
        self, film: Any, scene: Any, rows: tuple[int, int], goal: Any, cap: int, seed: int
    ) -> Any:
        """Queue samples for some rows; see `kernels.cuda.render_rows`. Returns a ticket."""
        with translated("a kernel was launched"):
            self._launch(film, scene, rows, goal, cap, seed)
            ticket = self._cuda.event(timing=False)
            ticket.record(self.queue)
        return ticket

    def totals(self, film: Any) -> packed.FilmTotals:
        """Sums over this device's pixels of a film, of which only these sums are copied."""
        return films.totals(self, film)

    def shown(self, film: Any, screen: packed.Screen) -> NDArray[np.uint8]:
        """Display picture of a film on the device, (H, W, 4), of which only bytes are copied."""
        return films.shown(self, film, screen)

    def _launch(
        self, film: Any, scene: Any, rows: tuple[int, int], goal: Any, cap: int, seed: int
    ) -> None:
        across, down = self._launcher.BLOCK
        first = rows[0] + (self.which - rows[0] // down) % self.every * down
        blocks = -(-goal.shape[1] // across), -(-(rows[1] - first) // (down * self.every))
        if blocks[1] < 1:
            return
        row_0, row_1, most, key, every = map(np.int64, (first, rows[1], cap, seed, self.every))
        with warnings.catch_warnings():
            # That a small picture does not fill the device
            warnings.filterwarnings("ignore", "Grid size")
            configured = self._launcher.render_rows[blocks, (across, down), self.queue]
        configured(film, scene, row_0, row_1, goal, most, key, every)


def _rebuilt(part: tuple, convert: Any) -> tuple:
    converted = map(convert, part)
    return type(part)(*converted) if hasattr(part, "_fields") else tuple(converted)


def _arrays(part: Any) -> list[NDArray]:
    if isinstance(part, np.ndarray):
        return [part]
    return [array for inner in part for array in _arrays(inner)] if isinstance(part, tuple) else []
