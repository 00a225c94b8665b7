"""What has to give one picture on a device however it is held there: bricks, live pictures."""

import math
import threading

import numpy as np
from agreement import SINGLE, SIZE
from scenes import everything, volume

from vtkmcvr.gpu import launches
from vtkmcvr.gpu.bricks import bricked
from vtkmcvr.gpu.device import CudaDevice
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.live.job import Job
from vtkmcvr.live.preview import Preview
from vtkmcvr.live.settings import LiveSettings
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.schedule import StopRules

SAMPLES, SEED = 64, 3
# Kernels that read the same values are compiled apart: roundings may decide otherwise in a path
LEAST_ALIKE = 0.98


def shell(points=160):
    """A hollow ball, which few bricks hold, seen from near by."""
    lines = np.linspace(-1, 1, points)
    away = np.sqrt(lines[:, None, None] ** 2 + lines[:, None] ** 2 + lines**2)
    values = np.clip(1 - 8 * np.abs(away - 0.4), 0, 1).astype(np.float32)
    return volume(values, (2 / (points - 1),) * 3)


def film_of(packed, planned):
    rules = StopRules(SAMPLES, None, None)
    return launches.run(CudaDevice(), packed, empty_film(planned), rules, SEED)[0]


def bricks():
    """A volume in bricks against the whole one, and the rate of each."""
    planned = plan(everything(ConstantEnvironment(0.5), vol=shell(), size=SIZE))
    less = bricked(planned.packed)
    whole, found = (film_of(packed, planned) for packed in (planned.packed, less))
    scale = math.sqrt(float(np.mean(whole.mean**2)))
    alike = float((np.abs(found.mean - whole.mean).max(-1) < 1e-4 * scale).mean())
    return {
        "bytes_of_voxels": [planned.packed.medium.values.nbytes, less.medium.values.voxels.nbytes],
        "pixels_alike": alike,
        "same_bits": bool(np.array_equal(found.mean, whole.mean)),
        "passed": alike > LEAST_ALIKE,
    }


def live():
    """A live picture, refined by a thread while another one makes previews, and that of the CPU."""
    planned = plan(SINGLE)
    jobs = {
        backend: Job(planned, LiveSettings(samples=SAMPLES, seed=SEED, backend=backend))
        for backend in ("cuda", "cpu")
    }
    thread = threading.Thread(target=jobs["cuda"].finish)
    thread.start()
    previews = [Preview().estimate(planned, jobs["cuda"].settings) for _ in range(5)]
    thread.join()
    jobs["cpu"].finish()
    found, expected = (jobs[backend].newest.shown.pixels.astype(int) for backend in ("cuda", "cpu"))
    alike = float((np.abs(found - expected).max(-1) <= 1).mean())
    same = all(np.array_equal(p.shown.pixels, previews[0].shown.pixels) for p in previews)
    return {
        "pixels_alike": alike,
        "previews_alike": same,
        "passed": alike > LEAST_ALIKE and same and bool(previews[0].shown.pixels.any()),
    }
