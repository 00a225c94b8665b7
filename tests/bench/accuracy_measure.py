"""Measurements of the accuracy page on one volume, as plain JSON values."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from vtkmcvr.accuracy import image_error
from vtkmcvr.costs.fit import fit_power
from vtkmcvr.costs.ladder import Reference, climb, make_reference, plain
from vtkmcvr.costs.occluded import cone_scene, occluded
from vtkmcvr.film.error import variance
from vtkmcvr.occlusion import Occlusion
from vtkmcvr.pictures.picture import Picture
from vtkmcvr.plan import plan
from vtkmcvr.prediction import estimate
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Scene

THREADS = 2
FULL, HALF = (800, 600), (400, 300)
TARGET = 0.1
# Seconds at the full budget: up to 10 %, a reference, a ladder
MOST_SECONDS, REFERENCE_SECONDS, LADDER_SECONDS = 45.0, 14.0, 12.0
# Two batches of Sobol points, whose errors are known without bias
LEAST_SAMPLES = 32
MODES = ("default", "fast", "paper")
ANGLE = 60.0

Facts = dict[str, Any]


def timed(render: Callable[[], Picture]) -> tuple[Picture, float]:
    """A picture, and its processor seconds over the number of threads."""
    start = time.process_time()
    picture = render()
    return picture, (time.process_time() - start) / THREADS


def known(x: float) -> float | None:
    """A number for JSON."""
    return float(x) if math.isfinite(x) else None


def full_size(scene: Scene, factor: float) -> Facts:
    """Predict 10 %, render until it is reached, and see what one second gives, at 800 x 600."""
    scene = replace(scene, size=FULL)
    planned = plan(scene)
    render_scene(planned, samples=1, threads=THREADS)
    predicted = estimate(planned, TARGET, threads=THREADS)
    picture, spent = timed(
        lambda: render_scene(
            planned, nrms=TARGET, seconds=MOST_SECONDS * factor, seed=1, threads=THREADS
        )
    )
    if picture.samples < LEAST_SAMPLES:
        picture, more = timed(lambda: picture.refine(samples=LEAST_SAMPLES))
        spent += more
    error = image_error(picture.film)
    # What a second gives where nothing else runs
    samples = max(1, round(picture.film.count.mean() / spent))
    second = render_scene(planned, samples=samples, seed=2, threads=THREADS)
    # Both pictures are independent: the noise of the longer one is taken off
    reference = Reference(
        picture.film.mean, variance(picture.film), picture.samples, picture.seconds
    )
    return {
        "size": list(FULL), "shape": list(scene.volume.shape),
        "type": str(scene.volume.values.dtype),
        "stopped_by": picture.stopped_by, "samples": picture.samples, "nrms": known(error.nrms),
        "high": known(error.high), "seconds": picture.seconds, "cpu_seconds": spent,
        "paths_per_second": picture.film.count.sum() / max(spent, 1e-9),
        "one_second": {
            "samples": second.samples, "nrms": known(reference.error(second.film.mean)[0]),
        },
        "predicted": predicted.facts(),
    }  # fmt: skip


def half_size(scene: Scene, factor: float) -> Facts:
    """Error at 1, 2, 4 ... samples, evenly spread and adaptive, against a reference."""
    planned = plan(replace(scene, size=HALF))
    reference = make_reference(planned, REFERENCE_SECONDS * factor, THREADS, least=LEAST_SAMPLES)
    seconds = LADDER_SECONDS * factor
    least = 2 * LEAST_SAMPLES
    even, _ = climb(planned, reference, seconds, THREADS, least=least)
    adaptive, _ = climb(planned, reference, seconds, THREADS, least=least, adaptive=True)
    return {
        "size": list(HALF), "reference": reference.facts(), "points": plain(even),
        "adaptive": plain(adaptive), "gain": gain(even[-1], adaptive[-1]),
    }  # fmt: skip


def gain(even: Any, adaptive: Any) -> Facts:
    """Time of evenly spread samples over that of adaptive ones at equal error, and its 95 % bounds.

    Time times square error does not depend on the number of samples.
    """
    ratio = even.cpu_seconds * even.measured**2 / (adaptive.cpu_seconds * adaptive.measured**2)
    spread = 2 * math.hypot(even.spread / even.measured, adaptive.spread / adaptive.measured)
    return {"ratio": ratio, "low": ratio * (1 - spread), "high": ratio * (1 + spread)}


def shaded(scene: Scene, factor: float) -> Facts:
    """Directional occlusion: seconds, and bias against its own model by Monte Carlo."""
    scene = replace(scene, size=HALF)
    whole = make_reference(plan(scene), 5.0 * factor, THREADS, least=LEAST_SAMPLES // 2)
    cone = make_reference(
        plan(cone_scene(scene, ANGLE)), 8.0 * factor, THREADS, least=LEAST_SAMPLES
    )
    modes = {}
    for mode in MODES:
        point, bias, _ = occluded(scene, Occlusion(ANGLE, mode), whole, cone, THREADS)
        least = max(bias["nrms"], bias["spread"])
        modes[mode] = {
            "seconds": point.cpu_seconds, "difference": point.measured, **bias,
            "same_noise_seconds": cone.seconds * (cone.nrms / least) ** 2 if least else None,
        }  # fmt: skip
    return {"size": list(HALF), "cone": cone.facts(), "modes": modes}


def fall(scene: Scene, most: int) -> Facts:
    """Error of pairs of independent pictures at 1, 2, 4 ... samples, and the power of its fall."""
    found: Facts = {"size": [48, 36]}
    for sampler in ("independent", "sobol"):
        planned = plan(replace(scene, size=(48, 36), sampler=sampler))
        rows = []
        for n in 2 ** np.arange(int(math.log2(most)) + 1):
            a, b = (
                render_scene(
                    planned, samples=int(n), seed=2 * int(n) + k, threads=THREADS
                ).film.mean
                for k in (0, 1)
            )
            square = ((a - b) ** 2).mean(-1) / 2
            nrms = math.sqrt(square.mean() / (a * b).mean())
            relative = square.std() / square.mean() / math.sqrt(square.size)
            rows.append({"samples": int(n), "nrms": nrms, "spread": 1.96 * nrms * relative / 2})
        power = fit_power(*([row[key] for row in rows] for key in ("samples", "nrms", "spread")))
        found[sampler] = {"points": rows, "exponent": power.exponent, "spread": power.spread}
    return found
