"""What stands behind the volume in each pixel: where a camera ray ends, and what it shows there."""

import numpy as np

from .grid import INFINITE
from .jit import device
from .vec import dot, wide

f64, i32 = np.float64, np.int32
FAR = f64(INFINITE)


@device
def nearest_layer(offsets, x, y):
    """Layer whose sample position is nearest to (x, y) from the pixel's corner."""
    nearest, least = i32(0), FAR
    for i in range(len(offsets)):
        u, v = x - offsets[i, 0], y - offsets[i, 1]
        distance = u * u + v * v
        if distance < least:
            nearest, least = i32(i), distance
    return nearest


@device
def ray_end(backdrop, x, y, d):
    """Distance at which the ray d through film position (x, y) ends, and in which layer and pixel.

    Returns (distance, layer, row, column).
    """
    if backdrop is None:
        return FAR, i32(0), i32(0), i32(0)
    _, rows, columns = backdrop.depth.shape
    column = min(max(i32(np.floor(x)), i32(0)), i32(columns - 1))
    row = min(max(i32(np.floor(y)), i32(0)), i32(rows - 1))
    layer = nearest_layer(backdrop.offsets, x - column, y - row)
    depth = f64(backdrop.depth[layer, row, column])
    return min(depth / dot(wide(d), backdrop.axis), FAR), layer, row, column


@device
def accumulate_behind(plane, backdrop, n, row, column, place, hit):
    """Update the mean of what shows behind the volume by sample number n, from 1; hits show none.

    `place` is (layer, row, column) of the backdrop.
    """
    if plane is None or backdrop is None:
        return
    layer, i, j = place
    weight = 1.0 / n
    for c in range(4):
        value = 0.0
        if not hit:
            value = backdrop.colour[layer, i, j, c] * (1.0 / 255.0)
        plane[row, column, c] += (value - plane[row, column, c]) * weight
