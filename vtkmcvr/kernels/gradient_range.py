"""Range of the gradient magnitude in each macrocell, and majorants that depend on it.

Inside a voxel the interpolated gradient is a convex combination of those at its corners, along each
index axis by itself (with weights of its own next to the border). Bounds of the components over a
cell's points are bounds inside it.
"""

import math

import numpy as np

from .jit import device, kernel

f32 = np.float32
# Interpolated gradients may exceed their exact bounds by a few float32 roundings
ROUNDING = f32(1e-4)
# Table positions likewise, in entries
SLACK = f32(1e-3)


@device
def difference(values, k, j, i, axis):
    """Central difference of the voxels, one-sided at the border, as the kernels' own gradient."""
    nz, ny, nx = values.shape
    n = nx if axis == 0 else (ny if axis == 1 else nz)
    at = i if axis == 0 else (j if axis == 1 else k)
    a, b = max(at - 1, 0), min(at + 1, n - 1)
    if axis == 0:
        return (f32(values[k, j, b]) - f32(values[k, j, a])) / f32(b - a)
    if axis == 1:
        return (f32(values[k, b, i]) - f32(values[k, a, i])) / f32(b - a)
    return (f32(values[b, j, i]) - f32(values[a, j, i])) / f32(b - a)


@device
def component_range(values, cell, cz, cy, cx, axis):
    """Smallest and largest difference along an axis over the points of a cell; NaN left out."""
    nz, ny, nx = values.shape
    low, high = f32(math.inf), f32(-math.inf)
    for k in range(cz * cell, min((cz + 1) * cell + 1, nz)):
        for j in range(cy * cell, min((cy + 1) * cell + 1, ny)):
            for i in range(cx * cell, min((cx + 1) * cell + 1, nx)):
                d = difference(values, k, j, i, axis)
                if d < low:
                    low = d
                if d > high:
                    high = d
    return low, high


@device
def magnitude_range(m, x, y, z):
    """Bounds of |m g| for components of g in the intervals x, y, z: interval arithmetic."""
    least, most = f32(0.0), f32(0.0)
    for row in m:
        middle, spread = f32(0.0), f32(0.0)
        for axis in range(3):
            low, high = (x, y, z)[axis]
            middle += row[axis] * f32(0.5) * (low + high)
            spread += abs(row[axis]) * f32(0.5) * (high - low)
        nearest = max(abs(middle) - spread, f32(0.0))
        farthest = abs(middle) + spread
        least += nearest * nearest
        most += farthest * farthest
    return math.sqrt(least) * (f32(1.0) - ROUNDING), math.sqrt(most) * (f32(1.0) + ROUNDING)


@kernel
def fill_gradient_ranges(values, m, cell, lowest, highest):
    """Range of the world-space gradient magnitude in every cell."""
    for cz in range(lowest.shape[0]):
        for cy in range(lowest.shape[1]):
            for cx in range(lowest.shape[2]):
                x = component_range(values, cell, cz, cy, cx, 0)
                y = component_range(values, cell, cz, cy, cx, 1)
                z = component_range(values, cell, cz, cy, cx, 2)
                low, high = f32(0.0), f32(0.0)
                if x[0] <= x[1] and y[0] <= y[1] and z[0] <= z[1]:
                    low, high = magnitude_range(m, x, y, z)
                lowest[cz, cy, cx] = low
                highest[cz, cy, cx] = high


@device
def entries_between(low, high, start, per_unit, n):
    """First and last entry of a clamped table of n that values from low to high may read."""
    first = math.floor(min(max((low - start) * per_unit - SLACK, f32(0.0)), f32(n - 1)))
    last = math.ceil(min(max((high - start) * per_unit + SLACK, f32(0.0)), f32(n - 1)))
    return int(first), int(last)


@kernel
def scale_majorants(majorant, lowest, highest, factor, per_gradient):
    """Multiply each cell's majorant by the largest factor over its range of gradients."""
    for cz in range(majorant.shape[0]):
        for cy in range(majorant.shape[1]):
            for cx in range(majorant.shape[2]):
                first, last = entries_between(
                    lowest[cz, cy, cx], highest[cz, cy, cx], f32(0.0), per_gradient, len(factor)
                )
                most = f32(0.0)
                for i in range(first, last + 1):
                    most = max(most, factor[i])
                majorant[cz, cy, cx] *= most


@kernel
def table_majorants(majorant, scalars, gradients, table, maxima):
    """Largest table entry over each cell's ranges of scalar and gradient, where it had any density.

    `scalars` and `gradients` are (lowest, highest) of the cells; `maxima` is `range_maxima` of each
    row.
    """
    rows, columns = table.sigma_t.shape
    for cz in range(majorant.shape[0]):
        for cy in range(majorant.shape[1]):
            for cx in range(majorant.shape[2]):
                if majorant[cz, cy, cx] > f32(0.0):
                    i0, i1 = entries_between(
                        scalars[0][cz, cy, cx], scalars[1][cz, cy, cx],
                        table.lowest, table.per_scalar, columns,
                    )  # fmt: skip
                    j0, j1 = entries_between(
                        gradients[0][cz, cy, cx], gradients[1][cz, cy, cx],
                        table.lowest_gradient, table.per_gradient, rows,
                    )  # fmt: skip
                    level = 0
                    while (2 << level) <= i1 - i0 + 1:
                        level += 1
                    most = f32(0.0)
                    for j in range(j0, j1 + 1):
                        row = maxima[j, level]
                        most = max(most, row[i0], row[i1 + 1 - (1 << level)])
                    majorant[cz, cy, cx] = most
