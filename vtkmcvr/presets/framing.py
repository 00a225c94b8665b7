"""What of a volume a picture should hold: what is seen, without stray specks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..curves import Curve
from ..studio import View
from ..volume import Volume

# Share of the seen voxels that may lie outside of the picture on each side
SPECKS = 5e-4
MOST_POINTS = 20000
# A slab is thinner than this share of its other edges; how far its view is turned then, degrees
THIN, TILT = 0.5, 55.0


def seen_voxels(volume: Volume, opacity: Curve, mask: NDArray | None) -> NDArray[np.bool_]:
    """Voxels of every second plane along each axis whose opacity is above 0, (k, j, i)."""
    values = volume.values[::2, ::2, ::2]
    if values.dtype.kind in "iu" and values.dtype.itemsize <= 2:
        # Each value once: a curve is slower than a table
        lowest = int(values.min())
        shown = opacity(np.arange(lowest, int(values.max()) + 1, dtype=np.float64)) > 0
        seen = np.empty(values.shape, bool)
        # Plane by plane, because indices take eight bytes each
        for plane, out in zip(values, seen, strict=True):
            out[...] = shown[plane.astype(np.intp) - lowest]
    else:
        finite = np.isfinite(values)
        seen = finite & (opacity(np.where(finite, values, 0)) > 0)
    return seen if mask is None else seen & (mask[::2, ::2, ::2] != 0)


def seen_points(volume: Volume, seen: NDArray[np.bool_]) -> NDArray[np.float64] | None:
    """World points (n, 3) that hold what is seen but for specks; None for nothing.

    Parameters
    ----------
    volume : Volume
    seen : array
        Of `seen_voxels`.

    Returns
    -------
    array or None
        Voxels on an even sample, and the middles of the faces of the box around all of them.
    """
    total = int(np.count_nonzero(seen))
    if not total:
        return None
    ends = []
    for axis in range(3):
        others = tuple(a for a in range(3) if a != axis)
        reached = np.cumsum(np.count_nonzero(seen, axis=others))
        first = int(np.searchsorted(reached, SPECKS * total, side="right"))
        ends.append((first, int(np.searchsorted(reached, (1 - SPECKS) * total, side="left"))))
    low, high = np.array(ends).T
    inside = _some_of(seen[tuple(slice(a, b + 1) for a, b in ends)]) + low
    middle = (low + high) / 2
    axes = np.eye(3, dtype=bool)
    faces = [np.where(axis, end, middle) for axis in axes for end in (low, high)]
    # Every second voxel was looked at: what is seen may reach one further
    index = np.concatenate([inside, faces])
    index = 2 * index + np.sign(index - middle)
    index = np.clip(index, 0, np.array(volume.values.shape) - 1)[:, ::-1]
    return index @ volume.index_to_world[:3, :3].T + volume.index_to_world[:3, 3]


def _some_of(seen: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Indices (n, 3) of every so many voxels that are seen, plane by plane to spare memory."""
    counts = np.count_nonzero(seen, axis=(1, 2))
    step = max(1, int(counts.sum()) // MOST_POINTS)
    before = np.cumsum(counts) - counts
    found = []
    for k, (plane, passed) in enumerate(zip(seen, before, strict=True)):
        rows = np.argwhere(plane)[-passed % step :: step]
        found.append(np.column_stack([np.full(len(rows), k), rows]))
    return np.concatenate(found)


def view_of_slab(view: View, points: NDArray[np.float64] | None) -> View:
    """Return a view turned so that a thin slab is not seen from its edge; else the view itself.

    Axial slabs are seen from below, as radiologists do, unless the view looks down; sagittal ones
    from the left side.
    """
    if points is None or view.view != "front":
        return view
    edges = np.ptp(points, axis=0)
    thinnest = int(np.argmin(edges))
    if edges[thinnest] > THIN * np.sort(edges)[1]:
        return view
    if thinnest == 2:
        return replace(view, elevation=TILT if view.elevation > 0 else -TILT)
    return replace(view, azimuth=TILT) if thinnest == 0 else view
