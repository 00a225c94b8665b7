"""Rays that wait in a queue for their walk through the medium, and those under way in a pool."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .jit import device
from .lanes import WIDTH, highest_bit
from .lanes_memory import load, store
from .over_lanes import over_lanes
from .tracking import ESCAPED, first_cell, first_crossing

u32 = np.uint32
ZERO, ONE = np.float32(0.0), np.float32(1.0)
NONE = np.int32(0)
BIT = u32(1)

# Rays under way: a multiple of WIDTH that keeps their state in the level 1 cache
POOL = 4 * WIDTH
# Rows of a ray's state: origin, direction, end; optical depth to go; next crossing of a cell face
# along each axis, and distance between crossings; distance, transmittance
OX, OY, OZ, DX, DY, DZ, END, TAU, TX, TY, TZ, BX, BY, BZ, T, LEFT = range(16)
# Rows of the pool alone: what has been looked up
MAJORANT, SCALAR, SIGMA = range(16, 19)
STATE, FLOATS = 16, 19
# Rows of whole numbers: cell, and how far it has come
CX, CY, CZ, STATUS = range(4)
UNDER_WAY, COLLIDES, OUT = np.int32(0), np.int32(1), np.int32(2)
# Rows of what a ray meets: as `tracking.walk` returns it
DISTANCE, THROUGH, FOUND_SCALAR, FOUND_SIGMA = range(4)

cell_of = over_lanes(first_cell)
crossing_of = over_lanes(first_crossing)


class Pool(NamedTuple):
    """State of the rays under way."""

    floats: NDArray[np.float32]  # (FLOATS, POOL)
    cells: NDArray[np.int32]  # (4, POOL)
    counters: NDArray[np.uint64]  # (POOL,)
    rays: NDArray[np.int32]  # (POOL,) place in the queue
    ended: NDArray[np.uint32]  # (POOL / WIDTH, 2) bits: ended; escaped


class Queue(NamedTuple):
    """Rays to walk, those that have any length, and what they meet."""

    floats: NDArray[np.float32]  # (STATE, n)
    cells: NDArray[np.int32]  # (3, n)
    counter: NDArray[np.uint64]  # (n,) of random numbers, before and after
    found: NDArray[np.float32]  # (4, n) rows below
    order: NDArray[np.int32]  # (n,) those to walk
    size: NDArray[np.int64]  # (1,) rays in it


def new_pool():
    """Pool without rays."""
    return Pool(
        np.zeros((FLOATS, POOL), np.float32), np.zeros((4, POOL), np.int32),
        np.zeros(POOL, np.uint64), np.zeros(POOL, np.int32),
        np.zeros((POOL // WIDTH, 2), np.uint32),
    )  # fmt: skip


def new_queue(n):
    """Queue with room for n rays, a multiple of `WIDTH`."""
    return Queue(
        np.zeros((STATE, n), np.float32), np.zeros((3, n), np.int32), np.zeros(n, np.uint64),
        np.zeros((4, n), np.float32), np.zeros(n, np.int32), np.zeros(1, np.int64),
    )  # fmt: skip


@device
def enqueue(queue, k, o, d, length, tau, counter):
    """Write ray number k: origin and direction in index coordinates, length in world units.

    One without length is not walked: it meets nothing, and all comes through.
    """
    f = queue.floats
    f[OX, k], f[OY, k], f[OZ, k] = o
    f[DX, k], f[DY, k], f[DZ, k] = d
    f[END, k] = length
    f[TAU, k] = tau
    queue.counter[k] = counter
    queue.found[DISTANCE, k] = ESCAPED
    queue.found[THROUGH, k] = ONE


@device
def ray_of(queue, k):
    """Origin and direction of ray number k."""
    f = queue.floats
    return (f[OX, k], f[OY, k], f[OZ, k]), (f[DX, k], f[DY, k], f[DZ, k])


@device
def set_out_along(medium, queue, k, axis, n):
    """First cell of rays k and following ones along an axis, and where they leave it."""
    f = queue.floats
    columns = f.shape[1]
    o, d = load(f, (OX + axis) * columns + k), load(f, (DX + axis) * columns + k)
    cell = cell_of(o, medium.cells_per_index, n)
    crossing, between, _ = crossing_of(o, d, cell, medium.cell_size)
    store(queue.cells, axis * columns + k, cell)
    store(f, (TX + axis) * columns + k, crossing)
    store(f, (BX + axis) * columns + k, between)


@device
def to_walk(queue, n):
    """Find those of n rays that have any length. Returns how many."""
    count = 0
    for k in range(n):
        queue.order[count] = k
        count += queue.floats[END, k] > ZERO
    return count


@device
def set_out(medium, queue, n):
    """Put n rays of a queue at their starts."""
    cells = medium.majorant.shape
    for k in range(0, n, WIDTH):
        for axis in range(3):
            set_out_along(medium, queue, k, axis, cells[2 - axis])


@device
def take(queue, k, pool, lane):
    """Put the k-th ray that is to walk into a lane of the pool."""
    k = queue.order[k]
    for row in range(T):
        pool.floats[row, lane] = queue.floats[row, k]
    pool.floats[T, lane] = ZERO
    pool.floats[LEFT, lane] = ONE
    for row in range(3):
        pool.cells[row, lane] = queue.cells[row, k]
    pool.counters[lane] = queue.counter[k]
    pool.rays[lane] = k


@device
def write_found(queue, pool, lane, escaped):
    """Write what the ray of a lane has met."""
    k, f = pool.rays[lane], pool.floats
    queue.counter[k] = pool.counters[lane]
    queue.found[DISTANCE, k] = ESCAPED if escaped else f[T, lane]
    queue.found[THROUGH, k] = f[LEFT, lane]
    queue.found[FOUND_SCALAR, k] = f[SCALAR, lane]
    queue.found[FOUND_SIGMA, k] = f[SIGMA, lane]


@device
def move_lane(pool, here, there):
    """Move a ray from lane `there` to lane `here`."""
    for row in range(STATE):
        pool.floats[row, here] = pool.floats[row, there]
    for row in range(3):
        pool.cells[row, here] = pool.cells[row, there]
    pool.counters[here] = pool.counters[there]
    pool.rays[here] = pool.rays[there]


@device
def replace_ended(queue, n, pool, count, following):
    """Write what ended rays have met, and put the next ones of the queue in their place.

    From the last lane down: where the queue is empty, the last ray fills the gap. Returns (rays
    under way, next ray of the queue).
    """
    for group in range((count - 1) // WIDTH, -1, -1):
        ended, escaped = pool.ended[group, 0], pool.ended[group, 1]
        while ended != u32(0):
            bit = highest_bit(ended)
            ended = u32(ended ^ (BIT << u32(bit)))
            lane = group * WIDTH + bit
            # A lane without a ray goes on computing; its cell has to be one
            for row in range(3):
                pool.cells[row, lane] = NONE
            if lane >= count:
                continue
            write_found(queue, pool, lane, (escaped >> u32(bit)) & BIT != u32(0))
            if following < n:
                take(queue, following, pool, lane)
                following += 1
            else:
                count -= 1
                move_lane(pool, lane, count)
    return count, following
