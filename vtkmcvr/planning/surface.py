"""The surfaces' part of the plan: where a BRDF replaces the phase function."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..material import SURFACE_MODES, Surface
from ..pack import f32, matrix, vector
from ..scene import Scene
from ..tables import Tables, varying
from ..voxels import Voxels

# Distance over which any extinction is opaque: an opacity of 1 for everything
EVERYWHERE = 1e30


def pack_normal_map(scene: Scene) -> packed.NormalMap | None:
    """What the film needs to record normals, or None where nobody asked for them."""
    if "normal" not in scene.aovs:
        return None
    return packed.NormalMap(matrix(world_from_index_gradient(scene)))


def pack_phong(surface: Surface | None) -> packed.Phong | None:
    """VTK's coefficients, where a surface has them."""
    if surface is None or surface.phong is None:
        return None
    p = surface.phong
    return packed.Phong(f32(p.ambient), f32(p.diffuse), f32(p.specular), f32(p.power))


def pack_surface(
    scene: Scene, voxels: Voxels, tables: Tables
) -> tuple[packed.Surface | None, packed.Gloss | None, str, str]:
    """Surface and its coat, or None; and why for each."""
    surface = scene.surface
    no_gloss = "no surfaces"
    if surface is None:
        return None, None, "the scene has no surface: no gradients", no_gloss
    if surface.gradient_factor == 0 and surface.mode == "hybrid":
        return None, None, "gradient factor is 0: no gradients", no_gloss
    to_world = world_from_index_gradient(scene)
    largest = voxels.largest_gradient(to_world)
    if largest == 0 and not scene.clip and scene.crop is None:
        return None, None, "the volume is constant: no gradients", no_gloss
    modulated = surface.mode == "hybrid" and surface.opacity_modulated
    result = packed.Surface(
        np.int32(SURFACE_MODES.index(surface.mode)),
        f32(min(tables.opacity_distance, EVERYWHERE) if modulated else EVERYWHERE),
        matrix(to_world), f32(1 / largest if largest > 0 else 0),
        f32(25 * surface.gradient_factor**3), f32(surface.threshold),
    )  # fmt: skip
    gloss, why = _gloss(surface, tables)
    return result, gloss, _why(surface), why


def world_from_index_gradient(scene: Scene) -> NDArray[np.float64]:
    """Map of gradients: inverse transpose of the map of positions."""
    return np.ascontiguousarray(np.linalg.inv(scene.volume.index_to_world[:3, :3]).T)


def _why(surface: Surface) -> str:
    if surface.mode == "brdf":
        return "at every gradient"
    if surface.mode == "threshold":
        return f"where the gradient is above {surface.threshold:g} of the largest"
    how = "" if surface.opacity_modulated else ", whatever the opacity"
    return f"gradient factor {surface.gradient_factor:g}{how}"


def _gloss(surface: Surface, tables: Tables) -> tuple[packed.Gloss | None, str]:
    specular, exponent = np.array(surface.specular), surface.exponent
    if tables.specular is not None:
        if tables.specular.max() == 0:
            return None, "specular reflectance is 0: Lambert"
        specular = tables.specular[0]
    elif specular.max() == 0:
        return None, "specular reflectance is 0: Lambert"
    words = f"{exponent:g}"
    if tables.exponent is not None:
        exponent = float(tables.exponent[0])
        words = f"{exponent:g}" if varying(tables.exponent) is None else "by the scalar"
    gloss = packed.Gloss(vector(specular), f32(exponent), np.bool_(surface.coat == "ggx"))
    name = "GGX" if surface.coat == "ggx" else "Blinn"
    return gloss, f"Fresnel blend, {name} exponent {words}"
