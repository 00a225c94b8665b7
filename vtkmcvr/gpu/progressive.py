"""A picture in the making on a device, where scene and film stay from step to step."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..accuracy import ImageError, error_of
from ..schedule import Progress, StopRules
from ..screen import Display, packed_screen
from . import launches


class DevicePicture:
    """A picture that is refined step by step; what is copied back is what is asked for.

    Parameters
    ----------
    device : CudaDevice or SeveralDevices
    scene : packed.Scene
    film : packed.Film
        To begin with, all pixels with equally many samples; stays as it is.
    seed : int

    Attributes
    ----------
    samples : int
        Samples per pixel that are complete.
    seconds : float
        Rendering time so far.

    Examples
    --------
    >>> picture = DevicePicture(opened(), planned.packed, empty_film(planned), seed=0)
    >>> picture.advance(StopRules(64, None, None))
    'samples'
    >>> pixels = picture.shown(Display(exposure=1.5))
    """

    def __init__(self, device: Any, scene: packed.Scene, film: packed.Film, seed: int) -> None:
        self.device, self.seed, self.seconds = device, seed, 0.0
        self._scene, self._blank = scene, film
        self._there = launches.placed(device, scene, film, seed)
        self._pace = launches.Pace()
        self._totals = device.totals(self._there.film)

    @property
    def samples(self) -> int:
        """Samples per pixel that are complete."""
        return int(self._totals.least)

    @property
    def error(self) -> ImageError:
        """Estimated error, from sums that the device makes."""
        return error_of(self._totals, self._blank.mean.size)

    def advance(
        self, rules: StopRules, progress: Callable[[Progress], object] | None = None
    ) -> str:
        """Add samples until a rule is met, and say which."""
        known = self._blank._replace(count=np.full(self._blank.count.shape, self.samples, np.int64))
        work = launches.DeviceRun(
            self.device, self._there, self._scene, known, rules, self.seed, progress, None,
            self._pace,
        )  # fmt: skip
        stopped_by = work.run(None)
        self._totals = self.device.totals(self._there.film)
        self.seconds += time.perf_counter() - work.start
        return stopped_by

    def shown(self, display: Display) -> NDArray[np.uint8]:
        """Display picture, (H, W, 4): as many bytes are copied, and no film."""
        pixels: NDArray[np.uint8] = self.device.shown(self._there.film, packed_screen(display))
        return pixels

    def film(self) -> packed.Film:
        """Film with all samples so far, on the host."""
        film: packed.Film = self.device.download(self._there.film)
        return film
