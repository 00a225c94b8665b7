"""What a picture of a given error will cost, before it is paid: a short pilot tells."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from . import checks, packed, schedule
from .accuracy import image_error, samples_for
from .film_error import variance
from .plan import Plan, plan
from .rendering import empty_film
from .scene import Scene
from .schedule import StopRules

# Four batches of even samples: with less, how even they are can't be told
LEAST_SAMPLES = 4 * packed.BATCH
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
        Samples, size, seconds and NRMS of the pilot.
    """

    nrms: float
    samples: int | None
    low: int | None
    high: int | None
    seconds: float | None
    memory: int
    threads: int
    pilot: dict[str, Any]

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
        Time for the pilot, > 0. It takes 64 samples per pixel or more, of fewer and larger pixels
        where that would take longer.
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
    film = empty_film(planned)
    memory = sum(array.nbytes for array in _arrays((planned.packed, film)))
    film, spent = _pilot(planned, film, pilot_seconds, threads)
    error = image_error(film)
    pilot = {
        "samples": int(film.count.min()),
        "size": list(film.count.shape[::-1]),
        "seconds": spent,
        "nrms": error.nrms if math.isfinite(error.nrms) else None,
    }
    if not error.bright or not math.isfinite(error.nrms):
        return Estimate(nrms, None, None, None, None, memory, threads, pilot)
    count = _even_samples(film)
    samples, low, high = (
        max(1, math.ceil(samples_for(e, count, nrms))) if math.isfinite(e) else None
        for e in (error.nrms, error.low, error.high)
    )
    width, height = planned.scene.size
    pixels = width * height / film.count.size
    each = spent / float(film.count.mean())
    seconds = samples_for(error.nrms, count, nrms) * pixels * each
    return Estimate(nrms, samples, low, high, seconds, memory, threads, pilot)


def _even_samples(film: packed.Film) -> float:
    """Samples per pixel that, spread evenly, have the error of a film whose last pass was cut off.

    Variances v of the means of n samples are those of v n / m with m samples.
    """
    v = variance(film).sum(-1)
    return float((v * film.count).sum() / v.sum()) if v.any() else float(film.count.mean())


def _pilot(
    planned: Plan, film: packed.Film, seconds: float, threads: int
) -> tuple[packed.Film, float]:
    """Render for a time, in fewer pixels where so many samples would take longer."""
    once = StopRules(1, None, None)
    _, spent = schedule.run(planned.packed, film, once, PILOT_SEED, threads)
    shrink = math.sqrt(LEAST_SAMPLES * spent / seconds)
    if shrink > 1:
        width, height = planned.scene.size
        size = max(1, round(width / shrink)), max(1, round(height / shrink))
        planned = plan(replace(planned.scene, size=size))
    film = empty_film(planned)
    spent = 0.0
    for rules in (StopRules(LEAST_SAMPLES, None, None), StopRules(None, seconds, None)):
        if spent < seconds:
            _, more = schedule.run(planned.packed, film, rules, PILOT_SEED, threads)
            spent += more
    return film, spent


def _arrays(part: object) -> Iterator[np.ndarray]:
    """All arrays of a packed tuple."""
    if isinstance(part, np.ndarray):
        yield part
    elif isinstance(part, tuple):
        for inner in part:
            yield from _arrays(inner)
