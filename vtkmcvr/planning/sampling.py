"""How random numbers are drawn."""

from __future__ import annotations

import numpy as np

from .. import packed
from ..effects import Effect
from ..scene import Scene

# Enough for lens, collision and light of the first scatterings
SETS = 16


def pack_sobol(scene: Scene) -> packed.Sobol | None:
    """Sobol points for the leading dimensions, or None for independent numbers."""
    if scene.sampler == "independent":
        return None
    return packed.Sobol(np.uint64(0), np.uint64(0), np.int64(SETS))


def sampling_effect(sobol: packed.Sobol | None) -> Effect:
    """Whether samples are spread evenly."""
    if sobol is None:
        return Effect("even samples", False, "the scene asks for independent random numbers")
    reason = f"scrambled Sobol points in independent batches of {packed.BATCH} samples"
    return Effect("even samples", True, reason)
