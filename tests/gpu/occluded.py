"""Directional occlusion and noise reduction on CUDA: agreement with the CPU, same bits, speed."""

import math
import time

import numpy as np
from agreement import SINGLE
from scenes import blob, everything, medium, scene
from speed import volumes

from vtkmcvr import scene_of
from vtkmcvr.cutting import Plane
from vtkmcvr.gpu import sweeps
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.occlusion.rendering import layout, parts_of
from vtkmcvr.occlusion.tables import blocks_in, tables_of
from vtkmcvr.pictures import denoise
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Camera, Surface, Volume

NEAR = Camera((0, -5, 0), (0, 0, 0), view_angle=22)
GOLD = medium(6.0, (0.9, 0.6, 0.3))
PLAIN = scene(blob(), GOLD, NEAR, size=(96, 72))
MODES = {
    "default": Occlusion(),
    "default, coloured": Occlusion(bleeding=0.7, toward_light=(0.5, -1, 0.5)),
    "fast": Occlusion(mode="fast"),
    "paper": Occlusion(mode="paper"),
    "paper, exact distances": Occlusion(mode="paper", exact_distance=True),
}
# Of pictures whose arithmetic differs by roundings and by elementary functions; a wrong pixel or
# layer gives a hundred times more
MOST_ERROR = 1e-4
FRAMES = 9
SIZE, SLICES = (512, 512), 679
CONES = {
    "narrow": Occlusion(half_angle=20.0, slices=SLICES),
    "wide": Occlusion(half_angle=80.0, slices=SLICES),
    "fast": Occlusion(mode="fast", slices=SLICES),
    "paper, 7x7": Occlusion(mode="paper", grid=7, slices=SLICES),
    "paper, 13x13": Occlusion(mode="paper", grid=13, half_angle=80.0, slices=SLICES),
}


def alike(described, settings):
    """RMS difference of both backends' radiance over the RMS radiance, and whether it is small."""
    cuda = render_occlusion(described, settings, backend="cuda")
    cpu = render_occlusion(described, settings, backend="cpu")
    scale = math.sqrt(float(np.mean(cpu.radiance**2)))
    apart = np.abs(cuda.radiance - cpu.radiance)
    error = math.sqrt(float(np.mean(apart**2))) / scale
    opacity = float(np.abs(cuda.alpha - cpu.alpha).max())
    return {
        "nrms": error,
        "largest": float(apart.max()) / scale,
        "largest_of_opacity": opacity,
        "passed": bool(error < MOST_ERROR and opacity < 1e-3),
    }


def all_alike(cases):
    found = {name: alike(*case) for name, case in cases.items()}
    return {"cases": found, "passed": all(case["passed"] for case in found.values())}


def agreement():
    """All modes; and cuts, shading, albedo and normal, two kinds of voxels."""
    voxels = Volume((255 * blob().values).astype(np.uint8), blob().index_to_world)
    cut = scene(
        voxels, medium(0.02), NEAR, size=PLAIN.size, aovs=("albedo", "normal"),
        surface=Surface(0.9), clip=(Plane((0, 0, 0), (1, 0, 0)),),
        lights=(ConstantEnvironment(1.0),),
    )  # fmt: skip
    cases = {name: (PLAIN, settings) for name, settings in MODES.items()}
    return all_alike({**cases, "cut and shaded": (cut, Occlusion(shaded=True))})


def hard_cases():
    holed = blob().values.copy()
    holed[4:7, 8, 8] = np.nan
    cases = {
        "a million units away": scene(blob(centre=(1e6, -1e6, 1e6)), GOLD, size=PLAIN.size),
        "missing data": scene(Volume(holed, blob().index_to_world), GOLD, NEAR, size=PLAIN.size),
        "extinction 1e12": scene(blob(), medium(1e12), NEAR, size=PLAIN.size),
        "extinction 1e-30": scene(blob(), medium(1e-30), NEAR, size=PLAIN.size),
        "the eye inside": scene(
            blob(), medium(1.0), Camera((0, 0, 0), (0, 1, 0), view_angle=60), size=PLAIN.size
        ),
    }
    return all_alike({name: (case, Occlusion()) for name, case in cases.items()})


def same_bits():
    """The same bits from run to run, for any number of blocks in a launch."""
    found = {}
    for name, settings in MODES.items():
        first = render_occlusion(PLAIN, settings, backend="cuda")
        usual = sweeps.LAUNCH_SECONDS
        try:
            sweeps.LAUNCH_SECONDS = 0.0
            second = render_occlusion(PLAIN, settings, backend="cuda")
        finally:
            sweeps.LAUNCH_SECONDS = usual
        found[name] = all(np.array_equal(second.planes[k], v) for k, v in first.planes.items())
    return {"modes": found, "passed": all(found.values())}


def throughput():
    """Frames a second of layers on the device already, and seconds of whole pictures."""
    found = {}
    for name, volume in volumes().items():
        described = scene_of(volume, size=SIZE).scene
        found[name] = {cone: timed(described, settings) for cone, settings in CONES.items()}
    return {
        "volumes": found,
        "wanted": {"frames_per_second, narrow": 500, "wide over narrow": 1.5},
    }


def timed(described, settings):
    """One cone: a frame goes from blank arrays to the film, all on the device."""
    planned, raster, _ = layout(described, settings)
    parts = parts_of(described, planned, raster, settings)
    tables, blocks = tables_of(*parts), blocks_in(raster)
    device = sweeps.SweepDevice()
    there = device.upload(tables)
    device.compile(there)
    times = []
    for _ in range(FRAMES):
        fresh = there._replace(light=device.upload(tables.light))
        start = time.perf_counter()
        eye, film, sheets = device.upload((tables.eye, tables.film, tables.sheets))
        ticket = device.sweep(fresh._replace(eye=eye, film=film, sheets=sheets), 0, blocks)
        while not device.finished(ticket):
            pass
        times.append(time.perf_counter() - start)
    picture = render_occlusion(described, settings, backend="cuda")
    return {
        "raster": [raster.columns, raster.rows, raster.count],
        "frames_per_second": 1 / float(np.median(times)),
        "seconds": {"least": min(times), "most": max(times)},
        "picture_seconds": picture.seconds,
        "looked_up": picture.work.looked_up,
        "seen": picture.work.seen,
        "kernel": resources(device.kernel),
    }


def resources(kernel):
    return [
        {"registers": made.regs_per_thread, "local_bytes": made.local_mem_per_thread}
        for made in kernel.overloads.values()
    ]


def denoising():
    """KNN on the device against that of the CPU, and its seconds for 800 x 600."""
    picture = render_scene(SINGLE, samples=4, seed=1, backend="cuda")
    planes = picture.radiance, picture.alpha, picture.standard_error, 0.0
    light, coverage = denoise.knn(*planes, backend="cuda")
    expected, expected_coverage = denoise.knn(*planes, backend="cpu")
    apart = max(
        float(np.abs(light - expected).max()), float(np.abs(coverage - expected_coverage).max())
    )
    large = render_scene(everything(size=(800, 600)), samples=1, seed=1, backend="cuda")
    seconds = []
    for _ in range(FRAMES):
        start = time.perf_counter()
        denoise.knn(large.radiance, large.alpha, large.standard_error, 0.0, backend="cuda")
        seconds.append(time.perf_counter() - start)
    return {"largest": apart, "seconds": min(seconds), "passed": apart < 1e-4}
