"""What of a volume a picture should hold: what is seen, without stray specks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..curves import Curve
from ..volume import Volume

# Share of the seen voxels that may lie outside of the picture on each side
SPECKS = 5e-4


def seen_voxels(volume: Volume, opacity: Curve, mask: NDArray | None) -> NDArray[np.bool_]:
    """Voxels of every second plane along each axis whose opacity is above 0, (k, j, i)."""
    values = volume.values[::2, ::2, ::2]
    seen = opacity(np.where(np.isfinite(values), values, np.nan)) > 0
    return seen if mask is None else seen & (mask[::2, ::2, ::2] != 0)


def seen_corners(volume: Volume, seen: NDArray[np.bool_]) -> NDArray[np.float64] | None:
    """World corners (8, 3) of the box that holds what is seen but for specks; None for nothing.

    Parameters
    ----------
    volume : Volume
    seen : array
        Of `seen_voxels`.
    """
    total = int(np.count_nonzero(seen))
    if not total:
        return None
    ends = []
    for axis in (2, 1, 0):
        others = tuple(a for a in range(3) if a != axis)
        reached = np.cumsum(np.count_nonzero(seen, axis=others))
        first = int(np.searchsorted(reached, SPECKS * total, side="right"))
        last = int(np.searchsorted(reached, (1 - SPECKS) * total, side="left"))
        most = volume.values.shape[axis] - 1
        ends.append((max(2 * first - 2, 0), min(2 * last + 2, most)))
    index = np.array([[i, j, k] for i in ends[0] for j in ends[1] for k in ends[2]], np.float64)
    return index @ volume.index_to_world[:3, :3].T + volume.index_to_world[:3, 3]
