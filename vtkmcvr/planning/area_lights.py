"""Area lights -> the canonical surfaces that kernels know."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..lights import AreaLight, Texture
from ..lights.patch import Patch
from ..pack import f32, vector
from ..volume import Volume
from .light_tree import DECAYING, LUMINANCE, Leaf, few_of

KINDS = ("rectangle", "disk", "sphere", "cylinder")
_NOWHERE = (f32(0), f32(0), f32(0))
# A rectangle that no ray meets
NOTHING = packed.AreaLight(
    np.int32(0), _NOWHERE, _NOWHERE, _NOWHERE, _NOWHERE, _NOWHERE, _NOWHERE, np.False_, np.False_
)


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
    kinds = [patch.kind for patch in patches]
    near = sum(patch.kind == "rectangle" and _is_near(patch, volume) for patch in patches)
    shapes = packed.Shapes(
        _present(near), *(_present(kinds.count(kind)) for kind in KINDS if kind != "rectangle")
    )
    few = few_of([_values(emitter, volume) for emitter in emitters], NOTHING)
    return packed.AreaLights(
        np.int32(len(emitters)), few, None if few else _rows(emitters, volume), shapes,
        _textures(emitters), _present(sum(emitter.visible for emitter in emitters)),
    )  # fmt: skip


def _values(emitter: Emitter, volume: Volume) -> packed.AreaLight:
    patch = emitter.patch
    u, v, w = (vector(axis) for axis in patch.axes)
    return packed.AreaLight(
        np.int32(KINDS.index(patch.kind)), vector(patch.centre - volume.centre), u, v, w,
        vector(np.asarray(patch.size)), vector(emitter.radiance), np.bool_(emitter.two_sided),
        np.bool_(emitter.visible),
    )  # fmt: skip


def _rows(emitters: list[Emitter], volume: Volume) -> packed.LightRows:
    lights = [_values(emitter, volume) for emitter in emitters]
    frames = [(x.centre, x.u, x.v, x.w) for x in lights]
    return packed.LightRows(
        np.array([x.kind for x in lights]), np.array(frames), np.array([x.size for x in lights]),
        np.array([x.radiance for x in lights]), np.array([x.two_sided for x in lights]),
        np.array([x.visible for x in lights]),
    )  # fmt: skip


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
    """What the choice of a light knows of one surface."""
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
