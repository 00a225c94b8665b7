"""Error against time: a render that pauses at 1, 2, 4 ... samples, compared with a reference."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..accuracy import image_error
from ..pictures.picture import Picture
from ..plan import Plan
from ..rendering import render_scene
from ..schedule import default_threads

Z95 = 1.959964
# Seeds of references and of what is compared with them: never the same paths
REFERENCE_SEED, LADDER_SEED = 0x7265666572, 1


@dataclass(frozen=True)
class Point:
    """A picture on the way.

    Attributes
    ----------
    samples : int
    seconds : float
        Time of rendering up to here, compilation not counted.
    estimated : float or None
        NRMS by the picture's own variance; None where it has none.
    measured : float
        RMS difference from the reference over the RMS of the reference, the reference's own noise
        taken off.
    spread : float
        95 % half width of `measured`.
    cpu_seconds : float
        Processor time of the process over the number of threads: what `seconds` are on a machine
        without other work.
    low, high : float or None
        95 % interval of `estimated`; None where it is open.
    """

    samples: int
    seconds: float
    estimated: float | None
    measured: float
    spread: float
    cpu_seconds: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, eq=False)
class Reference:
    """Long render, the stand-in for the truth.

    Attributes
    ----------
    radiance : array (H, W, 3)
    variance : array (H, W, 3)
        Of each pixel's mean, estimated without bias; by itself it may be a poor estimate.
    samples : int
    seconds : float
        Of the processor, over the number of threads.
    """

    radiance: NDArray[np.float64]
    variance: NDArray[np.float64]
    samples: int
    seconds: float

    @property
    def power(self) -> float:
        """Mean square of the true radiance."""
        return float(np.mean(self.radiance**2) - np.mean(self.variance))

    @property
    def nrms(self) -> float:
        """Error of the reference itself."""
        noise = float(np.mean(self.variance))
        return math.sqrt(noise / self.power) if self.power > 0 else math.inf

    def facts(self) -> dict[str, Any]:
        """Samples, seconds and error, as plain JSON values."""
        nrms = self.nrms if math.isfinite(self.nrms) else None
        return {"samples": self.samples, "seconds": self.seconds, "nrms": nrms}

    def error(self, radiance: NDArray) -> tuple[float, float]:
        """NRMS of a picture that is independent of the reference, and its 95 % half width.

        The mean square difference contains the reference's noise, which is taken off. Pixels are
        independent, so the spread of their square differences gives the half width.
        """
        excess = ((radiance - self.radiance) ** 2 - self.variance).mean(-1)
        mean = float(excess.mean())
        spread = Z95 * float(excess.std()) / math.sqrt(excess.size)
        if self.power <= 0:
            return math.inf, math.inf
        nrms = math.sqrt(max(mean, 0.0) / self.power)
        high = math.sqrt(max(mean + spread, 0.0) / self.power)
        return nrms, high - nrms


def make_reference(
    plan: Plan,
    seconds: float,
    threads: int | None,
    abort: Callable[[], bool] | None = None,
    *,
    least: int = 2,
) -> Reference:
    """Render for a time, but no less than `least` samples, with seeds of its own.

    It is the mean of two independent pictures, whose square difference over four tells its noise
    without bias from the first sample on; that of a single film is an upper estimate below two
    batches of Sobol points.
    """
    threads = threads or default_threads()
    # Compiles, too
    half = max(1, least // 2)
    first = render_scene(plan, samples=1, seed=REFERENCE_SEED, threads=threads)
    start = time.process_time()
    first = first.refine(samples=2**20, seconds=seconds / 2, abort=abort)
    if first.samples < half:
        first = first.refine(samples=half, abort=abort)
    second = render_scene(plan, samples=first.samples, seed=REFERENCE_SEED + 1, threads=threads)
    a, b = first.film.mean, second.film.mean
    spent = (time.process_time() - start) / threads
    return Reference((a + b) / 2, (a - b) ** 2 / 4, first.samples + second.samples, spent)


def climb(
    plan: Plan,
    reference: Reference,
    seconds: float,
    threads: int | None,
    *,
    finish: Callable[[Picture], NDArray] | None = None,
    adaptive: bool = False,
    least: int = 1,
    most: int = 2**20,
) -> tuple[list[Point], NDArray]:
    """Points at 1, 2, 4 ... samples until the time is over, and the last radiance.

    There are `least` samples or more, whatever time they take, and no more than `most`.

    `finish` makes another radiance of each picture, such as a denoised one; its time is counted.
    """
    threads = threads or default_threads()
    render_scene(plan, samples=1, seed=LADDER_SEED, threads=threads)
    start = time.process_time()
    picture = render_scene(plan, samples=1, seed=LADDER_SEED, threads=threads, adaptive=adaptive)
    spent = (time.process_time() - start) / threads
    point, radiance = _point(picture, reference, finish, spent, threads)
    points = [point]
    while picture.samples < most and (picture.samples < least or 2 * picture.seconds < seconds):
        start = time.process_time()
        picture = picture.refine(samples=2 * picture.samples)
        spent += (time.process_time() - start) / threads
        point, radiance = _point(picture, reference, finish, spent, threads)
        points.append(point)
    return points, radiance


def _point(
    picture: Picture,
    reference: Reference,
    finish: Callable[[Picture], NDArray] | None,
    cpu_seconds: float,
    threads: int,
) -> tuple[Point, NDArray]:
    seconds, radiance = picture.seconds, picture.film.mean
    if finish is not None:
        start, start_cpu = time.perf_counter(), time.process_time()
        radiance = finish(picture)
        seconds += time.perf_counter() - start
        cpu_seconds += (time.process_time() - start_cpu) / threads
    measured, spread = reference.error(radiance)
    known: tuple[float | None, ...] = (None, None, None)
    if finish is None:
        error = image_error(picture.film)
        known = tuple(x if math.isfinite(x) else None for x in (error.nrms, error.low, error.high))
    nrms, low, high = known
    point = Point(picture.samples, seconds, nrms, measured, spread, cpu_seconds, low, high)
    return point, radiance


def plain(points: list[Point]) -> list[dict[str, Any]]:
    """As JSON values."""
    return [asdict(point) for point in points]
