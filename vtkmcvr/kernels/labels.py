"""Label maps: which row of the transfer tables a point has, and majorants over all rows."""

import math

import numpy as np

from .jit import device, kernel
from .majorant import ROUNDING, TABLE_SLACK

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF = f32(0.0), f32(0.5)


@device
def point(rows, i, j, k):
    """Row of a point."""
    return rows[index(k), index(j), index(i)]


@device
def label_row(rows, p):
    """Row of the voxel nearest to index position p."""
    nz, ny, nx = rows.shape
    i = min(max(i32(p[0] + HALF), i32(0)), i32(nx - 1))
    j = min(max(i32(p[1] + HALF), i32(0)), i32(ny - 1))
    k = min(max(i32(p[2] + HALF), i32(0)), i32(nz - 1))
    return point(rows, i, j, k)


@kernel
def label_majorants(
    lowest, highest, rows, cell, maxima, entries, table_lowest, per_scalar, out, z_0, z_1
):
    """Largest entry that a cell's scalars can meet in the rows of its voxels, for layers of cells.

    `maxima` are the `range_maxima` of all rows' tables, one after another.
    """
    nz, ny, nx = rows.shape
    last = f32(entries - 1)
    for cz in range(z_0, z_1):
        for cy in range(out.shape[1]):
            for cx in range(out.shape[2]):
                a, b = lowest[cz, cy, cx], highest[cz, cy, cx]
                out[cz, cy, cx] = ZERO
                if not a <= b:
                    continue
                slack = TABLE_SLACK if a < b else ZERO
                x = min(max((a - table_lowest) * per_scalar - slack, ZERO), last)
                y = min(max((b - table_lowest) * per_scalar + slack, ZERO), last)
                first, final = int(x), math.ceil(y)
                level = 0
                while (2 << level) <= final - first + 1:
                    level += 1
                second = final + 1 - (1 << level)
                largest, seen = ZERO, -1
                for k in range(cz * cell, min((cz + 1) * cell + 1, nz)):
                    for j in range(cy * cell, min((cy + 1) * cell + 1, ny)):
                        for i in range(cx * cell, min((cx + 1) * cell + 1, nx)):
                            row = int(rows[k, j, i])
                            if row != seen:
                                seen = row
                                start = row * entries
                                m = max(maxima[level, start + first], maxima[level, start + second])
                                largest = max(largest, m)
                out[cz, cy, cx] = largest * (f32(1.0) + ROUNDING)
