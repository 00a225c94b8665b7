"""Optical depth of the medium in layers across the view axis, where there is any.

The film is cut into bricks of a few pixels by all layers of a block. A brick whose macrocells are
all empty costs one look at them.
"""

import math

import numpy as np

from .cone_transfer import NOTHING, clipped, entry_at, stretch_albedo, stretch_extinction
from .jit import device
from .vec import at

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Pixels of a segment, whole ones of which make a row; columns and rows of a brick
SEGMENT, BRICK, ROWS = 16, 8, 8


@device
def secant(perspective, column, row):
    """Length of the pixel's ray per length along the view axis."""
    if perspective is None:
        return ONE
    x = (column - perspective.eye_column) * perspective.slope
    y = (row - perspective.eye_row) * perspective.slope
    return math.sqrt(ONE + x * x + y * y)


@device
def pixel_ray(block, column, row):
    """Index position at the first plane, and its change per world unit along the view axis."""
    return (
        at(at(block.first, block.first_x, column), block.first_y, row),
        at(at(block.deep, block.deep_x, column), block.deep_y, row),
    )


@device
def inside(o, d, far, depth):
    """Interval of depths, within [0, depth], in which the ray is inside the volume."""
    t0, t1 = ZERO, depth
    for axis in range(3):
        if d[axis] == ZERO:
            if o[axis] < ZERO or o[axis] > far[axis]:
                t1 = -ONE
        else:
            inverse = ONE / d[axis]
            near, away = -o[axis] * inverse, (far[axis] - o[axis]) * inverse
            t0 = max(t0, min(near, away))
            t1 = min(t1, max(near, away))
    return t0, t1


@device
def cells_along(lo, hi, per_cell, n):
    """First and last cell that an interval of index coordinates touches; none: first > last."""
    if hi < ZERO or lo > f32(n) / per_cell:
        return i32(1), i32(0)
    return (
        i32(max(lo * per_cell, ZERO)),
        i32(min(hi * per_cell, f32(n - 1))),
    )


@device
def brick_bounds(block, column, row, columns, rows, depth):
    """Index box around a brick of pixels, from its first plane to a depth behind it."""
    lo, hi = (f32(1e30), f32(1e30), f32(1e30)), (f32(-1e30), f32(-1e30), f32(-1e30))
    for corner in range(4):
        o, d = pixel_ray(
            block, column + (columns if corner & 1 else ZERO), row + (rows if corner & 2 else ZERO)
        )
        e = at(o, d, depth)
        lo = (
            min(lo[0], min(o[0], e[0])), min(lo[1], min(o[1], e[1])), min(lo[2], min(o[2], e[2]))
        )  # fmt: skip
        hi = (
            max(hi[0], max(o[0], e[0])), max(hi[1], max(o[1], e[1])), max(hi[2], max(o[2], e[2]))
        )  # fmt: skip
    return lo, hi


@device
def cells_are_empty(medium, lo, hi):
    """Whether no macrocell in an index box holds anything."""
    majorant = medium.majorant
    nz, ny, nx = majorant.shape
    x0, x1 = cells_along(lo[0], hi[0], medium.cells_per_index, nx)
    y0, y1 = cells_along(lo[1], hi[1], medium.cells_per_index, ny)
    z0, z1 = cells_along(lo[2], hi[2], medium.cells_per_index, nz)
    for z in range(z0, z1 + 1):
        for y in range(y0, y1 + 1):
            for x in range(x0, x1 + 1):
                if majorant[index(z), index(y), index(x)] > ZERO:
                    return False
    return True


@device
def brick_is_empty(medium, block, column, row, columns, rows, depth):
    """Whether no macrocell around the brick of pixels holds anything."""
    lo, hi = brick_bounds(block, column, row, columns, rows, depth)
    return cells_are_empty(medium, lo, hi)


@device
def mix(mixed, layer, row, column, depth, albedo, more):
    """Colour of several volumes in one place, weighted by their extinction."""
    if mixed is None:
        return
    for c in range(3):
        before = mixed[c, layer, row, column] if more else ZERO
        mixed[c, layer, row, column] = before + depth * albedo[c]


