"""Where a live picture gets its samples: on the CPU, or on a CUDA device that keeps its film."""

from __future__ import annotations

import functools
import logging
import threading
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import packed, schedule
from ..accuracy import image_error
from ..gpu.available import missing
from ..gpu.errors import CudaError, CudaUnavailable
from ..plan import Plan
from ..rendering import empty_film
from ..schedule import StopRules
from ..screen import Display
from ..sight import nothing_seen
from .settings import LiveSettings
from .shown import Edges, Shown, picture_of

logger = logging.getLogger("vtkmcvr")


class Look(NamedTuple):
    """How a film becomes bytes; see `picture_of`."""

    exposure: float
    edges: Edges | None = None
    veiled: NDArray[np.bool_] | None = None


class HostWork:
    """A film on the host, and samples by the CPU."""

    device_name = ""

    def __init__(self, planned: Plan, settings: LiveSettings) -> None:
        self.plan, self.settings = planned, settings
        self._film: packed.Film | None = None
        self._making = threading.Lock()

    @property
    def film(self) -> packed.Film:
        """Film so far. It is made when it is first asked for: by the refiner, not in an event."""
        with self._making:
            if self._film is None:
                self._film = empty_film(self.plan)
            return self._film

    @property
    def samples(self) -> int:
        """Samples per pixel so far."""
        return 0 if self._film is None else int(self._film.count.min())

    def advance(self, rules: StopRules) -> tuple[str, float]:
        """Add samples until a rule is met. Returns (which, seconds of rendering)."""
        threads = self.settings.threads or schedule.default_threads()
        return schedule.run(self.plan.packed, self.film, rules, self.settings.seed, threads)

    def shown(self, look: Look) -> Shown:
        """Display picture."""
        return picture_of(self.film, *look)

    @property
    def error(self) -> float:
        """Estimated NRMS."""
        return image_error(self.film).nrms


class DeviceWork:
    """The same on a CUDA device: what is shown is copied from it, and no film.

    Where CUDA was not asked for by name and fails, the CPU begins anew, with a line in the log, and
    so it does from then on.
    """

    given_up = False

    def __init__(self, planned: Plan, settings: LiveSettings) -> None:
        self.plan, self.settings = planned, settings
        self._picture: Any = None
        self._instead: HostWork | None = None

    @property
    def samples(self) -> int:
        """Samples per pixel so far."""
        work = self._instead or self._picture
        return 0 if work is None else work.samples

    @property
    def device_name(self) -> str:
        """As the driver calls the device; "" where the CPU has taken over."""
        return "" if self._instead is not None else str(device().name)

    @property
    def film(self) -> packed.Film:
        """Film so far, copied from the device."""
        if self._instead is not None:
            return self._instead.film
        film: packed.Film = empty_film(self.plan) if self._picture is None else self._picture.film()
        return film

    def advance(self, rules: StopRules) -> tuple[str, float]:
        """Add samples until a rule is met. Returns (which, seconds of rendering)."""
        if self._instead is None:
            try:
                return self._on_device(rules)
            except CudaError as error:
                if self.settings.backend == "cuda":
                    raise
                logger.warning("live pictures are rendered on the CPU: %s", error)
                DeviceWork.given_up = True
                self._instead = HostWork(self.plan, self.settings)
        return self._instead.advance(rules)

    def _on_device(self, rules: StopRules) -> tuple[str, float]:
        from ..gpu.progressive import DevicePicture

        if self._picture is None:
            self._picture = DevicePicture(
                device(), self.plan.packed, empty_film(self.plan), self.settings.seed
            )
        before = self._picture.seconds
        return self._picture.advance(rules), self._picture.seconds - before

    def shown(self, look: Look) -> Shown:
        """Display picture; what is seen behind a mesh takes the whole film."""
        if self._instead is not None:
            return self._instead.shown(look)
        if self.plan.packed.backdrop is not None:
            return picture_of(self.film, *look)
        return Shown(self._picture.shown(Display(look.exposure)))

    @property
    def error(self) -> float:
        """Estimated NRMS."""
        if self._instead is not None:
            return self._instead.error
        return float(self._picture.error.nrms)


@functools.cache
def device() -> Any:
    """Return the device that all live pictures share."""
    from ..gpu.kept import KeptDevice

    return KeptDevice()


def on_device(planned: Plan, settings: LiveSettings) -> bool:
    """Whether samples are to come from a device.

    Raises
    ------
    CudaUnavailable
        Where "cuda" was asked for by name and cannot be used.
    """
    if settings.backend == "cpu":
        return False
    absent = missing()
    if settings.backend == "cuda":
        if absent is not None:
            raise CudaUnavailable(absent)
        return True
    return absent is None and not DeviceWork.given_up and not nothing_seen(planned.packed)


def work_of(planned: Plan, settings: LiveSettings) -> HostWork | DeviceWork:
    """Work on a picture, still without samples."""
    return (DeviceWork if on_device(planned, settings) else HostWork)(planned, settings)
