"""Directional occlusion shading: ambient light through a cone around the viewer, slice by slice."""

from __future__ import annotations

from .picture import OcclusionPicture
from .rendering import render_occlusion
from .settings import Occlusion

__all__ = ["Occlusion", "OcclusionPicture", "render_occlusion"]
