"""Optical depth of the medium in layers across the view axis, where there is any.

The film is cut into bricks of a few pixels by all layers of a block. A brick whose macrocells are
all empty costs one look at them.
"""

import math

import numpy as np

from .cone_transfer import NOTHING, entry_at, integral_at, stretch_albedo, stretch_extinction
from .jit import device, kernel
from .vec import at

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Pixels of a segment, rows of a brick
SEGMENT, ROWS = 16, 8


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
def brick_is_empty(medium, block, column, row, columns, rows, depth):
    """Whether no macrocell around the brick of pixels holds anything."""
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
def untint(tinted, layer, row, column):
    """Nothing for any colour."""
    if tinted is None:
        return
    for c in range(3):
        tinted[c, layer, row, column] = ZERO


@device
def tint(
    tinted, medium, transfer, integrals, bleeding, layer, row, column, depth, x, y, p
):  # fmt: skip
    """Optical depth for red, green and blue light; nothing where light has no colour.

    Light of a colour that the medium scatters well passes it more easily: the share `bleeding` of
    what is scattered goes on.
    """
    if tinted is None:
        return
    albedo = stretch_albedo(
        transfer.colour_grid, transfer.table_2d, medium, transfer, integrals, x, y, p
    )
    for c in range(3):
        tinted[c, layer, row, column] = depth * (ONE - bleeding * albedo[c])


@device
def fill_pixel(
    medium, transfer, integrals, block, perspective, bleeding, layers, transmittance, row, column,
    eye, opaque,
):  # fmt: skip
    """All layers of one pixel. Returns a bit for each layer with any depth, and for each seen."""
    count = layers.depth.shape[0]
    o, d = pixel_ray(block, f32(column) + HALF, f32(row) + HALF)
    nz, ny, nx = medium.values.shape
    far = (f32(nx - 1), f32(ny - 1), f32(nz - 1))
    enter, leave = inside(o, d, far, block.thickness * f32(count))
    oblique = secant(perspective, f32(column) + HALF, f32(row) + HALF)
    T = transmittance[row, column]
    filled, seen = 0, 0
    x = NOTHING
    before = 0.0
    if enter < leave:
        x = entry_at(medium, integrals, at(o, d, enter))
        before = integral_at(integrals, x)
    for layer in range(count):
        depth, visible = ZERO, ZERO
        first = x
        front = max(block.thickness * f32(layer), enter)
        back = min(block.thickness * f32(layer + 1), leave)
        if front < back:
            y = entry_at(medium, integrals, at(o, d, back))
            if max(x, y) > integrals.clear:
                sigma_t, before = stretch_extinction(
                    transfer.gradient_opacity, transfer.table_2d, medium, transfer, integrals,
                    x, y, before, at(o, d, HALF * (front + back)),
                )  # fmt: skip
                depth = sigma_t * (back - front)
            x = y
        if depth > ZERO:
            filled |= 1 << layer
            middle = at(o, d, block.thickness * (f32(layer) + HALF))
            tint(
                layers.tinted, medium, transfer, integrals, bleeding, layer, row, column, depth,
                first, x, middle,
            )  # fmt: skip
            if eye and T > opaque:
                visible = T
                seen |= 1 << layer
                layers.front[layer, row, column] = first
                layers.back[layer, row, column] = x
                T *= math.exp(-depth * oblique)
        else:
            untint(layers.tinted, layer, row, column)
        layers.depth[layer, row, column] = depth
        layers.seen[layer, row, column] = visible
    transmittance[row, column] = T
    return filled, seen


@device
def clear_brick(layers, filled, visible, row_0, row_1, segment):
    """Make what an earlier block left in a brick empty."""
    first = segment * SEGMENT
    last = min(first + SEGMENT, layers.depth.shape[2])
    for layer in range(layers.depth.shape[0]):
        for row in range(row_0, row_1):
            if filled.flags[layer, row, segment]:
                for column in range(first, last):
                    layers.seen[layer, row, column] = ZERO
                filled.flags[layer, row, segment] = False
                visible.flags[layer, row, segment] = False


@device
def find_runs(runs, columns, row_0, row_1):
    """Stretches of flagged segments in some rows of every layer."""
    for layer in range(runs.flags.shape[0]):
        for row in range(row_0, row_1):
            n = 0
            before = False
            for segment in range(runs.flags.shape[2]):
                now = runs.flags[layer, row, segment]
                if now:
                    if not before:
                        runs.start[layer, row, n] = segment * SEGMENT
                        n += 1
                    runs.end[layer, row, n - 1] = min((segment + 1) * SEGMENT, columns)
                before = now
            runs.count[layer, row] = n


@kernel
def fill_rows(
    medium, transfer, integrals, block, perspective, bleeding, layers, filled, visible,
    transmittance, image, opaque, skip, row_0, row_1,
):  # fmt: skip
    """Fill the layers of some rows. Returns the number of pixels times layers looked up.

    `image` is (first column, first row, end column, end row) of what the eye sees; the layers may
    reach beyond it. Rays whose transmittance is below `opaque` see no more. `skip`: whether bricks
    of empty macrocells are passed over.
    """
    count, _, columns = layers.depth.shape
    deep = block.thickness * f32(count)
    looked_up = 0
    for top in range(row_0, row_1, ROWS):
        bottom = min(top + ROWS, row_1)
        for segment in range(filled.flags.shape[2]):
            left = segment * SEGMENT
            right = min(left + SEGMENT, columns)
            if skip and brick_is_empty(
                medium, block, f32(left), f32(top), f32(right - left), f32(bottom - top), deep
            ):
                clear_brick(layers, filled, visible, top, bottom, segment)
                continue
            looked_up += count * (bottom - top) * (right - left)
            for row in range(top, bottom):
                dense, seen = 0, 0
                eye = image[1] <= row < image[3]
                for column in range(left, right):
                    a, b = fill_pixel(
                        medium, transfer, integrals, block, perspective, bleeding, layers,
                        transmittance, row, column, eye and image[0] <= column < image[2], opaque,
                    )  # fmt: skip
                    dense |= a
                    seen |= b
                for layer in range(count):
                    filled.flags[layer, row, segment] = (dense >> layer) & 1 == 1
                    visible.flags[layer, row, segment] = (seen >> layer) & 1 == 1
        find_runs(filled, columns, top, bottom)
        find_runs(visible, columns, top, bottom)
    return looked_up


@kernel
def number_runs(runs):
    """Give every run its place in compact arrays. Returns their length."""
    total = 0
    for layer in range(runs.count.shape[0]):
        for row in range(runs.count.shape[1]):
            for i in range(runs.count[layer, row]):
                runs.slot[layer, row, i] = total
                total += runs.end[layer, row, i] - runs.start[layer, row, i]
    return total
