"""What stands around the volume in each pixel: where a camera ray ends, and what it shows.

Veils, which are translucent surfaces on its way, take no part in the walk: they lessen what was
found behind them, by the expected value instead of by chance.
"""

import math

import numpy as np

from .grid import INFINITE
from .jit import device
from .vec import dot, wide

f32, f64, i32 = np.float32, np.float64, np.int32
ZERO, ONE = f32(0.0), f32(1.0)
FAR = f64(INFINITE)
CLEAR = (0.0, 0.0, 0.0, 0.0)
PER_BYTE = 1.0 / 255.0


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
def covered(veils, pixel, depth):
    """What the veils of a place and pixel nearer than `depth` leave of what is behind them.

    Returns (share that is left, what they show: premultiplied (r, g, b, a)).
    """
    if veils is None:
        return 1.0, CLEAR
    left, r, g, b = 1.0, 0.0, 0.0, 0.0
    for k in range(veils.first[pixel], veils.first[pixel + 1]):
        if veils.depth[k] >= depth:
            break
        opacity = veils.colour[k, 3] * PER_BYTE
        weight = left * opacity * PER_BYTE
        r += weight * veils.colour[k, 0]
        g += weight * veils.colour[k, 1]
        b += weight * veils.colour[k, 2]
        left *= 1.0 - opacity
    return left, (r, g, b, 1.0 - left)


@device
def before(backdrop, place, d, hit, t):
    """`covered` for a ray that met something at distance t, or nothing before its end.

    `place` is (layer, row, column) of the backdrop.
    """
    if backdrop is None:
        return 1.0, CLEAR
    _, rows, columns = backdrop.depth.shape
    layer, i, j = place
    depth = t * dot(wide(d), backdrop.axis) if hit else FAR
    return covered(backdrop.veils, (layer * rows + i) * columns + j, depth)


@device
def accumulate_cover(plane, n, row, column, hit, left):
    """Update the mean of what the veils leave of the hits by sample number n, from 1."""
    if plane is None:
        return
    value = left if hit else 0.0
    plane[row, column] += (value - plane[row, column]) / n


@device
def accumulate_behind(plane, backdrop, n, row, column, place, hit, left, shown):
    """Update the mean of what shows beside the volume by sample number n, from 1.

    Veils show `shown` and leave `left` of the backdrop's colour, which hits show none of; `place`
    is (layer, row, column) of the backdrop.
    """
    if plane is None or backdrop is None:
        return
    layer, i, j = place
    weight = 1.0 / n
    for c in range(4):
        value = shown[c]
        if not hit:
            value += left * backdrop.colour[layer, i, j, c] * PER_BYTE
        plane[row, column, c] += (value - plane[row, column, c]) * weight


@device
def open_share(openings, row, column, T, depth, z, length, weight):
    """Share of what a stretch of a pixel's ray sends to the eye that the backdrop leaves open.

    The stretch goes from depth z along the view axis over `length` and has the optical depth
    `depth`, evenly; T is the transmittance to it. Edges on it get the transmittance to them, times
    `weight`.
    """
    if openings is None:
        return ONE
    pixel = row * openings.next.shape[1] + column
    first, last = openings.first[pixel], openings.first[pixel + 1]
    k = openings.next[row, column]
    share = openings.left[k - 1] if k > first else ONE
    if k == last or openings.depth[k] >= z + length:
        return share
    sent, a = ZERO, ZERO
    while k < last and openings.depth[k] < z + length:
        b = depth * max((openings.depth[k] - z) / length, ZERO)
        sent -= share * math.exp(-a) * math.expm1(a - b)
        openings.through[k] += weight * T * math.exp(-b)
        share, a, k = openings.left[k], b, k + 1
    openings.next[row, column] = k
    sent -= share * math.exp(-a) * math.expm1(a - depth)
    whole = -math.expm1(-depth)
    return min(sent / whole, ONE) if whole > ZERO else share


@device
def close_openings(openings, row, column, T, weight):
    """End a ray of a pixel: edges that it has not passed get its transmittance T times `weight`."""
    if openings is None:
        return
    pixel = row * openings.next.shape[1] + column
    for k in range(openings.next[row, column], openings.first[pixel + 1]):
        openings.through[k] += weight * T
    openings.next[row, column] = openings.first[pixel]


@device
def along_axis(openings, d):
    """Depth along the view axis per length of a ray."""
    if openings is None:
        return ONE
    return f32(dot(wide(d), openings.axis))
