"""Layers filled by the CPU: a row of a brick at a time, in steps that become vector code.

What `cone_layers` does for one pixel is done here for the pixels of a row of a brick at all planes
of a block together, its `lanes`, one plane after another. Each step reads and writes arrays of its
own in order; only `fetch` and `integrate` go where the scalar sends them.
"""

import numpy as np

from .cone_layers import (
    BRICK,
    ROWS,
    SEGMENT,
    brick_bounds,
    cells_are_empty,
    fill_stretch,
    pixel_ray,
    way_inside,
)
from .cone_runs import find_runs
from .cone_transfer import NOTHING, integrated_at, mean_between
from .jit import device, kernel
from .vec import at

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF = f32(0.0), f32(0.5)
NEXT = index(1)
# Most layers of a block, and lanes at its planes
MOST_LAYERS = 8
LANES = (MOST_LAYERS + 1) * BRICK
# Lane -> plane and pixel
PLANE, PIXEL = i32(3), i32(BRICK - 1)
# Where the second and further coordinates and corners begin
L1, L2, L3, L4, L5, L6, L7 = (index(n * LANES) for n in range(1, 8))


@device
def is_whole(clip, values, lo, hi):
    """Whether no ray of a brick within an index box enters or leaves the medium there."""
    if clip is not None:
        return False
    nz, ny, nx = values.shape
    return (
        lo[0] >= ZERO and lo[1] >= ZERO and lo[2] >= ZERO
        and hi[0] <= f32(nx - 1) and hi[1] <= f32(ny - 1) and hi[2] <= f32(nz - 1)
    )  # fmt: skip


@device
def measure(medium, block, whole, row, left, count, t):
    """Depths of the lanes behind the block's first plane: where a ray is in the medium, clamped."""
    if whole:
        for n in range((count + 1) * BRICK):
            t[index(n)] = block.thickness * f32(i32(n) >> PLANE)
        return
    for i in range(BRICK):
        o, d = pixel_ray(block, f32(left + i) + HALF, f32(row) + HALF)
        enter, leave = way_inside(medium, o, d, block.thickness * f32(count))
        if not enter < leave:
            enter, leave = ZERO, ZERO
        for plane in range(count + 1):
            t[index(plane * BRICK + i)] = min(max(block.thickness * f32(plane), enter), leave)


@device
def locate(values, block, row, left, number, t, cell, part):
    """Voxel before the index position of each lane, and what is left to the position."""
    nz, ny, nx = values.shape
    fx, fy, fz = f32(nx - 1), f32(ny - 1), f32(nz - 1)
    lx, ly, lz = i32(nx - 2), i32(ny - 2), i32(nz - 2)
    o, d = pixel_ray(block, f32(left) + HALF, f32(row) + HALF)
    u, v = block.first_x, block.deep_x
    for m in range(number):
        n = index(m)
        c = f32(i32(m) & PIXEL)
        x = min(max(o[0] + c * u[0] + t[n] * (d[0] + c * v[0]), ZERO), fx)
        y = min(max(o[1] + c * u[1] + t[n] * (d[1] + c * v[1]), ZERO), fy)
        z = min(max(o[2] + c * u[2] + t[n] * (d[2] + c * v[2]), ZERO), fz)
        i, j, k = min(i32(x), lx), min(i32(y), ly), min(i32(z), lz)
        cell[n], cell[n + L1], cell[n + L2] = i, j, k
        part[n], part[n + L1], part[n + L2] = x - f32(i), y - f32(j), z - f32(k)


@device
def fetch(shape, values, cell, number, corner):
    """The eight voxels around each lane."""
    row, plane = index(shape[2]), index(shape[1]) * index(shape[2])
    for m in range(number):
        n = index(m)
        at = index(cell[n + L2]) * plane + index(cell[n + L1]) * row + index(cell[n])
        corner[n] = values[at]
        corner[n + L1] = values[at + NEXT]
        corner[n + L2] = values[at + row]
        corner[n + L3] = values[at + row + NEXT]
        at += plane
        corner[n + L4] = values[at]
        corner[n + L5] = values[at + NEXT]
        corner[n + L6] = values[at + row]
        corner[n + L7] = values[at + row + NEXT]


@device
def interpolate(integrals, corner, part, number, entry):
    """Table position of each lane. Returns whether any may have extinction."""
    lowest, per_scalar, last = integrals.lowest, integrals.per_scalar, integrals.last
    clear, some = integrals.clear, i32(0)
    for m in range(number):
        n = index(m)
        fx, fy, fz = part[n], part[n + L1], part[n + L2]
        v000, v010 = f32(corner[n]), f32(corner[n + L2])
        v001, v011 = f32(corner[n + L4]), f32(corner[n + L6])
        c00 = v000 + (f32(corner[n + L1]) - v000) * fx
        c10 = v010 + (f32(corner[n + L3]) - v010) * fx
        c01 = v001 + (f32(corner[n + L5]) - v001) * fx
        c11 = v011 + (f32(corner[n + L7]) - v011) * fx
        c0, c1 = c00 + (c10 - c00) * fy, c01 + (c11 - c01) * fy
        scalar = c0 + (c1 - c0) * fz
        x = min(max((scalar - lowest) * per_scalar, ZERO), last)
        x = x if scalar == scalar else NOTHING
        some |= i32(x > clear)
        entry[n] = x
    return some != i32(0)


