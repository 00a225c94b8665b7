"""Where the patient is in a CT: without the table, and without the air around.

Found on a grid of about 2 mm: what is denser than lung, holes filled slice by slice, opened so that
table and cushion come off, its large connected parts.
"""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..volume import Volume

# HU above which something is body (or table); mm of the grid; mm that the opening breaks
DENSER_THAN, PITCH, BRIDGE = -300.0, 2.0, 5.0
# Parts that count, as a share of the largest one (legs and arms lie apart)
PART_SHARE = 0.2
# Room around the skin in mm, so that no skin is lost to the coarse grid
ROOM = 5.0
# Hiding less than this share of what would be seen is not worth a mask
WORTH = 1e-3

Known = dict[tuple[float, float], NDArray | None]
_cache: weakref.WeakKeyDictionary[Volume, Known] = weakref.WeakKeyDictionary()


def body_mask(volume: Volume, level: float, depth: float = 0.0) -> NDArray[np.uint8] | None:
    """Mask of the body in a CT.

    Parameters
    ----------
    volume : Volume
    level : float
        Value that stands for -300 HU.
    depth : float
        mm below the skin from which on voxels are kept; 0: with the skin.

    Returns
    -------
    array (k, j, i) of 0 and 1, or None
        None where no body is found.
    """
    known = _cache.setdefault(volume, {})
    if (level, depth) not in known:
        known[level, depth] = _mask(volume, level, depth)
    return known[level, depth]


def worth_hiding(mask: NDArray, seen: NDArray[np.bool_]) -> bool:
    """Whether a mask hides more than a trace of the voxels that are seen."""
    total = int(np.count_nonzero(seen))
    return bool(total > 0 and np.count_nonzero(seen & (mask == 0)) > WORTH * total)


def _mask(volume: Volume, level: float, depth: float) -> NDArray[np.uint8] | None:
    steps = np.maximum(1, np.rint(PITCH / volume.spacing)).astype(int)
    i, j, k = steps
    pitch = volume.spacing * steps
    dense = (volume.values[::k, ::j, ::i] > level).astype(np.uint8)
    if min(dense.shape) < 2 or not dense.any():
        return None
    filled = _filled(dense, axial=int(np.argmax(np.abs(volume.index_to_world[2, :3]))))
    body = _large_parts(_image(filled, pitch))
    distance = _distance_outside(body, pitch)
    near = -depth if depth > 0 else max(ROOM, float(pitch.max()))
    kept = (distance <= near).astype(np.uint8)
    return _spread_out(kept, volume.values.shape, (k, j, i))


def _image(values: NDArray, spacing: NDArray) -> Any:
    import SimpleITK

    image = SimpleITK.GetImageFromArray(values)
    image.SetSpacing([float(x) for x in spacing])
    return image


def _large_parts(dense: Any) -> NDArray[np.uint8]:
    """Return the large connected parts of what is dense, without what hangs on by a thin bridge."""
    import SimpleITK

    radius = [max(1, round(BRIDGE / 2 / x)) for x in dense.GetSpacing()]
    opened = SimpleITK.BinaryErode(dense, radius, SimpleITK.sitkBall)
    parts = SimpleITK.RelabelComponent(SimpleITK.ConnectedComponent(opened))
    numbers = SimpleITK.GetArrayFromImage(parts)
    sizes = np.bincount(numbers.ravel())[1:]
    if not len(sizes):
        return SimpleITK.GetArrayFromImage(dense)
    count = int(np.count_nonzero(sizes >= PART_SHARE * sizes[0]))
    kept = SimpleITK.BinaryThreshold(parts, 1, count)
    grown = SimpleITK.BinaryDilate(kept, radius, SimpleITK.sitkBall)
    return SimpleITK.GetArrayFromImage(SimpleITK.And(grown, dense))


def _filled(body: NDArray[np.uint8], axial: int) -> NDArray[np.uint8]:
    """Fill what each axial slice encloses; `axial` is the index axis (i, j, k) along z."""
    import SimpleITK

    slices = np.moveaxis(body, 2 - axial, 0)
    out = np.empty_like(slices)
    for k, plane in enumerate(slices):
        image = SimpleITK.GetImageFromArray(np.ascontiguousarray(plane))
        out[k] = SimpleITK.GetArrayFromImage(SimpleITK.BinaryFillhole(image, True, 1))
    return np.ascontiguousarray(np.moveaxis(out, 0, 2 - axial))


def _distance_outside(body: NDArray[np.uint8], spacing: NDArray) -> NDArray[np.float32]:
    """Distance to the body's edge in mm, negative inside."""
    import SimpleITK

    found = SimpleITK.SignedMaurerDistanceMap(_image(body, spacing), False, False, True)
    return SimpleITK.GetArrayFromImage(found)


def _spread_out(
    coarse: NDArray[np.uint8], shape: tuple[int, ...], steps: tuple[int, ...]
) -> NDArray[np.uint8]:
    """Return the nearest coarse value of each voxel."""
    places = [
        np.minimum((np.arange(n) + step // 2) // step, size - 1)
        for n, step, size in zip(shape, steps, coarse.shape, strict=True)
    ]
    return np.ascontiguousarray(coarse[np.ix_(*places)])
