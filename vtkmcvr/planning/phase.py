"""The phase function's part of the plan."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..effects import Effect
from ..pack import f32
from ..phases import Cone, HenyeyGreenstein, Isotropic, Phase, Rayleigh, Schlick
from ..tables import varying

NAME = "anisotropic phase"
HENYEY_GREENSTEIN, SCHLICK, RAYLEIGH, CONE = 0, 1, 2, 3
# Mean cosine below which a phase function is drawn as isotropic
LEAST = 1e-3


def pack_phase(
    phase: Phase, g: NDArray[np.float32] | None = None
) -> tuple[packed.Phase | None, Effect]:
    """Phase function, or None where it is isotropic.

    `g` is the transfer function's table of the shape parameter, which replaces the phase's own.
    """
    if g is not None and varying(g) is not None:
        kind, _, why = _described(phase)
        by_scalar = f"{why.split(' = ')[0]} by the scalar"
        return packed.Phase(np.int32(kind), f32(0)), Effect(NAME, True, by_scalar)
    if g is not None:
        phase = (
            Schlick(float(g[0])) if isinstance(phase, Schlick) else HenyeyGreenstein(float(g[0]))
        )
    kind, shape, why = _described(phase)
    if kind in (HENYEY_GREENSTEIN, SCHLICK) and abs(shape) < LEAST:
        return None, Effect(NAME, False, "g is 0: isotropic")
    return packed.Phase(np.int32(kind), f32(shape)), Effect(NAME, True, why)


def _described(phase: Phase) -> tuple[int, float, str]:
    """Kind, shape and words."""
    if isinstance(phase, Isotropic):
        return HENYEY_GREENSTEIN, 0.0, "Henyey-Greenstein, g = 0"
    if isinstance(phase, HenyeyGreenstein):
        return HENYEY_GREENSTEIN, phase.g, f"Henyey-Greenstein, g = {phase.g:g}"
    if isinstance(phase, Schlick):
        return SCHLICK, phase.k, f"Schlick, k = {phase.k:g}"
    if isinstance(phase, Rayleigh):
        return RAYLEIGH, 1.0, "Rayleigh"
    assert isinstance(phase, Cone)
    # Around the way back: the peak is opposite to that of a positive g
    width = 2 * math.sin(math.radians(phase.angle) / 2) ** 2
    why = f"constant within {phase.angle:g} degrees of the way back to the viewer"
    return CONE, -width, why
