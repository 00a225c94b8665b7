"""Area lights -> the canonical surfaces that kernels know."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..lights import AreaLight, Texture
from ..lights.patch import Patch
from ..pack import f32
from ..volume import Volume
from .light_tree import DECAYING, LUMINANCE, Leaf

KINDS = ("rectangle", "disk", "sphere", "cylinder")


@dataclass(frozen=True, eq=False)
class Emitter:
    """A canonical surface with what it emits, and how many more lights were added to it."""

    patch: Patch
    radiance: NDArray[np.float64]
    two_sided: bool
    visible: bool
    texture: Texture | None
    merged: int = 0

    @property
    def place(self) -> tuple:
        """What has to be equal for two of them to coincide."""
        kind, centre, axes, size = self.patch
        texture = None if self.texture is None else id(self.texture)
        flags = (kind, size, self.two_sided, self.visible, texture)
        return (*flags, centre.tobytes(), axes.tobytes())


def emitters_of(lights: list[AreaLight]) -> list[Emitter]:
    """Surfaces of all lights; those that coincide are one that is as bright as they together."""
    found: dict[tuple, Emitter] = {}
    for light in lights:
        fields = vars(light)
        for patch in light.patches:
            emitter = Emitter(
                patch, np.array(light.brightness), fields["two_sided"], fields["visible"],
                fields["texture"],
            )  # fmt: skip
            there = found.get(emitter.place)
            if there is not None:
                both = there.radiance + emitter.radiance
                emitter = replace(there, radiance=both, merged=there.merged + 1)
            found[emitter.place] = emitter
    return list(found.values())


def pack_area_lights(emitters: list[Emitter], volume: Volume) -> packed.AreaLights | None:
    """Tables of all surfaces, and marks of the kinds among them."""
    if not emitters:
        return None
    patches = [emitter.patch for emitter in emitters]
    frames = [np.vstack([patch.centre - volume.centre, patch.axes]) for patch in patches]
    kinds = [patch.kind for patch in patches]
    near = sum(patch.kind == "rectangle" and _is_near(patch, volume) for patch in patches)
    shapes = packed.Shapes(
        _present(near), *(_present(kinds.count(kind)) for kind in KINDS if kind != "rectangle")
    )
    return packed.AreaLights(
        np.array([KINDS.index(kind) for kind in kinds], np.int32),
        np.ascontiguousarray(frames, f32),
        np.ascontiguousarray([patch.size for patch in patches], f32),
        np.ascontiguousarray([emitter.radiance for emitter in emitters], f32),
        np.array([emitter.two_sided for emitter in emitters], np.bool_),
        np.array([emitter.visible for emitter in emitters], np.bool_),
        shapes,
        _textures(emitters),
        _present(sum(emitter.visible for emitter in emitters)),
    )


def _present(count: int) -> packed.Present | None:
    return packed.Present(np.int32(count)) if count else None


def _is_near(patch: Patch, volume: Volume) -> bool:
    """Whether its distance varies so much that sampling its area would be noisy."""
    gap = float(np.linalg.norm(patch.centre - volume.centre)) - volume.radius
    return gap < patch.radius


def _textures(emitters: list[Emitter]) -> packed.LightTextures | None:
    used = list(dict.fromkeys(e.texture for e in emitters if e.texture is not None))
    if not used:
        return None
    starts = np.cumsum(
        [0, *(texture.pixels.shape[0] * texture.pixels.shape[1] for texture in used)]
    )
    rows = {t: (first, *t.pixels.shape[:2]) for t, first in zip(used, starts[:-1], strict=True)}
    layout = [(0, 0, 0) if e.texture is None else rows[e.texture] for e in emitters]
    return packed.LightTextures(
        np.ascontiguousarray(np.concatenate([t.pixels.reshape(-1, 3) for t in used]), f32),
        np.array(layout, np.int32),
    )


def area_leaf(emitter: Emitter, centre: NDArray) -> Leaf:
    """Bounds of one surface for the light tree."""
    patch = emitter.patch
    colour = (
        emitter.radiance if emitter.texture is None else emitter.radiance * emitter.texture.mean
    )
    around = emitter.two_sided or not patch.flat
    return Leaf(
        DECAYING,
        float(colour @ LUMINANCE) * patch.face,
        patch.centre - centre,
        patch.radius,
        patch.axes[2],
        spread=math.pi if around else 0.0,
        reach=math.pi / 2,
    )