@device
def integrate(sigma_t, depth, lanes, number, last):
    """Extinction of each lane, and its integral over the table up to there."""
    for m in range(number):
        n = index(m)
        lanes.sigma_t[n], lanes.integral[n] = integrated_at(
            sigma_t, depth, i32(0), last, lanes.entry[n]
        )


@device
def put_stretches(planes, lanes, row, left, count):
    """Optical depth of all stretches between planes, into layers. Returns a bit for each filled."""
    t, entry, sigma_t, integral, out = (
        lanes.t, lanes.entry, lanes.sigma_t, lanes.integral, lanes.depth
    )  # fmt: skip
    for m in range(count * BRICK):
        n, after = index(m), index(m + BRICK)
        mean = mean_between(
            entry[n], entry[after], sigma_t[n], sigma_t[after], integral[n], integral[after]
        )
        out[n] = mean * (t[after] - t[n])
    filled = 0
    for layer in range(count):
        some = i32(0)
        for i in range(BRICK):
            depth = out[index(layer * BRICK + i)]
            planes[layer, row, index(left + i)] = depth
            some |= i32(depth > ZERO)
        filled |= (1 if some != i32(0) else 0) << layer
    return filled


@device
def keep_entries(front, back, entry, row, left, count):
    """Keep the table positions at both planes of every layer."""
    for layer in range(count):
        for i in range(BRICK):
            n = layer * BRICK + i
            front[layer, row, index(left + i)] = entry[index(n)]
            back[layer, row, index(left + i)] = entry[index(n + BRICK)]


@device
def fill_lanes(
    integral, medium, transfer, integrals, block, bleeding, layers, lanes, row, left, more
):
    """Layers of a row of a brick whose table positions are known. Returns a bit for each filled."""
    count = layers.depth.shape[0]
    number = (count + 1) * BRICK
    if integral is not None:
        # Extinction depends on the scalar alone
        integrate(integrals.sigma_t, integrals.depth, lanes, number, integrals.last)
        filled = put_stretches(layers.depth, lanes, row, left, count)
        if integrals.limited and filled != 0:
            integrate(integrals.whole, integrals.whole_depth, lanes, number, integrals.last)
            put_stretches(layers.whole, lanes, row, left, count)
        return filled
    filled = 0
    for i in range(BRICK):
        o, d = pixel_ray(block, f32(left + i) + HALF, f32(row) + HALF)
        for layer in range(count):
            n, after = index(layer * BRICK + i), index((layer + 1) * BRICK + i)
            front, back = lanes.t[n], lanes.t[after]
            if fill_stretch(
                medium, transfer, integrals, bleeding, layers, layer, row, index(left + i), front,
                back, lanes.entry[n], lanes.entry[after], at(o, d, HALF * (front + back)), more,
            ):  # fmt: skip
                filled |= 1 << layer
    return filled


@device
def fill_row(medium, transfer, integrals, block, bleeding, layers, lanes, row, left, more, whole):
    """Look up and fill the layers of a row of a brick. Returns a bit for each filled."""
    count = layers.depth.shape[0]
    number = (count + 1) * BRICK
    measure(medium, block, whole, row, left, count, lanes.t)
    locate(medium.values, block, row, left, number, lanes.t, lanes.cell, lanes.part)
    fetch(medium.values.shape, lanes.values, lanes.cell, number, lanes.corner)
    if not interpolate(integrals, lanes.corner, lanes.part, number, lanes.entry):
        return 0
    keep_entries(layers.front, layers.back, lanes.entry, row, left, count)
    return fill_lanes(
        lanes.integral, medium, transfer, integrals, block, bleeding, layers, lanes, row, left, more
    )


@kernel
def fill_rows(
    medium, transfer, integrals, block, bleeding, layers, filled, lanes, more, skip, row_0, row_1
):
    """Fill the layers of some rows. Returns the number of pixels times layers looked up.

    `more`: a further volume, added to what is there. `skip`: whether bricks of empty macrocells are
    passed over.
    """
    count, _, columns = layers.depth.shape
    deep = block.thickness * f32(count)
    looked_up = 0
    for top in range(row_0, row_1, ROWS):
        bottom = min(top + ROWS, row_1)
        for left in range(0, columns, BRICK):
            lo, hi = brick_bounds(
                block, f32(left), f32(top), f32(BRICK), f32(bottom - top), deep
            )
            if skip and cells_are_empty(medium, lo, hi):
                continue
            looked_up += count * (bottom - top) * BRICK
            whole = is_whole(medium.clip, medium.values, lo, hi)
            for row in range(top, bottom):
                dense = fill_row(
                    medium, transfer, integrals, block, bleeding, layers, lanes, row, left, more,
                    whole,
                )  # fmt: skip
                for layer in range(count):
                    if (dense >> layer) & 1 == 1:
                        filled.flags[layer, row, left // SEGMENT] = 2
        find_runs(filled, columns, top, bottom)
    return looked_up