@device
def tint(tinted, bleeding, layer, row, column, depth, albedo, more):
    """Optical depth for red, green and blue light; nothing where light has no colour.

    Light of a colour that the medium scatters well passes it more easily: the share `bleeding` of
    what is scattered goes on.
    """
    if tinted is None:
        return
    for c in range(3):
        before = tinted[c, layer, row, column] if more else ZERO
        tinted[c, layer, row, column] = before + depth * (ONE - bleeding * albedo[c])


@device
def dye(
    tinted, mixed, medium, transfer, integrals, bleeding, layer, row, column, depth, x, y, p, more
):  # fmt: skip
    """What depends on the albedo of a stretch, where anything does."""
    if tinted is None:
        if mixed is None:
            return
    albedo = (ZERO, ZERO, ZERO)
    if depth > ZERO:
        albedo = stretch_albedo(
            transfer.colour_grid, transfer.table_2d, medium.labels, medium, transfer, integrals,
            x, y, p,
        )  # fmt: skip
    mix(mixed, layer, row, column, depth, albedo, more)
    tint(tinted, bleeding, layer, row, column, depth, albedo, more)


@device
def fill_stretch(
    medium, transfer, integrals, bleeding, layers, layer, row, column, front, back, x, y, middle,
    more,
):  # fmt: skip
    """Fill a pixel of a layer whose ray is in the volume between two depths.

    Table positions go from x to y there. Returns whether there is anything.
    """
    depth, whole = ZERO, ZERO
    if front < back and max(x, y) > integrals.clear:
        sigma_t, sigma_whole = stretch_extinction(
            transfer.gradient_opacity, transfer.table_2d, medium.labels, medium, transfer,
            integrals, x, y, middle,
        )  # fmt: skip
        depth, whole = sigma_t * (back - front), sigma_whole * (back - front)
    filled = depth > ZERO
    dye(
        layers.tinted, layers.mixed, medium, transfer, integrals, bleeding, layer, row, column,
        depth, x, y, middle, more,
    )  # fmt: skip
    if more:
        depth += layers.depth[layer, row, column]
        if integrals.limited:
            whole += layers.whole[layer, row, column]
    layers.depth[layer, row, column] = depth
    if integrals.limited:
        layers.whole[layer, row, column] = whole
    return filled


@device
def way_inside(medium, o, d, depth):
    """Depths, within [0, depth], between which a ray is in the volume and not clipped."""
    nz, ny, nx = medium.values.shape
    enter, leave = inside(o, d, (f32(nx - 1), f32(ny - 1), f32(nz - 1)), depth)
    return clipped(medium.clip, o, d, enter, leave)


@device
def fill_pixel(medium, transfer, integrals, block, bleeding, layers, row, column, more):
    """All layers of one pixel, `more`: added to what is there. Returns a bit for each filled."""
    count = layers.depth.shape[0]
    o, d = pixel_ray(block, f32(column) + HALF, f32(row) + HALF)
    enter, leave = way_inside(medium, o, d, block.thickness * f32(count))
    filled = 0
    x = NOTHING
    if enter < leave:
        x = entry_at(medium, integrals, at(o, d, enter))
    for layer in range(count):
        layers.front[layer, row, column] = x
        back = min(block.thickness * f32(layer + 1), leave)
        if max(block.thickness * f32(layer), enter) < back:
            x = entry_at(medium, integrals, at(o, d, back))
        layers.back[layer, row, column] = x
    for layer in range(count):
        front = max(block.thickness * f32(layer), enter)
        back = min(block.thickness * f32(layer + 1), leave)
        if fill_stretch(
            medium, transfer, integrals, bleeding, layers, layer, row, column, front, back,
            layers.front[layer, row, column], layers.back[layer, row, column],
            at(o, d, HALF * (front + back)), more,
        ):  # fmt: skip
            filled |= 1 << layer
    return filled
