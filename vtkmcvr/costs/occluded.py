"""Directional occlusion in a study: another model than the scene's, and biased against its own."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..lights import ConstantEnvironment
from ..occlusion import Occlusion, render_occlusion
from ..occlusion.ambient import ambient_radiance
from ..phases import Cone
from ..scene import Scene
from .ladder import Point, Reference


def cone_scene(scene: Scene, half_angle: float) -> Scene:
    """Scene that directional occlusion approximates: scattering once, in a cone, an even sky."""
    return replace(
        scene,
        phase=Cone(half_angle),
        lights=(ConstantEnvironment(tuple(ambient_radiance(scene).tolist())),),
        camera=replace(scene.camera, lens=None),
        transfer=replace(scene.transfer, g=None, emission=None),
        surface=None,
        scattering="single",
        max_scatterings=None,
        environment_visible=False,
    )


def occluded(
    scene: Scene, settings: Occlusion, reference: Reference, cone: Reference, threads: int
) -> tuple[Point, dict[str, float], NDArray]:
    """Point against the scene as it is, bias against the cone by Monte Carlo, and radiance.

    The bias also has the error "matched" against the scene at the best factor of brightness "gain".

    The first of two renders compiles.
    """
    small = replace(scene, size=(8, 6))
    render_occlusion(small, settings, threads=threads, backend="cpu")
    start = time.process_time()
    picture = render_occlusion(scene, settings, threads=threads, backend="cpu")
    cpu_seconds = (time.process_time() - start) / threads
    measured, spread = reference.error(picture.radiance)
    point = Point(1, picture.seconds, None, measured, spread, cpu_seconds)
    bias, bias_spread = cone.error(picture.radiance)
    # The brightness that is nearest to the scene's: a wrong exposure is no wrong shading
    gain = _nearest(picture.radiance, reference)
    matched, _ = reference.error(gain * picture.radiance)
    facts = {
        "half_angle": settings.half_angle, "nrms": bias, "spread": bias_spread, "gain": gain,
        "matched": matched,
    }  # fmt: skip
    return point, facts, picture.radiance


def _nearest(radiance: NDArray, reference: Reference) -> float:
    """Factor of least square difference."""
    square = float(np.mean(radiance.astype(np.float64) ** 2))
    return float(np.mean(radiance * reference.radiance)) / square if square > 0 else 1.0
