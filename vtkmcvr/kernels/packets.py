"""`tracking.walk` of many rays at once, in lanes of SIMD registers: the same estimators.

A ray by itself is one chain of steps, each of which waits for the one before: position, macrocell,
eight voxels, transfer function, decision. Here the rays of a pool take steps together, each either
to a tentative collision, where it waits, or to the next macrocell; then those that wait are looked
up and decided about. So the steps of different rays overlap, and decisions are no branches. A ray
that has ended makes room for the next one of the queue; none depends on which others there are.

Only media whose extinction is that of a table of scalars, one for each label: no holes, regions or
gradients.
"""

import numpy as np

from .elementary import atanh_series, logarithm
from .grid import trilinear
from .jit import device, launched
from .labels import label_row
from .lanes import WIDTH, mask, opposite, select, to_float
from .lanes_memory import gather, load, store
from .over_lanes import over_lanes
from .pool import (
    BX,
    BY,
    BZ,
    COLLIDES,
    CX,
    CY,
    CZ,
    DX,
    DY,
    DZ,
    END,
    LEFT,
    MAJORANT,
    NONE,
    ONE,
    OUT,
    OX,
    OY,
    OZ,
    POOL,
    SCALAR,
    SIGMA,
    STATUS,
    TAU,
    TX,
    TY,
    TZ,
    UNDER_WAY,
    ZERO,
    T,
    cell_of,
    replace_ended,
    set_out,
    take,
    to_walk,
)  # fmt: skip
from .rng import Stream, exponential, minus_logarithm, uniform, unit
from .tracking import VIOLATED
from .transfer import classify, extinction, of_label, row_start, table_position
from .vec import at

# Steps of all rays before the look-ups of those that have come to a tentative collision
STEPS = 2
FORWARD, BACK = np.int32(1), np.int32(-1)

unit = over_lanes(unit)
uniform = over_lanes(uniform)
atanh_series = over_lanes(atanh_series)
logarithm = over_lanes(logarithm)
minus_logarithm = over_lanes(minus_logarithm)
exponential = over_lanes(exponential)
table_position = over_lanes(table_position)
extinction = over_lanes(extinction)
label_row = over_lanes(label_row)
row_start = over_lanes(row_start)
of_label = over_lanes(of_label)
trilinear = over_lanes(trilinear)
classify = over_lanes(classify)


@device
def fetch_majorants(medium, pool, count):
    """Majorant of each ray's cell."""
    _, ny, nx = medium.majorant.shape
    for i in range(0, count, WIDTH):
        x, y, z = (
            load(pool.cells, CX * POOL + i),
            load(pool.cells, CY * POOL + i),
            load(pool.cells, CZ * POOL + i),
        )
        store(pool.floats, MAJORANT * POOL + i, gather(medium.majorant, (z * ny + y) * nx + x))


@device
def step_along(o, d, t, per_cell, n, cell, crossing, between, empty, along):
    """Cell along an axis after a leap or a step, and its next crossing."""
    step = select(d < ZERO, BACK, FORWARD)
    landed = cell_of(o + d * t, per_cell, n)
    after = select(empty, landed, cell + select(along, step, NONE))
    return after, crossing + between * to_float((after - cell) * step)


@device
def advance(medium, pool, count):
    """Move each ray under way to its tentative collision in its cell, or else to the next cell."""
    nz, ny, nx = medium.majorant.shape
    per_cell, f, c = medium.cells_per_index, pool.floats, pool.cells
    for i in range(0, count, WIDTH):
        majorant, t, tau, end = (
            load(f, MAJORANT * POOL + i),
            load(f, T * POOL + i),
            load(f, TAU * POOL + i),
            load(f, END * POOL + i),
        )
        tx, ty, tz = load(f, TX * POOL + i), load(f, TY * POOL + i), load(f, TZ * POOL + i)
        bx, by, bz = load(f, BX * POOL + i), load(f, BY * POOL + i), load(f, BZ * POOL + i)
        status = load(c, STATUS * POOL + i)
        going = status == UNDER_WAY
        # Where the ray leaves the cell, or the empty cube around it
        empty = majorant <= -ONE
        around = select(empty, -majorant, ZERO)
        leave = min(min(tx + around * bx, ty + around * by), min(tz + around * bz, end))
        reach = (leave - t) * majorant
        collides = opposite(empty) & (tau < reach)
        tentative = going & collides
        goes_on = going & opposite(collides)
        t = select(goes_on, leave, select(tentative, t + tau / majorant, t))
        store(f, T * POOL + i, t)
        store(f, TAU * POOL + i, select(goes_on & opposite(empty), tau - reach, tau))
        # Next cell
        across_x = goes_on & (tx <= ty) & (tx <= tz)
        across_y = goes_on & opposite(across_x) & (ty <= tz)
        across_z = goes_on & opposite(across_x) & opposite(across_y)
        x, tx = step_along(
            load(f, OX * POOL + i), load(f, DX * POOL + i), t, per_cell, nx,
            load(c, CX * POOL + i), tx, bx, empty, across_x,
        )  # fmt: skip
        y, ty = step_along(
            load(f, OY * POOL + i), load(f, DY * POOL + i), t, per_cell, ny,
            load(c, CY * POOL + i), ty, by, empty, across_y,
        )  # fmt: skip
        z, tz = step_along(
            load(f, OZ * POOL + i), load(f, DZ * POOL + i), t, per_cell, nz,
            load(c, CZ * POOL + i), tz, bz, empty, across_z,
        )  # fmt: skip
        outside = (x < NONE) | (x >= nx) | (y < NONE) | (y >= ny) | (z < NONE) | (z >= nz)
        store(f, TX * POOL + i, tx)
        store(f, TY * POOL + i, ty)
        store(f, TZ * POOL + i, tz)
        escaped = goes_on & ((t >= end) | outside)
        store(c, CX * POOL + i, select(escaped, NONE, x))
        store(c, CY * POOL + i, select(escaped, NONE, y))
        store(c, CZ * POOL + i, select(escaped, NONE, z))
        status = select(tentative, COLLIDES, select(escaped, OUT, status))
        store(c, STATUS * POOL + i, status)


