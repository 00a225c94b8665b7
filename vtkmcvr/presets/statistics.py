"""What the values of a volume look like, from every second voxel along each axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Offsets with which scanners and archives store HU as unsigned numbers, and where soft tissue then
# peaks
STORED_OFFSETS = (1000, 1024)
SOFT_TISSUE_HU, SOFT_TISSUE_WINDOW = 40.0, (-60.0, 140.0)
# Label maps: few values, most neighbours equal
MOST_LABEL_VALUES, EQUAL_NEIGHBOURS = 1000, 0.8
# Share of the outer voxels above a threshold from which a volume would be seen as a box
BOX_SHARE = 0.4


def finite_sample(values: NDArray) -> NDArray:
    """Return finite values of every second voxel along each axis; one 0 where there are none.

    In their own type, because volumes are large; float16 as float32.
    """
    sample = values[::2, ::2, ::2].ravel()
    if sample.dtype.kind == "f":
        sample = sample[np.isfinite(sample)].astype(np.promote_types(sample.dtype, np.float32))
    return sample if sample.size else np.zeros(1)


def hu_offset(values: NDArray) -> float | None:
    """Number to add to values to get HU: 0, -1000 or -1024 for HU stored unsigned, None: not HU.

    HU is told by air near -1000. Unsigned HU is told by air near 0 and the peak of soft tissue
    (about 40 HU) above it, which also tells the two offsets apart.
    """
    sample = finite_sample(values)
    low, high = float(sample.min()), float(sample.max())
    if (-4000 <= low <= -500 and 200 < high < 60000) or (-1100 <= low <= -900 and 0 < high < 200):
        return 0.0
    if low < -100 or high < 1500 or high > 60000:
        return None
    counts, edges = np.histogram(sample, bins=np.arange(700, 1400, 8))
    peak = edges[int(np.argmax(counts))] + 4.0
    tissue = float(np.mean((sample >= 900) & (sample < 1200)))
    air = float(np.mean(sample < 300))
    offset = min(STORED_OFFSETS, key=lambda o: abs(peak - o - SOFT_TISSUE_HU))
    inside = SOFT_TISSUE_WINDOW[0] <= peak - offset <= SOFT_TISSUE_WINDOW[1]
    return -float(offset) if inside and tissue > 0.03 and air > 0.1 else None


def is_label_map(values: NDArray) -> bool:
    """Whether values look like labels: whole numbers from 0, few of them, equal to neighbours.

    Of the pairs of neighbours that both are not 0, most have to be equal, as they are not where
    numbers measure something.
    """
    if values.dtype.kind not in "iub" or not values.any() or values.min() < 0:
        return False
    if len(np.unique(values[::2, ::2, ::2])) > MOST_LABEL_VALUES:
        return False
    here, beside = values[:, :, :-1], values[:, :, 1:]
    both = (here != 0) & (beside != 0)
    return bool(both.any()) and float(np.mean((here == beside)[both])) > EQUAL_NEIGHBOURS


def spread(values: NDArray) -> tuple[float, float]:
    """Return the lowest value and the 99.9th percentile, the second above the first."""
    sample = finite_sample(values)
    low, high = float(sample.min()), float(np.percentile(sample, 99.9))
    if high <= low:
        high = float(sample.max())
    return (low, high) if high > low else (low, low + 1.0)


def threshold(values: NDArray) -> float:
    """Threshold that splits values into two classes of least variance (Otsu 1979)."""
    counts, edges = np.histogram(values, bins=256)
    middle = (edges[1:] + edges[:-1]) / 2
    below, above = np.cumsum(counts), np.cumsum(counts[::-1])[::-1]
    mean_below = np.cumsum(counts * middle) / np.maximum(below, 1)
    mean_above = (np.cumsum((counts * middle)[::-1]) / np.maximum(above[::-1], 1))[::-1]
    between = below[:-1] * above[1:] * (mean_below[:-1] - mean_above[1:]) ** 2
    best = np.flatnonzero(between == between.max())
    return float(edges[1 + int(best[len(best) // 2])])


def object_threshold(values: NDArray) -> float:
    """`threshold`, raised by percentiles while too many voxels of the outer faces lie above it.

    Without this, a volume that goes on beyond its faces would be seen as a box.
    """
    level = threshold(finite_sample(values))
    faces = np.concatenate(
        [np.take(values, end, axis).ravel() for axis in range(3) for end in (0, -1)]
    )
    faces = faces[np.isfinite(faces)].astype(np.float64)
    if faces.size and float(np.mean(faces > level)) > BOX_SHARE:
        level = max(level, float(np.quantile(faces, 1 - BOX_SHARE)))
    return level
