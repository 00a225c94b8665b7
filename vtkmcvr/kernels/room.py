"""Room for paths in step: what a path needs later is kept here from stage to stage."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..packed import Sobol
from .jit import device
from .pool import (
    DISTANCE,
    FOUND_SCALAR,
    FOUND_SIGMA,
    THROUGH,
    Pool,
    Queue,
    enqueue,
    new_pool,
    new_queue,
    ray_of,
)  # fmt: skip
from .rng import Stream, stratified_exponential
from .scatter import blank_vertex
from .vec import BLACK, add, at

f32, f64, i32, i64 = np.float32, np.float64, np.int32, np.int64
ZERO, ONE = f32(0.0), f32(1.0)
NOWHERE = (ZERO, ZERO, ZERO)
# Not Python's own 0, for which Numba would compile each function that takes it once more
NO_RAYS = i64(0)
# Paths in step: as many as leave their state in the level 2 cache
PATHS = 2048
# Instead of a ray's number: nothing is in the way; nothing comes through; the path has ended, or it
# has met nothing at all
CLEAR, HIDDEN, ENDED, MISSED = i32(-1), i32(-2), i32(-3), i32(-4)
# Numbers that all stages share: the tile; the sample that may be due next; paths, and those of them
# that go on; events that they have had, and how many they may have
ROW_0, ROW_1, COLUMN_0, COLUMN_1, ROW, COLUMN, SAMPLE, TAKEN, LIVE, EVENTS, MOST = range(11)


class Room(NamedTuple):
    """Room for paths in step."""

    numbers: NDArray[np.int64]  # (MOST + 1,)
    sample: NDArray[np.int64]  # (PATHS, 3) row, column, number of the sample
    random: NDArray[np.uint64]  # (PATHS, 4) state of the random numbers
    live: NDArray[np.int32]  # (PATHS,) paths that go on, `numbers[LIVE]` of them
    ray: NDArray[np.int32]  # (PATHS,) number in the queue, or CLEAR, HIDDEN, ENDED or MISSED
    radiance: NDArray[np.float32]  # (PATHS, 3) so far
    throughput: NDArray[np.float32]  # (PATHS, 3) of the ray under way
    met: NDArray[np.float32]  # (PATHS, 3) radiance that it brings if it meets nothing on its way
    drawn: NDArray[np.float32]  # (PATHS, 3) radiance that a light brings if nothing is in the way
    # (PATHS,) of bytes, as `kept` reads them
    ahead: NDArray  # where a camera ray ends
    under_way: NDArray  # ray
    vertex: NDArray
    shadow: NDArray  # ray toward a light
    seen: NDArray  # what the camera sees
    # A stage reads what the rays of the one before have met, and queues its own
    first: Queue
    second: Queue
    pool: Pool


def new_room():
    """Room for a thread."""
    places = (np.zeros(PATHS, f"S{size}") for size in (64, 64, 192, 64, 64))
    return Room(
        np.zeros(MOST + 1, np.int64), np.zeros((PATHS, 3), np.int64),
        np.zeros((PATHS, 4), np.uint64), np.zeros(PATHS, np.int32), np.zeros(PATHS, np.int32),
        *(np.zeros((PATHS, 3), np.float32) for _ in range(4)), *places, new_queue(PATHS),
        new_queue(PATHS), new_pool(),
    )  # fmt: skip


# Random numbers


@device
def keep_random(net, room, i, rng):
    """Keep the random numbers of path i; `net` is that of `rng`."""
    room.random[i, 0] = rng.counter
    if net is not None:
        room.random[i, 1], room.random[i, 2] = net.key, net.place
        room.random[i, 3] = np.uint64(net.sets)


@device
def random_of(sobol, room, i):
    """Random numbers of path i, in a scene with or without Sobol points."""
    if sobol is None:
        return Stream(room.random[i, 0], sobol)
    net = Sobol(room.random[i, 1], room.random[i, 2], i64(room.random[i, 3]))
    return Stream(room.random[i, 0], net)


# Rays


@device
def set_off(room, queue, i, rays, o, d, length, rng):
    """Queue the ray of path i, if it has any length. Returns (rays in the queue, rng)."""
    room.ray[i] = CLEAR
    if not length > ZERO:
        return rays, rng
    rng, tau = stratified_exponential(rng)
    enqueue(queue, rays, o, d, length, tau, rng.counter)
    room.ray[i] = rays
    return rays + 1, rng


@device
def after_walk(sobol, room, queue, i):
    """Random numbers of path i after its walk."""
    k = room.ray[i]
    if k >= 0:
        room.random[i, 0] = queue.counter[k]
    return random_of(sobol, room, i)


@device
def collision(room, queue, i, enter):
    """First collision of path i: (t, index position, scalar, sigma_t); t < 0 without one."""
    k = room.ray[i]
    t, p, scalar, sigma_t = -1.0, NOWHERE, ZERO, ZERO
    if k >= 0:
        found = queue.found
        walked = found[k, DISTANCE]
        if walked >= ZERO:
            o, d = ray_of(queue, k)
            t, p = enter + f64(walked), at(o, d, walked)
            scalar, sigma_t = found[k, FOUND_SCALAR], found[k, FOUND_SIGMA]
    return t, p, scalar, sigma_t


@device
def passed(room, queue, i):
    """Transmittance of the shadow ray of path i."""
    k = room.ray[i]
    if k < 0:
        return ONE if k == CLEAR else ZERO
    return queue.found[k, THROUGH]


# Colours


@device
def colour_of(colours, i):
    """Row i of an array (n, 3)."""
    return colours[i, 0], colours[i, 1], colours[i, 2]


@device
def set_colour(colours, i, colour):
    """Write row i of an array (n, 3)."""
    colours[i, 0], colours[i, 1], colours[i, 2] = colour


@device
def add_light(room, i, light):
    """Add to what path i sends to the camera."""
    set_colour(room.radiance, i, add(colour_of(room.radiance, i), light))


# What is kept, as the type that is kept


@device
def no_end():
    """Direction of a camera ray, where it ends, light that it meets and the distance to it."""
    return NOWHERE, (0.0, i32(0), i32(0), i32(0)), i32(-1), ZERO


@device
def no_ray():
    """Ray under way: origin, direction; receiver in its way, at which distance, its triangle.

    And where the ray enters the volume.
    """
    return (0.0, 0.0, 0.0), NOWHERE, i32(-1), 0.0, i32(-1), 0.0


@device
def no_vertex(gloss, phase):
    """Scattering point."""
    return blank_vertex(gloss, phase, NOWHERE, NOWHERE, NOWHERE)


@device
def no_shadow():
    """Ray toward a light: origin, the same in index coordinates, direction, distance."""
    return NOWHERE, NOWHERE, NOWHERE, ZERO


@device
def nothing_seen():
    """Albedo, normal and distance of what the camera sees."""
    return BLACK, NOWHERE, -1.0
