"""Display picture and error of a film on the device: those of the CPU, and their time."""

import time

import numpy as np
from agreement import SINGLE
from speed import SIZE, planned, volumes

from vtkmcvr.accuracy import image_error
from vtkmcvr.film import moments
from vtkmcvr.gpu.device import CudaDevice
from vtkmcvr.gpu.progressive import DevicePicture
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.schedule import StopRules
from vtkmcvr.screen import Display, shown

DISPLAYS = {
    "plain": Display(2.5),
    "film filter, on white": Display(2.5, background=(1, 1, 1), film_filter="gaussian-5x5"),
}
REPEATS = 9


def refined(work, samples):
    picture = DevicePicture(CudaDevice(), work.packed, empty_film(work), 1)
    picture.advance(StopRules(samples, None, None))
    return picture


def alike(described):
    """Bytes to one level, errors to roundings."""
    picture = refined(plan(described), 64)
    film = picture.film()
    radiance, alpha = film.mean.astype(np.float32), moments.alpha(film)
    apart = {
        name: int(
            np.abs(picture.shown(display) - shown(radiance, alpha, display).astype(int)).max()
        )
        for name, display in DISPLAYS.items()
    }
    error = abs(picture.error.nrms / image_error(film).nrms - 1)
    return {
        "levels_apart": apart,
        "error_apart": error,
        "passed": max(apart.values()) <= 1 and error < 1e-9,
    }


def film_on_device():
    """Agreement; milliseconds of what is shown, of the error, and of copying the film."""
    large = refined(planned(next(iter(volumes().values()))), 4)
    steps = {name: lambda d=display: large.shown(d) for name, display in DISPLAYS.items()}
    steps |= {"error": lambda: large.advance(StopRules(4, None, None)), "film": large.film}
    times = {name: 1e3 * fastest(step) for name, step in steps.items()}
    return {"size": list(SIZE), "milliseconds": times, **alike(SINGLE)}


def fastest(step):
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        step()
        times.append(time.perf_counter() - start)
    return min(times)
