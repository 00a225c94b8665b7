"""What each effect of a scene costs: the scene without it, on a short pilot."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from .. import checks
from ..effects import EffectCost
from ..film.error import variance
from ..pictures.picture import Picture
from ..plan import plan
from ..rendering import render_scene
from ..scene import Scene
from .ladder import LADDER_SEED, REFERENCE_SEED, Reference
from .variants import MODEL, variants

PILOT_SAMPLES = 4
# Turns in which a scene and all others are rendered; the least time of a turn counts
ROUNDS = 3
# Variant without an effect -> the effect of the plan that it is without
SWITCHES = {
    "no shadows": "shadows",
    "no surface shading": "surface shading",
    "no specular coat": "specular coat",
    "isotropic phase": "anisotropic phase",
    "no depth of field": "depth of field",
    "environment alone": "lights",
    "no environment": "environment",
    "no emission": "emission",
    "no gradient opacity": "gradient classification",
    "no receivers": "receivers",
    "first volume alone": "more volumes",
    "no cuts": "cuts",
    "one transfer function for all labels": "labels",
    "single scattering": "multiple scattering",
    "no albedo or normal": "first-hit AOVs",
}


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

    Returns
    -------
    list of EffectCost
        Those that take most of the time first. `Plan.explain` makes them a table.
    """
    checks.number("seconds", seconds, above=0.0)
    whole, *others = [_Timed(scene, threads, REFERENCE_SEED)] + [
        _Timed(changed, threads, LADDER_SEED, name) for name, changed in _without(scene)
    ]
    for _ in range(ROUNDS):
        for timed in (whole, *others):
            timed.turn(seconds / ROUNDS)
    film = whole.picture.film
    reference = Reference(film.mean, variance(film), whole.picture.samples, whole.picture.seconds)
    costs = [_cost(timed, whole, reference) for timed in others]
    return sorted(costs, key=lambda cost: cost.saved)


def _without(scene: Scene) -> Iterator[tuple[str, Scene]]:
    """Name and scene of everything that can be left out."""
    for variant in variants(scene):
        if variant.kind == MODEL and variant.group == "without an effect":
            yield variant.name, variant.scene
    if scene.scattering == "multiple":
        single = replace(scene, scattering="single", max_scatterings=None)
        yield "single scattering", single
    if scene.aovs:
        yield "no albedo or normal", replace(scene, aovs=())


class _Timed:
    """A scene, rendered turn by turn."""

    def __init__(self, scene: Scene, threads: int | None, seed: int, name: str = ""):
        self.name = name
        self.picture: Picture = render_scene(
            plan(scene), samples=PILOT_SAMPLES, seed=seed, threads=threads, backend="cpu"
        )
        self.seconds_per_path = math.inf

    def turn(self, seconds: float) -> None:
        """Render for a time. Processor time counts, which other programs disturb little."""
        before, start = int(self.picture.film.count.sum()), time.process_time()
        self.picture = self.picture.refine(seconds=seconds)
        spent = time.process_time() - start
        paths = int(self.picture.film.count.sum()) - before
        self.seconds_per_path = min(self.seconds_per_path, spent / max(paths, 1))


def _cost(timed: _Timed, whole: _Timed, reference: Reference) -> EffectCost:
    film = timed.picture.film
    # The noise of both is taken off the difference
    noise = float(np.mean(reference.variance + variance(film)))
    square = float(np.mean((film.mean - whole.picture.film.mean) ** 2)) - noise
    change = math.sqrt(max(square, 0.0) / reference.power) if reference.power > 0 else 0.0
    saved = timed.seconds_per_path / whole.seconds_per_path - 1
    return EffectCost(timed.name, SWITCHES[timed.name], saved, change)
