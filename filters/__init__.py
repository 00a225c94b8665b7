"""Pipeline filters: VTK algorithms that read and render volumes and show what they rendered."""

from __future__ import annotations

from .denoise import DenoiseFilter
from .directional_occlusion import DirectionalOcclusionFilter
from .emission_absorption import EmissionAbsorptionFilter
from .monte_carlo import MonteCarloFilter
from .tone_map import ToneMapFilter
from .volume_reader import VolumeReader

__all__ = [
    "DenoiseFilter",
    "DirectionalOcclusionFilter",
    "EmissionAbsorptionFilter",
    "MonteCarloFilter",
    "ToneMapFilter",
    "VolumeReader",
]
