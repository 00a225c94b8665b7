"""What each effect of a scene costs: the scene without it, on a short pilot."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..film_error import variance
from ..picture import Picture
from ..plan import plan
from ..rendering import render_scene
from ..scene import Scene
from .ladder import LADDER_SEED, REFERENCE_SEED, Reference
from .variants import MODEL, variants

PILOT_SAMPLES = 4


@dataclass(frozen=True)
class EffectCost:
    """The scene with something left out.

    Attributes
    ----------
    name : str
        Such as "no shadows".
    saved : float
        Change of the time per sample, -0.4: 40 % less.
    change : float
        NRMS difference from the picture with all effects.
    """

    name: str
    saved: float
    change: float


def effect_costs(
    scene: Scene, seconds: float = 2.0, threads: int | None = None
) -> list[EffectCost]:
    """Render the scene without each of its effects for a time, and compare.

    Parameters
    ----------
    scene : Scene
    seconds : float
        For each, > 0, compilation not counted.
    threads : int, optional
        Default: all CPUs that the process may use.
    """
    whole = _timed(scene, seconds, threads, REFERENCE_SEED)
    reference = Reference(whole.film.mean, variance(whole.film), whole.samples, whole.seconds)
    costs = []
    for variant in variants(scene):
        if variant.kind != MODEL or variant.group != "without an effect":
            continue
        without = _timed(variant.scene, seconds, threads, LADDER_SEED)
        # The noise of both is taken off the difference
        noise = float(np.mean(reference.variance + variance(without.film)))
        square = float(np.mean((without.film.mean - whole.film.mean) ** 2)) - noise
        change = math.sqrt(max(square, 0.0) / reference.power) if reference.power > 0 else 0.0
        saved = whole.paths_per_second / without.paths_per_second - 1
        costs.append(EffectCost(variant.name, saved, change))
    return costs


def _timed(scene: Scene, seconds: float, threads: int | None, seed: int) -> Picture:
    planned = plan(scene)
    first = render_scene(planned, samples=PILOT_SAMPLES, seed=seed, threads=threads)
    return first.refine(seconds=seconds)
