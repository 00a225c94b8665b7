"""One volume's part of the plan: medium, transfer function, surfaces, cuts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..effects import Effect
from ..layers import Layer
from ..pack import f32, matrix64, vector64
from ..scene import Scene
from ..tables import Tables, varying
from ..voxels import Voxels, voxels_of
from .cutting import pack_cuts
from .labels import constant_shape, rows_of, stacked_tables
from .medium import NOWHERE, pack_medium
from .surface import pack_phong, pack_surface
from .transfer import pack_transfer, transfer_effects

MORE = "more volumes"
# Coat of what has none, in a scene in which something has one: no coat after all
BARE = packed.Gloss((f32(0), f32(0), f32(0)), f32(0), np.bool_(False))


@dataclass(frozen=True)
class PackedVolume:
    """Packed parts of one volume, and the effects that they are."""

    medium: packed.Medium
    transfer: packed.Transfer
    surface: packed.Surface | None
    gloss: packed.Gloss | None
    voxels: Voxels
    tables: Tables
    effects: tuple[Effect, ...]
    index_to_world: NDArray[np.float64]
    phong: packed.Phong | None = None

    @property
    def empty(self) -> bool:
        """Whether nothing in it can scatter or absorb."""
        return bool(self.medium.active_hi[0] <= NOWHERE)

    @property
    def corners(self) -> NDArray[np.float64]:
        """World corners of the part that is not empty, (8, 3); (0, 3) where all is."""
        if self.empty:
            return np.empty((0, 3))
        ends = np.array([self.medium.active_lo, self.medium.active_hi], np.float64)
        box = np.array([ends[[i, j, k], [0, 1, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
        return box @ self.index_to_world[:3, :3].T + self.index_to_world[:3, 3]


def pack_volume(scene: Scene) -> PackedVolume:
    """Pack the (first) volume of a scene."""
    voxels = voxels_of(scene.volume)
    rows = rows_of(scene.transfer, scene.labels, scene.mask)
    tables = stacked_tables(rows, scene, voxels)
    surface, gloss, surface_why, gloss_why = pack_surface(scene, voxels, tables)
    transfer = pack_transfer(scene, voxels, tables, gloss is not None)
    cuts = pack_cuts(scene.volume, scene.clip, scene.crop)
    medium = pack_medium(scene, voxels, tables, transfer, cuts, rows.row)
    effects = (
        *transfer_effects(scene, transfer),
        *cuts.effects,
        *rows.effects,
        Effect("surface shading", surface is not None, surface_why),
        Effect("specular coat", gloss is not None, gloss_why),
    )
    return PackedVolume(
        medium, transfer, surface, gloss, voxels, tables, effects, scene.volume.index_to_world,
        pack_phong(scene.surface),
    )  # fmt: skip


def pack_layers(scene: Scene) -> tuple[list[PackedVolume], Effect]:
    """Pack the other volumes of a scene; those that are empty are left out."""
    if not scene.layers:
        return [], Effect(MORE, False, "one volume")
    packs = [pack_volume(_alone(scene, layer)) for layer in scene.layers]
    seen = [p for p in packs if not p.empty]
    if not seen:
        return [], Effect(MORE, False, "the others are transparent all over")
    empty = f", {len(packs) - len(seen)} empty ones left out" if len(seen) < len(packs) else ""
    why = f"{len(seen)} beside the first, each walked on its own{empty}"
    return seen, Effect(MORE, True, why)


def shared_phase(
    scene: Scene, volumes: list[PackedVolume]
) -> tuple[list[PackedVolume], NDArray[np.float32] | None]:
    """Phase function's shape over all entries of all volumes, None where no volume gives any.

    Where it varies, also from volume to volume, each of them gets a table of its own.
    """
    if all(v.tables.g is None for v in volumes):
        return volumes, None
    own = f32(constant_shape(scene.phase))
    tables = [
        np.full(len(v.tables.sigma_t), own) if v.tables.g is None else v.tables.g for v in volumes
    ]
    shapes = np.concatenate(tables)
    if varying(shapes) is None:
        return volumes, shapes
    changed = [
        replace(v, transfer=v.transfer._replace(phase=table))
        for v, table in zip(volumes, tables, strict=True)
    ]
    return changed, shapes


def _alone(scene: Scene, layer: Layer) -> Scene:
    """Scene with a layer as its only volume."""
    return replace(
        scene, volume=layer.volume, transfer=layer.transfer, surface=layer.surface,
        clip=layer.clip, crop=layer.crop, mask=layer.mask, labels=layer.labels, layers=(),
    )  # fmt: skip


def packed_layer(volume: PackedVolume, centre: NDArray, coated: bool) -> packed.Layer:
    """Kernels' view of a further volume, with `centre` the world position of the first one's."""
    m = volume.index_to_world
    inverse = np.linalg.inv(m[:3, :3])
    return packed.Layer(
        volume.medium, volume.transfer, volume.surface,
        coat(volume.gloss, coated),
        matrix64(inverse), vector64(inverse @ (centre - m[:3, 3])),
    )  # fmt: skip


def coat(gloss: packed.Gloss | None, coated: bool) -> packed.Gloss | None:
    """`gloss`; or, where some other surface of the scene has a coat, at least a bare one."""
    return BARE if gloss is None and coated else gloss
