"""Emission and absorption: the classical direct volume rendering of VTK's ray casters."""

from __future__ import annotations

from .picture import EmissionAbsorptionPicture
from .rendering import AS_VTK, render_emission_absorption
from .settings import EmissionAbsorption

__all__ = [
    "AS_VTK",
    "EmissionAbsorption",
    "EmissionAbsorptionPicture",
    "render_emission_absorption",
]
