"""Several CUDA devices as one: each takes every so manieth band of rows.

A pixel gets all its samples from one device. Nothing is summed over devices, and bits are those of
one device, whatever their number.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from . import device as one
from .device import _rebuilt
from .films import joined
from .launches import ROWS


def opened() -> Any:
    """All visible devices like the current one; that alone, where it is the only one."""
    first = one.CudaDevice()
    numbers = first.alike()
    if len(numbers) < 2:
        return first
    return SeveralDevices(
        [one.CudaDevice(number, len(numbers), k) for k, number in enumerate(numbers)]
    )


class SeveralDevices:
    """What `CudaDevice` does, by several of them; what is on them is a list of parts.

    Attributes
    ----------
    name : str
    count : int
    """

    def __init__(self, devices: list[Any]):
        self.devices, self.count = devices, len(devices)
        self.name = f"{self.count} x {devices[0].name}"

    def _each(self, method: str, *lists: Any) -> list[Any]:
        results = []
        for k, device in enumerate(self.devices):
            with device.current():
                results.append(getattr(device, method)(*(part[k] for part in lists)))
        return results

    def _all(self, part: Any) -> list[Any]:
        """The same part for each."""
        return [part] * self.count

    def room_for(self, *parts: Any) -> None:
        """Refuse what does not fit into the memory that is free on any of them."""
        self._each("room_for", *map(self._all, parts))

    def upload(self, part: Any) -> list[Any]:
        """Copy all of a packed tuple to each."""
        return self._each("upload", self._all(part))

    def download(self, parts: list[Any]) -> Any:
        """Return a packed tuple with each device's bands of rows, after all launches."""
        return _woven(self._each("download", parts))

    def compile(self, film: Any, scene: Any, goal: Any, seed: int) -> None:
        """Compile, or load, for each."""
        self._each("compile", film, scene, goal, self._all(seed))

    def launch(
        self, film: Any, scene: Any, rows: tuple[int, int], goal: Any, cap: int, seed: int
    ) -> list[Any]:
        """Queue samples for some rows, each its own. Returns a ticket."""
        everywhere = (self._all(rows), goal, self._all(cap), self._all(seed))
        return self._each("launch", film, scene, *everywhere)

    def totals(self, films: list[Any]) -> packed.FilmTotals:
        """Sums over the pixels of a film, each its own rows."""
        return joined(self._each("totals", films))

    def shown(self, films: list[Any], screen: packed.Screen) -> NDArray[np.uint8]:
        """Display picture of a film; a film filter, which crosses rows, takes the whole film."""
        if screen.window is None:
            return _bands(self._each("shown", films, self._all(screen)))
        whole, first = self.download(films), self.devices[0]
        with first.current():
            picture: NDArray[np.uint8] = first.shown(first.upload(whole), screen)
        return picture

    def finished(self, tickets: list[Any]) -> bool:
        """Whether a launch has ended on all of them."""
        return all(self._each("finished", tickets))


def _woven(parts: list[Any]) -> Any:
    first = parts[0]
    if isinstance(first, np.ndarray):
        return _bands(parts)
    if isinstance(first, tuple):
        inner = iter([_woven(list(same)) for same in zip(*parts, strict=True)])
        return _rebuilt(first, lambda _: next(inner))
    return first


def _bands(planes: list[NDArray]) -> NDArray:
    woven = planes[0].copy()
    for k, plane in enumerate(planes[1:], 1):
        rows = np.arange(len(plane)) // ROWS % len(planes) == k
        woven[rows] = plane[rows]
    return woven
