"""Which volumes a lamp at the eye shades, and how."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..material import Phong, Surface
from ..scene import Scene
from .settings import EmissionAbsorption

# Blinn's exponent of the coat over Phong's, see `vtkmcvr.vtk_bridge.property.surface_of`
BLINN_OVER_PHONG = 4.0


def shaded_scene(scene: Scene, settings: EmissionAbsorption) -> Scene:
    """Scene whose surfaces carry the coefficients that they are shaded by, and nothing else."""
    layers = tuple(
        replace(layer, surface=_surface(layer.surface, settings)) for layer in scene.layers
    )
    return replace(scene, surface=_surface(scene.surface, settings), layers=layers)


def _surface(surface: Surface | None, settings: EmissionAbsorption) -> Surface | None:
    phong = _phong(surface, settings)
    # No probability of a surface, so that nobody looks for the largest gradient
    return None if phong is None else Surface(gradient_factor=0.0, phong=phong)


def _phong(surface: Surface | None, settings: EmissionAbsorption) -> Phong | None:
    if isinstance(settings.shading, Phong):
        return settings.shading
    if surface is None or settings.shading == "none":
        return None
    return surface.phong or phong_of_coat(surface)


def phong_of_coat(surface: Surface) -> Phong:
    """VTK's default coefficients with the highlight of a coat: `surface_of` the other way round."""
    power = surface.exponent / BLINN_OVER_PHONG
    specular = float(np.max(surface.specular)) * (surface.exponent + 2.0) / 8.0
    return Phong(specular=min(1.0, specular), power=power)
