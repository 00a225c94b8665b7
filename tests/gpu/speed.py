"""How fast, as in Table 1 of Exposure Render: 800 x 600, a sky and two area lights."""

import math
import time

import numpy as np
import pyvista
from real_volumes import DATA

from vtkmcvr import head_phantom, scene_of
from vtkmcvr.gpu import launches
from vtkmcvr.gpu.device import CudaDevice
from vtkmcvr.plan import plan
from vtkmcvr.readers import read_vtk
from vtkmcvr.rendering import empty_film
from vtkmcvr.schedule import StopRules

SIZE = (800, 600)
FILES = {"engine": "scivis/engine.nhdr", "cthead": "scivis/cthead/CThead.nhdr"}
SECONDS, REPEATS = 4.0, 3
ERRORS = {"10 %": 0.1, "1 %": 0.01}


def volumes():
    """Engine and head of the collection in VTKMCVR_DATA, or the synthetic head."""
    found = {name: DATA / file for name, file in FILES.items() if (DATA / file).exists()}
    if not found:
        return {"synthetic head, the collection is absent": image_of(head_phantom(192))}
    return {name: read_vtk(str(path)) for name, path in found.items()}


def image_of(head):
    """vtkImageData of the synthetic head."""
    image = pyvista.ImageData(
        dimensions=head.values.shape[::-1], spacing=head.spacing, origin=head.origin
    )
    image["values"] = head.values.ravel()
    return image


def planned(volume):
    # A studio has a constant environment and two area lights; surfaces are hybrid
    return plan(scene_of(volume, size=SIZE).scene)


def throughput():
    """Paths and estimates (one path for each pixel) a second, and what the kernel takes."""
    found = {}
    for name, volume in volumes().items():
        work = planned(volume)
        rates = []
        for seed in range(REPEATS):
            rules = StopRules(None, SECONDS, None)
            film, _, seconds = launches.run(
                CudaDevice(), work.packed, empty_film(work), rules, seed
            )
            rates.append(int(film.count.sum()) / seconds)
        rate = float(np.median(rates))
        found[name] = {
            "paths_per_second": rate,
            "estimates_per_second": rate / (SIZE[0] * SIZE[1]),
            "spread": (max(rates) - min(rates)) / rate,
        }
    return {"volumes": found, "kernel": resources(), "wanted_estimates_per_second": 3000}


def resources():
    """Registers and local memory of a thread, of every kernel that was compiled so far."""
    from vtkmcvr.kernels.cuda import render_rows

    return [
        {"registers": kernel.regs_per_thread, "local_bytes": kernel.local_mem_per_thread}
        for kernel in render_rows.overloads.values()
    ]


def time_to_error():
    """Milliseconds of the samples that an error takes, from launch to end.

    The error is the film's own estimate, from a run of 256 samples; variance falls as 1 / samples.
    """
    found = {}
    for name, volume in volumes().items():
        work = planned(volume)
        error = error_of(work, 256)
        found[name] = {}
        for words, target in ERRORS.items():
            samples = max(1, math.ceil(256 * (error / target) ** 2))
            found[name][words] = {"samples": samples, "milliseconds": 1e3 * fastest(work, samples)}
    return {"volumes": found, "wanted_milliseconds": {"10 %": 10, "1 %": 1000}}


def error_of(work, samples):
    from vtkmcvr.accuracy import image_error

    rules = StopRules(samples, None, None)
    film, _, _ = launches.run(CudaDevice(), work.packed, empty_film(work), rules, 0)
    return image_error(film).nrms


def fastest(work, samples, repeats=5):
    """Seconds of so many samples in one launch, scene and film on the device already."""
    device = CudaDevice()
    scene = device.upload(work.packed)
    goal = device.upload(np.full(SIZE[::-1], samples, np.int64))
    times = []
    for seed in range(repeats):
        film = device.upload(empty_film(work))
        device.compile(film, scene, goal, seed)
        start = time.perf_counter()
        ticket = device.launch(film, scene, (0, SIZE[1]), goal, samples, seed)
        while not device.finished(ticket):
            pass
        times.append(time.perf_counter() - start)
    return min(times)
