"""The transport's part of the plan: order of scattering, and how collisions are found."""

from __future__ import annotations

import numpy as np

from .. import packed
from ..effects import Effect
from ..pack import f32
from ..scene import Scene

# Throughput below which Russian roulette may end a path of multiple scattering
ROULETTE = 0.25
# A path without a limit ends here, so that none loops forever: in a slab of 1000 mean free paths of
# albedo 1 a share of exp(-33) gets this far; the light of longer paths is lost
UNLIMITED = 10**7
# Shortest step of a march, in voxel edges, and most steps over the diagonal
FINEST_STEP, MOST_STEPS = 1e-3, 2**22


def pack_scattering(scene: Scene) -> packed.Scattering | None:
    """Multiple scattering, or None for one event."""
    if scene.scattering == "single" or scene.max_scatterings == 1:
        return None
    most = UNLIMITED if scene.max_scatterings is None else min(scene.max_scatterings, UNLIMITED)
    return packed.Scattering(np.int32(most), f32(ROULETTE))


def scattering_effect(scattering: packed.Scattering | None) -> Effect:
    """Its reason."""
    name = "multiple scattering"
    if scattering is None:
        return Effect(name, False, "one event between light and camera")
    if scattering.most == UNLIMITED:
        return Effect(name, True, "without a limit; Russian roulette ends paths")
    return Effect(name, True, f"up to {scattering.most} events; Russian roulette ends paths")


def pack_marching(scene: Scene) -> packed.Marching | None:
    """Ray marching, or None for tracking."""
    if scene.estimator != "ray-march":
        return None
    smallest = float(scene.volume.spacing.min())
    diagonal = 2 * scene.volume.radius
    step = max(smallest / 2, 4 * diagonal / MOST_STEPS) if scene.step is None else scene.step
    if step * MOST_STEPS < diagonal:
        raise ValueError(
            f"step is at least {diagonal / MOST_STEPS:g}, {MOST_STEPS} over the volume's diagonal; "
            f"got {step:g}"
        )
    if step < FINEST_STEP * smallest:
        raise ValueError(
            f"step is at least {FINEST_STEP:g} of the smallest voxel edge ({smallest:g}), "
            f"got {step:g}"
        )
    return packed.Marching(f32(step))


def estimator_words(scene: Scene, medium: packed.Medium) -> str:
    """How collisions are found."""
    if scene.estimator == "ray-march":
        marching = pack_marching(scene)
        assert marching is not None
        return f"marching in steps of {marching.step:g}: biased"
    if scene.estimator == "woodcock":
        return f"delta tracking over the global majorant {medium.majorant.max():g}"
    share = float(np.mean(medium.majorant <= 0))
    return f"delta tracking; {share:.0%} of the macrocells are empty and skipped"
