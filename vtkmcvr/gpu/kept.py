"""A device that keeps what it was given of scenes, for the next scene of the same volumes."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from .device import CudaDevice, _arrays


class KeptArrays:
    """Copies of arrays, each for as long as somebody has the array itself."""

    def __init__(self) -> None:
        self._copies: dict[int, tuple[weakref.ref[Any], Any]] = {}
        self._lock = threading.Lock()

    def __contains__(self, array: NDArray[Any]) -> bool:
        known = self._copies.get(id(array))
        return known is not None and known[0]() is array

    def copy_of(self, array: NDArray[Any], copied: Callable[[NDArray[Any]], Any]) -> Any:
        """Return the copy that there is, or `copied` of the array."""
        with self._lock:
            self._copies = {k: v for k, v in self._copies.items() if v[0]() is not None}
            if array not in self:
                self._copies[id(array)] = weakref.ref(array), copied(array)
            return self._copies[id(array)][1]


class KeptDevice(CudaDevice):
    """A device for pictures that follow each other, of scenes that share their volumes."""

    def __init__(self) -> None:
        super().__init__()
        self._kept = KeptArrays()
        self._of_scene = threading.local()

    def room_for(self, *parts: Any) -> None:
        """Refuse what does not fit beside what is there already."""
        new = {id(a): a for part in parts for a in _arrays(part) if a not in self._kept}
        super().room_for(tuple(new.values()))

    def upload(self, part: Any) -> Any:
        """Return a packed tuple with its arrays on the device; those of scenes are kept there."""
        self._of_scene.on = isinstance(part, packed.Scene)
        return super().upload(part)

    def _uploaded(self, part: Any) -> Any:
        if isinstance(part, np.ndarray) and self._of_scene.on:
            return self._kept.copy_of(part, super()._uploaded)
        return super()._uploaded(part)
