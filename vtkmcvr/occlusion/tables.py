"""What a sweep takes on a CUDA device: all that the CPU works out block by block, in tables."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..kernels.cone_layers import SEGMENT
from ..kernels.cone_rays import DEPTH, TILE
from ..pack import f32
from .medium import Filled, Filling
from .raster import Raster
from .single import BLUR, Blurred, Published
from .sweep import Light
from .traced import FAINT_GROUPS, Traced

i32 = np.int32
# Numbers in a `packed.LayerBlock`
PLACE = 20


class Tables(NamedTuple):
    """Arguments of a kernel that sweeps, in its order."""

    volumes: tuple[packed.FilledVolume, ...]
    sweep: packed.Sweep
    sheets: packed.Sheets
    eye: packed.Eye
    shade: packed.Shade | None
    film: packed.OcclusionFilm
    light: packed.SweptLight
    # (3,) pixels times layers: looked up, and seen; blocks behind which a view ray goes on
    work: NDArray[np.int64]


def tables_of(
    raster: Raster,
    filling: Filling,
    light: Light,
    shade: packed.Shade | None,
    film: packed.OcclusionFilm,
) -> Tables:
    """Arguments of the kernel that sweeps; there must be a layer."""
    height, width = film.alpha.shape
    left, top = raster.left, raster.top
    sweep = packed.Sweep(
        raster.perspective, np.array((-left, -top, width - left, height - top), np.int64),
        np.int64(raster.count), f32(filling.bleeding or 0), f32(filling.opaque),
        np.bool_(filling.limited), np.bool_(light.tiers), np.bool_(filling.skip),
    )  # fmt: skip
    volumes = tuple(_volume(raster, volume) for volume in filling.volumes)
    plane = (raster.rows, raster.columns)
    eye = packed.Eye(
        blank(plane, 1), blank(plane, 1), blank(plane), blank((raster.rows, 2), kind=i32)
    )
    film = packed.OcclusionFilm._make(None if a is None else blank(a.shape) for a in film)
    sheets = _sheets(raster, filling, light)
    work = np.zeros(3, np.int64)
    return Tables(volumes, sweep, sheets, eye, shade, film, _swept_light(raster, light), work)


def _swept_light(raster: Raster, light: Light) -> packed.SweptLight:
    return packed.SweptLight(
        beams=_beam_table(raster, light) if isinstance(light, Traced) else None,
        blurred=_blur_table(raster, light) if isinstance(light, Blurred) else None,
        published=_published_table(raster, light) if isinstance(light, Published) else None,
    )


def blank(shape: tuple[int, ...], value: float = 0, kind: Any = f32) -> NDArray[Any]:
    """An array of one value, without memory: a device makes its own."""
    return np.broadcast_to(kind(value), shape)


def blocks_in(raster: Raster) -> int:
    """Number of blocks of layers."""
    return -(-raster.count // DEPTH)


def _volume(raster: Raster, volume: Filled) -> packed.FilledVolume:
    places = [np.hstack(raster.block(k * DEPTH, volume)) for k in range(blocks_in(raster))]
    table = np.array(places, f32).reshape(-1, PLACE)
    return packed.FilledVolume(volume.medium, volume.transfer, volume.integrals, table)


def _sheets(raster: Raster, filling: Filling, light: Light) -> packed.Sheets:
    rows, columns = raster.rows, raster.columns
    one = (DEPTH, rows, columns)
    flags = (DEPTH, rows, columns // SEGMENT)
    depth = blank((2, *one))
    coloured = filling.bleeding is not None
    several = len(filling.volumes) > 1
    return packed.Sheets(
        depth, blank((2, *one)) if filling.limited else depth,
        blank((2, 3, *one)) if coloured else None, blank((2, 3, *one)) if several else None,
        blank((2, *one)), blank((2, *one)), blank((2, *flags), kind=np.uint8),
        blank((2, -(-rows // TILE), flags[2]), kind=np.uint8), blank(one),
        blank(one) if light.relief and not coloured else None, blank(flags, kind=np.uint8),
    )  # fmt: skip


def _beam_table(raster: Raster, light: Traced) -> packed.BeamTable:
    order = np.concatenate(light.members)
    few = sum(len(group) for group in light.members[:FAINT_GROUPS])
    middle = light.places[(light.first[:, :-1] + light.first[:, 1:]) // 2]
    plane = (raster.rows, raster.columns)
    return packed.BeamTable(
        light.beams.cone, light.table, order.astype(i32), np.int64(few), _zooms(raster),
        light.places.astype(i32), light.first.astype(i32), np.ascontiguousarray(middle, i32),
        _behind(raster, light), blank((len(order), light.colours, *plane)),
    )  # fmt: skip


def _zooms(raster: Raster) -> NDArray[np.float32]:
    depth = raster.near + (np.arange(raster.count) + 0.5) * raster.thickness
    return (np.ones(raster.count) if raster.parallel else 1 / depth).astype(f32)


def _behind(raster: Raster, light: Traced) -> NDArray[np.int32]:
    """Last places before each block and behind the last one, and what leads to where rays are kept.

    Before the first block it is the first place.
    """
    ends = np.minimum(np.arange(blocks_in(raster) + 1) * DEPTH, raster.count)
    last = np.maximum(light.first[:, ends] - 1, light.first[:, :1])
    places = light.places[last]
    size = np.maximum((raster.rows, raster.columns), 1)
    return np.ascontiguousarray(np.concatenate([places, -places % size], axis=2), i32)


def _blur_table(raster: Raster, light: Blurred) -> packed.BlurTable:
    """As `Blurred.through` blurs: behind a layer where enough is pending."""
    widths = np.zeros(raster.count, f32)
    pending = 0.0
    for number in range(raster.count):
        pending += light.variance_at(number)
        if pending >= BLUR:
            widths[number] = min(
                math.sqrt(1 + 12 * pending), 2.0 * max(raster.rows, raster.columns)
            )
            pending = 0.0
    planes = (light.colours, raster.rows, raster.columns)
    return packed.BlurTable(f32(light.kappa), widths, blank(planes), blank(planes))


def _published_table(raster: Raster, light: Published) -> packed.PublishedTable:
    depth = raster.near + np.arange(raster.count) * raster.thickness
    pitch = raster.pitch * (np.ones(raster.count) if raster.parallel else depth)
    points = light.points * (raster.thickness / pitch)[:, None, None]
    return packed.PublishedTable(
        np.ascontiguousarray(points, f32), light.secants, np.bool_(light.exact),
        blank((2, raster.rows, raster.columns)),
    )  # fmt: skip
