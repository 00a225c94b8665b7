"""The transfer function's part of the plan: channels that vary become tables."""

from __future__ import annotations

import numpy as np

from .. import packed
from ..effects import Effect
from ..material import TransferFunction
from ..pack import f32, matrix
from ..scene import Scene
from ..tables import (
    Tables,
    column_positions,
    extinction_of,
    limited,
    row_positions,
    shortest_edge,
    varying,
)
from ..voxels import Voxels
from .surface import world_from_index_gradient

GRADIENT_ENTRIES = 2048
# Gradients between voxels of the border may exceed the largest one at a voxel by at most this
BORDER = 1.75


def pack_transfer(scene: Scene, voxels: Voxels, tables: Tables, coated: bool) -> packed.Transfer:
    """Tables of the channels that vary; `coated`: surfaces can ask for those of a coat."""
    return packed.Transfer(
        sigma_t=tables.sigma_t,
        colour=tables.colour,
        lowest=f32(voxels.lowest),
        per_scalar=f32(tables.per_scalar),
        gradient_opacity=_gradient_opacity(scene, voxels),
        table_2d=_table_2d(scene, voxels),
        colour_grid=_colour_grid(voxels),
        emission=tables.emission,
        specular=varying(tables.specular) if coated else None,
        exponent=varying(tables.exponent) if coated else None,
        phase=varying(tables.g),
        first=np.int32(0),
        entries=np.int32(tables.entries),
    )


def transfer_effects(scene: Scene, transfer: packed.Transfer) -> tuple[Effect, ...]:
    """What the transfer function asks for beyond opacity and colour by the scalar."""
    gradient = "the transfer function depends on the scalar alone: no gradients in the medium"
    if transfer.gradient_opacity is not None:
        gradient = "gradient opacity"
    elif transfer.table_2d is not None:
        gradient = "2-D table of scalar and gradient magnitude"
    emission = "the transfer function has none, or it is black"
    if transfer.emission is not None:
        emission = f"up to radiance {transfer.emission.max():g}, at every collision"
    by_gradient = transfer.gradient_opacity is not None or transfer.table_2d is not None
    given = transfer.colour_grid is not None
    return (
        Effect("colour by point", given, "the volume's own" if given else "the volume has none"),
        Effect("gradient classification", by_gradient, gradient),
        Effect("emission", transfer.emission is not None, emission),
    )


def gradient_distance(scene: Scene) -> float:
    """World units that the transfer function's gradient magnitudes refer to."""
    given = scene.transfer.gradient_distance
    return float(scene.volume.spacing.mean()) if given is None else given


def _colour_grid(voxels: Voxels) -> packed.ColourGrid | None:
    if voxels.colours is None:
        return None
    scale = 1 / 255 if voxels.colours[0].dtype == np.uint8 else 1.0
    return packed.ColourGrid(*voxels.colours, f32(scale))


def _gradient_opacity(scene: Scene, voxels: Voxels) -> packed.GradientOpacity | None:
    curve = scene.transfer.gradient_opacity
    if curve is None:
        return None
    to_world = world_from_index_gradient(scene)
    most = BORDER * voxels.largest_gradient(to_world)
    x = np.linspace(0, most, GRADIENT_ENTRIES)
    factor = curve(x * gradient_distance(scene) * voxels.unit).astype(f32)
    if (factor == 1).all():
        return None
    per_gradient = (GRADIENT_ENTRIES - 1) / most if most > 0 else 0.0
    return packed.GradientOpacity(factor, f32(per_gradient), matrix(to_world))


def _table_2d(scene: Scene, voxels: Voxels) -> packed.Table2D | None:
    transfer: TransferFunction = scene.transfer
    if transfer.table is None:
        return None
    smallest = shortest_edge(scene.volume)
    rgba = transfer.table.rgba
    sigma_t = extinction_of(rgba[..., 3], transfer.unit_distance, smallest)
    lowest, pitch = column_positions(transfer.table)
    lowest_gradient, gradient_pitch = row_positions(transfer.table)
    distance = gradient_distance(scene) * voxels.unit
    return packed.Table2D(
        limited(sigma_t, transfer, smallest)[0],
        np.ascontiguousarray(rgba[..., :3], f32),
        f32((lowest - voxels.offset) / voxels.unit), f32(voxels.unit / pitch),
        f32(lowest_gradient / distance), f32(distance / gradient_pitch),
        matrix(world_from_index_gradient(scene)),
    )  # fmt: skip
