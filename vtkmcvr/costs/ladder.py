"""Error against time: a render that pauses at 1, 2, 4 ... samples, compared with a reference."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..film_error import variance
from ..picture import Picture
from ..plan import Plan
from ..rendering import render_scene

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
    """

    samples: int
    seconds: float
    estimated: float | None
    measured: float
    spread: float


@dataclass(frozen=True, eq=False)
class Reference:
    """Long render, the stand-in for the truth.

    Attributes
    ----------
    radiance : array (H, W, 3)
    variance : array (H, W, 3)
        Of each pixel's mean.
    samples : int
    seconds : float
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

    def error(self, radiance: NDArray) -> tuple[float, float]:
        """NRMS of a picture that is independent of the reference, and its 95 % half width.

        The mean square difference contains the reference's noise, which is taken off. Pixels are
        independent, so the spread of their square differences gives the half width.
        """
        square = ((radiance - self.radiance) ** 2).mean(-1)
        mean = float(square.mean()) - float(self.variance.mean())
        spread = Z95 * float(square.std()) / math.sqrt(square.size)
        if self.power <= 0:
            return math.inf, math.inf
        nrms = math.sqrt(max(mean, 0.0) / self.power)
        high = math.sqrt(max(mean + spread, 0.0) / self.power)
        return nrms, high - nrms


def make_reference(
    plan: Plan, seconds: float, threads: int | None, abort: Callable[[], bool] | None = None
) -> Reference:
    """Render for a time, with a seed of its own."""
    picture = render_scene(
        plan, samples=2**20, seconds=seconds, seed=REFERENCE_SEED, threads=threads, abort=abort
    )
    return Reference(picture.film.mean, variance(picture.film), picture.samples, picture.seconds)


def climb(
    plan: Plan,
    reference: Reference,
    seconds: float,
    threads: int | None,
    *,
    finish: Callable[[Picture], NDArray] | None = None,
    most: int = 2**20,
) -> list[Point]:
    """Points at 1, 2, 4 ... samples until the time is over.

    `finish` makes another radiance of each picture, such as a denoised one; its time is counted.
    """
    picture = render_scene(plan, samples=1, seed=LADDER_SEED, threads=threads)
    points = [_point(picture, reference, finish)]
    while picture.samples < most and 2 * picture.seconds < seconds:
        picture = picture.refine(samples=2 * picture.samples)
        points.append(_point(picture, reference, finish))
    return points


def _point(
    picture: Picture, reference: Reference, finish: Callable[[Picture], NDArray] | None
) -> Point:
    start = time.perf_counter()
    radiance = picture.film.mean if finish is None else finish(picture)
    seconds = picture.seconds + (0.0 if finish is None else time.perf_counter() - start)
    measured, spread = reference.error(radiance)
    known = finish is None and math.isfinite(picture.nrms)
    return Point(picture.samples, seconds, picture.nrms if known else None, measured, spread)


def plain(points: list[Point]) -> list[dict[str, Any]]:
    """As JSON values."""
    return [asdict(point) for point in points]
