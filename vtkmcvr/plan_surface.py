"""The surfaces' part of the plan: where a BRDF replaces the phase function."""

from __future__ import annotations

import numpy as np

from . import packed
from .pack import f32, matrix, vector
from .scene import Scene
from .tables import Tables
from .voxels import Voxels


def pack_surface(
    scene: Scene, voxels: Voxels, tables: Tables
) -> tuple[packed.Surface | None, packed.Gloss | None, str, str]:
    """Surface and its coat, or None; and why for each."""
    surface = scene.surface
    no_gloss = "no surfaces"
    if surface is None:
        return None, None, "the scene has no surface: no gradients", no_gloss
    if surface.gradient_factor == 0 and not surface.always:
        return None, None, "gradient factor is 0: no gradients", no_gloss
    to_world = np.linalg.inv(scene.volume.index_to_world[:3, :3]).T
    largest = voxels.largest_gradient(np.ascontiguousarray(to_world))
    if largest == 0:
        return None, None, "the volume is constant: no gradients", no_gloss
    result = packed.Surface(
        tables.opacity, matrix(to_world), f32(1 / largest),
        f32(25 * surface.gradient_factor**3), np.bool_(surface.always),
    )  # fmt: skip
    why = "at every gradient" if surface.always else f"gradient factor {surface.gradient_factor:g}"
    if max(surface.specular) == 0:  # type: ignore[arg-type]
        return result, None, why, "specular reflectance is 0: Lambert"
    gloss = packed.Gloss(vector(np.array(surface.specular)), f32(surface.exponent))
    return result, gloss, why, f"Fresnel blend, Blinn exponent {surface.exponent:g}"
