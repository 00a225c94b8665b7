"""Macrocells: range of the scalar in each, and the largest extinction that it can have.

The ranges depend on the voxels only. After an edit of the transfer function `cell_majorants` alone
runs again: one look-up a cell in a table of range maxima, no voxel touched. That answers the reason
for which Exposure Render declined macrocells (its section on Woodcock tracking).
"""

import math

import numpy as np

from .jit import device, kernel

f32 = np.float32
# Interpolated scalars and table look-ups may exceed their exact bounds by a few float32 roundings.
ROUNDING = f32(1e-6)
TABLE_SLACK = f32(1e-2)
EMPTY = f32(1e6)
# Neighbours (k, j, i) that precede a cell in storage order, as offsets to subtract
BEFORE = tuple(
    (dz, dy, dx)
    for dz in (0, 1)
    for dy in (-1, 0, 1)
    for dx in (-1, 0, 1)
    if (dz, dy, dx) > (0, 0, 0)
)


@device
def cell_range(values, cell, cz, cy, cx):
    """Smallest and largest voxel value that trilinear interpolation inside a cell can meet."""
    nz, ny, nx = values.shape
    lowest, highest = f32(math.inf), f32(-math.inf)
    for k in range(cz * cell, min((cz + 1) * cell + 1, nz)):
        for j in range(cy * cell, min((cy + 1) * cell + 1, ny)):
            for i in range(cx * cell, min((cx + 1) * cell + 1, nx)):
                v = f32(values[k, j, i])
                if v < lowest:
                    lowest = v
                if v > highest:
                    highest = v
    return lowest, highest


@kernel
def fill_cell_ranges(values, cell, lowest, highest, z_0, z_1):
    """Ranges of the cell layers z_0 to z_1; NaN voxels are ignored (they are transparent)."""
    for cz in range(z_0, z_1):
        for cy in range(lowest.shape[1]):
            for cx in range(lowest.shape[2]):
                a, b = cell_range(values, cell, cz, cy, cx)
                lowest[cz, cy, cx] = a
                highest[cz, cy, cx] = b


def range_maxima(table):
    """Sparse table: row r holds the maximum over 2^r entries from each start."""
    n = len(table)
    rows = [np.ascontiguousarray(table, f32)]
    half = 1
    while 2 * half <= n:
        ahead = np.minimum(np.arange(n) + half, n - 1)
        rows.append(np.maximum(rows[-1], rows[-1][ahead]))
        half *= 2
    return np.array(rows)


@kernel
def cell_majorants(lowest, highest, maxima, table_lowest, per_scalar, out):
    """Largest table entry between the two that enclose each cell's range of scalars."""
    last = maxima.shape[1] - 1
    for cz in range(out.shape[0]):
        for cy in range(out.shape[1]):
            for cx in range(out.shape[2]):
                a, b = lowest[cz, cy, cx], highest[cz, cy, cx]
                if not a <= b:
                    out[cz, cy, cx] = f32(0.0)
                    continue
                # A constant cell is interpolated without rounding, so that empty cells stay exactly
                # empty
                slack = TABLE_SLACK if a < b else f32(0.0)
                x = min(max((a - table_lowest) * per_scalar - slack, f32(0.0)), f32(last))
                y = min(max((b - table_lowest) * per_scalar + slack, f32(0.0)), f32(last))
                first, final = int(x), math.ceil(y)
                level = 0
                while (2 << level) <= final - first + 1:
                    level += 1
                m = max(maxima[level, first], maxima[level, final + 1 - (1 << level)])
                out[cz, cy, cx] = m * (f32(1.0) + ROUNDING)


@device
def nearest_before(radius, z, y, x, step):
    """One more than the smallest radius among the 13 neighbours that a sweep has already visited.

    `step` is 1 or -1, the direction of the sweep; beyond the grid all is empty.
    """
    nz, ny, nx = radius.shape
    best = EMPTY
    for dz, dy, dx in BEFORE:
        k, j, i = z - step * dz, y - step * dy, x - step * dx
        if 0 <= k < nz and 0 <= j < ny and 0 <= i < nx:
            if radius[k, j, i] + f32(1.0) < best:
                best = radius[k, j, i] + f32(1.0)
    return best


def mark_empty_cubes(majorant):
    """Replace zero majorants by minus the radius of the empty cube around the cell, in cells.

    Radius r: all cells up to r away along any axis are empty too. Two sweeps give the exact
    chessboard distance to the nearest occupied cell (Rosenfeld and Pfaltz, Pattern Recognition
    1(1), 1968), less one.
    """
    radius = np.where(majorant > 0, f32(0.0), EMPTY)
    sweep(radius, 1)
    sweep(radius, -1)
    empty = radius > 0
    majorant[empty] = f32(1.0) - radius[empty]


@kernel
def sweep(radius, step):
    """Propagate radii in storage order (step 1) or against it (step -1)."""
    nz, ny, nx = radius.shape
    for k in range(nz):
        for j in range(ny):
            for i in range(nx):
                z, y, x = k, j, i
                if step < 0:
                    z, y, x = nz - 1 - k, ny - 1 - j, nx - 1 - i
                if radius[z, y, x] > f32(0.0):
                    nearest = nearest_before(radius, z, y, x, step)
                    if nearest < radius[z, y, x]:
                        radius[z, y, x] = nearest


@kernel
def largest_gradient(values, world_from_index_gradient):
    """Largest world-space gradient magnitude over the voxels, by the kernel's own differences."""
    nz, ny, nx = values.shape
    m = world_from_index_gradient
    largest = 0.0
    for k in range(nz):
        k0, k1 = max(k - 1, 0), min(k + 1, nz - 1)
        for j in range(ny):
            j0, j1 = max(j - 1, 0), min(j + 1, ny - 1)
            for i in range(nx):
                i0, i1 = max(i - 1, 0), min(i + 1, nx - 1)
                x = (f32(values[k, j, i1]) - f32(values[k, j, i0])) / f32(i1 - i0)
                y = (f32(values[k, j1, i]) - f32(values[k, j0, i])) / f32(j1 - j0)
                z = (f32(values[k1, j, i]) - f32(values[k0, j, i])) / f32(k1 - k0)
                a = m[0][0] * x + m[0][1] * y + m[0][2] * z
                b = m[1][0] * x + m[1][1] * y + m[1][2] * z
                c = m[2][0] * x + m[2][1] * y + m[2][2] * z
                square = a * a + b * b + c * c
                if square > largest:
                    largest = square
    return math.sqrt(largest)
