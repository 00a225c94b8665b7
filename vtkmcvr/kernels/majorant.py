"""Macrocells: range of the scalar in each, and the largest extinction that it can have.

The ranges depend on the voxels only. After an edit of the transfer function `cell_majorants` alone
runs again: one look-up a cell in a table of range maxima, no voxel touched. That answers the reason
for which Exposure Render declined macrocells (its section on Woodcock tracking).
"""

import math

import numpy as np

from .jit import device, kernel

f32, i32 = np.float32, np.int32
# Interpolated scalars and table look-ups may exceed their exact bounds by a few float32 roundings.
ROUNDING = f32(1e-6)
TABLE_SLACK = f32(1e-2)
EMPTY = f32(1e6)
ZERO, ONE = f32(0.0), f32(1.0)
MANTISSA_BITS, EXPONENT_OF_ONE = i32(23), i32(127)


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
                # Logarithm to base 2, rounded down: the exponent of a float32
                level = (f32(final - first + 1).view(i32) >> MANTISSA_BITS) - EXPONENT_OF_ONE
                m = max(maxima[level, first], maxima[level, final + 1 - (1 << level)])
                out[cz, cy, cx] = m * (f32(1.0) + ROUNDING)


def mark_empty_cubes(majorant):
    """Replace zero majorants by minus the radius of the empty cube around the cell, in cells.

    Radius r: all cells up to r away along any axis are empty too. Two sweeps give the exact
    chessboard distance to the nearest occupied cell (Rosenfeld and Pfaltz, Pattern Recognition
    1(1), 1968), less one.
    """
    radius = np.where(majorant > 0, ZERO, EMPTY)
    near = np.empty(majorant.shape[2] + 2, f32)
    sweep(radius, 1, near)
    sweep(radius, -1, near)
    np.subtract(ONE, radius, out=majorant, where=radius > 0)


@device
def nearer(near, row):
    """Lower `near`, which has one more entry at either end, to a row of radii."""
    for i in range(len(row)):
        near[i + 1] = min(near[i + 1], row[i])


@kernel
def sweep(radius, step, near):
    """Propagate radii in storage order (step 1) or against it (step -1).

    A cell's radius is at most one more than that of any of the 13 neighbours that the sweep has
    visited: nine of the plane before, three of the row before, one. Beyond the grid all is empty.
    `near` is room for a row and two more.
    """
    nz, ny, nx = radius.shape
    for k in range(nz):
        z = k if step > 0 else nz - 1 - k
        for j in range(ny):
            y = j if step > 0 else ny - 1 - j
            near[:] = EMPTY
            if k > 0:
                for v in range(max(y - 1, 0), min(y + 2, ny)):
                    nearer(near, radius[z - step, v])
            if j > 0:
                nearer(near, radius[z, y - step])
            row, last = radius[z, y], EMPTY
            for i in range(nx):
                x = i if step > 0 else nx - 1 - i
                around = min(min(near[x], near[x + 1]), min(near[x + 2], last))
                last = min(row[x], around + ONE)
                row[x] = last


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
