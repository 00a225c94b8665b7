"""Pipeline filters: VTK algorithms that render volumes and show what they rendered."""

from __future__ import annotations

from .denoise import DenoiseFilter
from .directional_occlusion import DirectionalOcclusionFilter
from .monte_carlo import MonteCarloFilter
from .tone_map import ToneMapFilter

__all__ = ["DenoiseFilter", "DirectionalOcclusionFilter", "MonteCarloFilter", "ToneMapFilter"]
