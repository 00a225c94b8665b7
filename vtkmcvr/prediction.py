"""What a picture of a given error will cost, before it is paid: a short pilot tells."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import checks, packed, schedule
from .accuracy import image_error, samples_for
from .adaptive import QUARTERS
from .film.error import variance
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
        Samples, pixels, seconds and NRMS of the pilot.
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
        Time for the pilot, > 0. It takes 64 samples per pixel or more, of fewer pixels where all of
        them would take longer.
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
    memory = sum(array.nbytes for array in _arrays((planned.packed, empty_film(planned))))
    film, spent = _pilot(planned, pilot_seconds, threads)
    error = image_error(film)
    pilot = {
        "samples": int(film.count.min()),
        "pixels": film.count.size,
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


def _pilot(planned: Plan, seconds: float, threads: int) -> tuple[packed.Film, float]:
    """Render for a time: all pixels, or a part of them where `LEAST_SAMPLES` would take longer.

    Returns the film of these pixels in one row. They are as large as in the picture, so that what
    happens within a pixel is not judged by a larger one.
    """
    film = empty_film(planned)
    once = StopRules(1, None, None)
    _, spent = schedule.run(planned.packed, film, once, PILOT_SEED, threads)
    step = math.ceil(math.sqrt(LEAST_SAMPLES * spent / seconds))
    density = QUARTERS * _scattered(film.count.shape, max(step, 1))
    film = empty_film(planned)
    spent = 0.0
    for rules in (StopRules(LEAST_SAMPLES, None, None), StopRules(None, seconds, None)):
        if spent < seconds:
            _, more = schedule.run(
                planned.packed, film, rules, PILOT_SEED, threads, density=density
            )
            spent += more
    return _row_of(film, density > 0), spent


def _scattered(shape: tuple[int, ...], step: int) -> NDArray[np.int64]:
    """Ones in one random pixel of each square of `step` pixels a side, zeros elsewhere."""
    rng = np.random.default_rng(PILOT_SEED)
    first = np.meshgrid(*(np.arange(0, n, step) for n in shape), indexing="ij")
    places = (
        start + (rng.random(start.shape) * np.minimum(step, n - start)).astype(np.int64)
        for start, n in zip(first, shape, strict=True)
    )
    chosen = np.zeros(shape, np.int64)
    chosen[tuple(places)] = 1
    return chosen


def _row_of(part: Any, chosen: NDArray[np.bool_]) -> Any:
    """Film of the chosen pixels of a film, (1, n)."""
    if isinstance(part, tuple):
        return type(part)(*(_row_of(inner, chosen) for inner in part))
    return None if part is None else part[chosen][None]


def _arrays(part: object) -> Iterator[np.ndarray]:
    """All arrays of a packed tuple."""
    if isinstance(part, np.ndarray):
        yield part
    elif isinstance(part, tuple):
        for inner in part:
            yield from _arrays(inner)
