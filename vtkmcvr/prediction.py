"""What a picture of a given error will cost, before it is paid: a short pilot tells."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from . import checks, schedule
from .accuracy import image_error, samples_for
from .film import new_film
from .plan import Plan, plan
from .scene import Scene
from .schedule import StopRules

# Below this many samples a variance is a guess
LEAST_SAMPLES = 16
# The pilot's seed, so that it shares no random number with the picture that follows
PILOT_SEED = 0x70696C6F74


@dataclass(frozen=True)
class Estimate:
    """Predicted cost of a picture.

    Attributes
    ----------
    nrms : float
        Target error.
    samples : int or None
        Samples per pixel that reach it; None: the pilot saw no light, so nothing can be said.
    low, high : int or None
        95 % interval of the samples.
    seconds : float or None
        Rendering time on `threads` threads, compilation not counted.
    memory : int
        Bytes of volume, tables and film while rendering.
    pilot : dict
        Samples, seconds and NRMS of the pilot.
    """

    nrms: float
    samples: int | None
    low: int | None
    high: int | None
    seconds: float | None
    memory: int
    threads: int
    pilot: dict[str, float | int | None]

    def facts(self) -> dict[str, Any]:
        """As plain JSON values."""
        return asdict(self)

    def __str__(self) -> str:
        memory = f"{self.memory / 2**20:.0f} MiB"
        if self.samples is None:
            return f"error {self.nrms:.2%}: the pilot saw no light, nothing to predict; {memory}"
        return (
            f"error {self.nrms:.2%}: about {self.samples} samples per pixel ({self.low} to "
            f"{self.high}), {self.seconds:.1f} s on {self.threads} threads, {memory}"
        )


def estimate(
    scene: Scene | Plan,
    nrms: float = 0.01,
    *,
    pilot_seconds: float = 2.0,
    threads: int | None = None,
) -> Estimate:
    """Predict samples, seconds and memory to reach an error, by a short pilot render.

    Parameters
    ----------
    scene : Scene or Plan
    nrms : float
        Target error, > 0.
    pilot_seconds : float
        Time for the pilot, > 0; it takes at least 16 samples per pixel.
    threads : int, optional
        Default: all CPUs that the process may use.

    Returns
    -------
    Estimate
    """
    checks.number("nrms", nrms, above=0.0)
    checks.number("pilot_seconds", pilot_seconds, above=0.0)
    threads = schedule.default_threads() if threads is None else threads
    checks.whole("threads", threads, least=1)
    planned = scene if isinstance(scene, Plan) else plan(scene)
    film = new_film(*planned.scene.size)
    spent = 0.0
    for rules in (StopRules(LEAST_SAMPLES, None, None), StopRules(None, pilot_seconds, None)):
        if spent < pilot_seconds:
            _, seconds = schedule.run(planned.packed, film, rules, PILOT_SEED, threads)
            spent += seconds
    error = image_error(film)
    count = float(film.count.mean())
    memory = sum(array.nbytes for array in _arrays((planned.packed, film)))
    pilot = {"samples": int(count), "seconds": spent, "nrms": _finite(error.nrms)}
    if not error.bright or not math.isfinite(error.nrms):
        return Estimate(nrms, None, None, None, None, memory, threads, pilot)
    samples, low, high = (
        max(1, math.ceil(samples_for(e, count, nrms))) if math.isfinite(e) else None
        for e in (error.nrms, error.low, error.high)
    )
    seconds = samples_for(error.nrms, count, nrms) * spent / count
    return Estimate(nrms, samples, low, high, seconds, memory, threads, pilot)


def _finite(x: float) -> float | None:
    return x if math.isfinite(x) else None


def _arrays(part: object) -> Iterator[np.ndarray]:
    """All arrays of a packed tuple."""
    if isinstance(part, np.ndarray):
        yield part
    elif isinstance(part, tuple):
        for inner in part:
            yield from _arrays(inner)