@device
def look_up(medium, transfer, pool, count):
    """Scalar and extinction where each ray is."""
    f = pool.floats
    for i in range(0, count, WIDTH):
        o = (load(f, OX * POOL + i), load(f, OY * POOL + i), load(f, OZ * POOL + i))
        d = (load(f, DX * POOL + i), load(f, DY * POOL + i), load(f, DZ * POOL + i))
        p = at(o, d, load(f, T * POOL + i))
        # What nobody asks for is looked up where it is in the cache
        wanted = load(pool.cells, STATUS * POOL + i) == COLLIDES
        p = (select(wanted, p[0], ZERO), select(wanted, p[1], ZERO), select(wanted, p[2], ZERO))
        scalar, sigma_t = classify(
            transfer.gradient_opacity, transfer.table_2d, medium, transfer, p
        )
        store(f, SCALAR * POOL + i, scalar)
        store(f, SIGMA * POOL + i, sigma_t)


@device
def collide(pool, i, tentative):
    """Delta tracking: accept or reject tentative collisions. Returns (whether ended, rng).

    A ray that ends lets nothing through, or marks a violated majorant.
    """
    f = pool.floats
    majorant, sigma_t = load(f, MAJORANT * POOL + i), load(f, SIGMA * POOL + i)
    rng, u = uniform(Stream(load(pool.counters, i), None))
    violated = sigma_t > majorant
    store(f, SIGMA * POOL + i, select(violated, -VIOLATED, sigma_t))
    ended = tentative & (u * majorant < sigma_t)
    store(f, LEFT * POOL + i, select(ended, select(violated, VIOLATED, ZERO), ONE))
    return ended, rng


@device
def attenuate(roulette, pool, i, tentative):
    """Ratio tracking: lower the transmittance. Returns (whether ended, rng).

    Where nothing is drawn for roulette, the number is the next one's.
    """
    f, counter = pool.floats, load(pool.counters, i)
    majorant, sigma_t = load(f, MAJORANT * POOL + i), load(f, SIGMA * POOL + i)
    left = load(f, LEFT * POOL + i)
    left = select(tentative, left * (ONE - sigma_t / majorant), left)
    low = tentative & (left < roulette)
    violated = low & (sigma_t > majorant)
    rng, u = uniform(Stream(counter, None))
    died = low & (u * roulette >= left)
    left = select(low, roulette, left)
    left = select(violated, VIOLATED, select(died, ZERO, left))
    store(f, LEFT * POOL + i, left)
    return died | violated, Stream(select(low, rng.counter, counter), None)


@device
def decide(by_ratio, roulette, pool, count):
    """Decide about tentative collisions; draw how far it is to the next one."""
    f = pool.floats
    for i in range(0, count, WIDTH):
        status = load(pool.cells, STATUS * POOL + i)
        tentative, escaped = status == COLLIDES, mask(status == OUT)
        store(pool.cells, STATUS * POOL + i, UNDER_WAY)
        counter, tau = load(pool.counters, i), load(f, TAU * POOL + i)
        if by_ratio:
            ended, rng = attenuate(roulette, pool, i, tentative)
        else:
            ended, rng = collide(pool, i, tentative)
        decided = rng.counter
        rng, fresh = exponential(rng)
        store(f, TAU * POOL + i, select(tentative, fresh, tau))
        after = select(ended, decided, rng.counter)
        store(pool.counters, i, select(tentative, after, counter))
        pool.ended[i // WIDTH, 0] = mask(ended) | escaped
        pool.ended[i // WIDTH, 1] = escaped


@launched
def walk_queue(medium, transfer, by_ratio, roulette, queue, pool):
    """`tracking.walk` of all rays of a queue; `found` holds what they meet.

    A kernel by itself, for delta tracking and, with `by_ratio`, for ratio tracking.
    """
    set_out(medium, queue, queue.size[0])
    n = to_walk(queue, queue.size[0])
    # Lanes without a ray compute too: the cells of an earlier walk may lie outside of this grid
    for row in range(3):
        for lane in range(POOL):
            pool.cells[row, lane] = NONE
    for lane in range(POOL):
        pool.cells[STATUS, lane] = UNDER_WAY
    following = min(n, POOL)
    for k in range(following):
        take(queue, k, pool, k)
    count = following
    while count > 0:
        for _ in range(STEPS):
            fetch_majorants(medium, pool, count)
            advance(medium, pool, count)
        look_up(medium, transfer, pool, count)
        decide(by_ratio, roulette, pool, count)
        count, following = replace_ended(queue, n, pool, count, following)
