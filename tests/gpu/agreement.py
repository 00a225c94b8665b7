"""CUDA pictures against those of the CPU."""

import math

import numpy as np
from scenes import blob, everything, medium, noise, scene, slab

from vtkmcvr.cutting import Plane, Sphere
from vtkmcvr.film import error as film_error
from vtkmcvr.gpu import launches
from vtkmcvr.layers import Layer
from vtkmcvr.lights import (
    ConstantEnvironment,
    CylinderLight,
    DirectionalLight,
    DiskLight,
    RectangleLight,
    SphereLight,
)
from vtkmcvr.receivers import PlaneReceiver, SphereReceiver
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Camera, Lens, Schlick, Surface, Volume

SIZE, SAMPLES = (96, 72), 512
SKY = (ConstantEnvironment(0.5),)
SINGLE = everything(
    DirectionalLight((1, 2, -1.5), 2.0), RectangleLight((2, -2, 2), (0, 0, 0), (1, 1), 3.0),
    ConstantEnvironment(0.3), size=SIZE,
)  # fmt: skip


def same_bits():
    """The same bits from run to run, whatever the size of launches; and after a continuation."""
    options = {"seed": 3, "backend": "cuda"}
    first = render_scene(SINGLE, samples=64, **options).film
    seconds, least = launches.LAUNCH_SECONDS, launches.LEAST_PATHS
    try:
        launches.LAUNCH_SECONDS, launches.LEAST_PATHS = 0.0, 1000
        second = render_scene(SINGLE, samples=64, **options).film
    finally:
        launches.LAUNCH_SECONDS, launches.LEAST_PATHS = seconds, least
    third = render_scene(SINGLE, samples=20, **options).refine(samples=64).film
    return {"passed": equal(first, second) and equal(first, third)}


def equal(film, other):
    return all(
        equal(a, b) if isinstance(a, tuple) else a is b or np.array_equal(a, b)
        for a, b in zip(film, other, strict=True)
    )


def compared(described):
    """Difference of both backends: with one seed, and in standard errors with two seeds.

    With two seeds the pictures are independent. Their mean radiances differ by less than 4 standard
    errors in all but 6 of 100 000 runs; the share of pixels within 1.96 of their pooled standard
    errors is 95 % on average, and falls below 90 % where one of the two is biased or mixed up.
    """
    cuda = render_scene(described, samples=SAMPLES, seed=1, backend="cuda")
    cpu = render_scene(described, samples=SAMPLES, seed=1, backend="cpu")
    other = render_scene(described, samples=SAMPLES, seed=2, backend="cpu")
    scale = math.sqrt(float(np.mean(cpu.film.mean**2)))
    apart = np.abs(cuda.film.mean - cpu.film.mean).max(-1) / scale
    z_mean, covered = in_standard_errors(cuda.film, other.film)
    return {
        "pixels_alike_with_one_seed": float((apart < 1e-4).mean()),
        "z_of_the_mean_radiance": z_mean,
        "pixels_within_1.96_standard_errors": covered,
        "rejected": cuda.rejected_samples,
        "passed": bool(abs(z_mean) < 4 and covered > 0.9 and cuda.rejected_samples == 0),
    }


def in_standard_errors(film, other):
    """Difference of the mean radiances, and share of pixels within 1.96, in standard errors."""
    spread = film_error.variance(film)[..., 1].sum() + film_error.variance(other)[..., 1].sum()
    difference = film.mean[..., 1] - other.mean[..., 1]
    smooth = film_error.smooth_variance(film)[..., 1] + film_error.smooth_variance(other)[..., 1]
    lit = smooth > 0
    within = np.abs(difference[lit]) <= 1.96 * np.sqrt(smooth[lit])
    z = float(difference.sum() / math.sqrt(spread)) if spread > 0 else 0.0
    return z, float(within.mean()) if lit.any() else 1.0


def single():
    return compared(SINGLE)


def multiple():
    return compared(everything(ConstantEnvironment(0.5), scattering="multiple", size=SIZE))


def area_lights():
    lights = (
        RectangleLight((0, -1.2, 0), (0, 0, 0), (1, 1), 9.0), SphereLight((0, -1, 2), 0.3, 9.0),
        DiskLight((2, -2, 2), (0, 0, 0), 1.0, 2.0), CylinderLight((2, 2, 2), (2, 2, 3), 0.2, 2.0),
    )  # fmt: skip
    return compared(
        scene(
            blob(), medium(9.0), phase=Schlick(-0.5), surface=Surface(0.9, coat="ggx"),
            lights=lights, size=SIZE,
        )
    )  # fmt: skip


def cuts():
    """Lens, clip shapes, receivers, a second volume, bytes."""
    volume = Volume((255 * blob().values).astype(np.uint8), blob().index_to_world)
    return compared(
        scene(
            volume, medium(0.01), lights=SKY, aovs=("albedo", "normal"), surface=Surface(0.9),
            camera=Camera((0, -5, 0), (0, 0, 0), view_angle=20, lens=Lens(0.1)),
            clip=(Plane((0, 0, 0), (1, 0, 0)), Sphere((0, 0, 0), 0.8)),
            receivers=(PlaneReceiver((0, 0, -1), (0, 0, 1)), SphereReceiver((0, 0, 2), 0.5)),
            layers=(Layer(noise(5), medium(1.0)),), size=SIZE,
        )
    )  # fmt: skip


def march():
    return compared(scene(lights=SKY, estimator="ray-march", size=SIZE))


def hard_cases():
    """Far from the origin, missing data, opaque to the limit, faint, very bright."""
    holed = blob().values.copy()
    holed[4:7, 8, 8] = np.nan
    cases = {
        "a million units away": scene(blob(centre=(1e6, -1e6, 1e6)), lights=SKY, size=SIZE),
        "missing data": scene(Volume(holed, blob().index_to_world), lights=SKY, size=SIZE),
        "extinction 1e12": scene(noise(), medium(1e12), lights=SKY, size=SIZE),
        "extinction 1e-30": scene(slab(), medium(1e-30), lights=SKY, size=SIZE),
        "radiance 1e30": scene(lights=(ConstantEnvironment(1e30),), size=SIZE),
    }
    found = {name: compared(described) for name, described in cases.items()}
    return {"cases": found, "passed": all(case["passed"] for case in found.values())}
