"""Room for paths in step: what a path needs later is kept here from stage to stage."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..packed import Sobol
from .jit import device
from .kept import keep, kept
from .lanes import WIDTH
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
from .scatter import blank_vertex, of_material
from .vec import BLACK, add, at

f32, f64, i32, i64 = np.float32, np.float64, np.int32, np.int64
ZERO = f32(0.0)
NOWHERE = (ZERO, ZERO, ZERO)
# Paths in step: as many as leave their state in the level 2 cache
PATHS = 2048
# Numbers that all stages share: the tile; the sample that may be due next; paths, and those of them
# that go on; events that they have had, and how many they may have
ROW_0, ROW_1, COLUMN_0, COLUMN_1, ROW, COLUMN, SAMPLE, TAKEN, LIVE, EVENTS, MOST = range(11)


class Room(NamedTuple):
    """Room for paths in step.

    Paths that go on have places without a gap. Stages take `WIDTH` at a time: places up to the next
    multiple hold copies of other paths, which add to no picture.
    """

    numbers: NDArray[np.int64]  # (MOST + 1,)
    # Of every path of the batch; a last column is that of copies
    sample: NDArray[np.int64]  # (3, PATHS) row, column, number of the sample
    radiance: NDArray[np.float32]  # (3, PATHS + 1) so far
    missed: NDArray[np.bool_]  # (PATHS,) whether the camera ray has met nothing
    ahead: NDArray  # (PATHS,) camera ray, and where it ends
    seen: NDArray  # (PATHS + 1,) what the camera sees
    # Of every path that goes on, by place
    path: NDArray[np.int32]  # (PATHS,) number in the batch
    before: NDArray[np.int32]  # (PATHS,) place before the last event
    random: NDArray[np.uint64]  # (4, PATHS) state of the random numbers
    throughput: NDArray[np.float32]  # (3, PATHS) of the ray under way
    met: NDArray[np.float32]  # (3, PATHS) radiance that it brings if it meets nothing on its way
    drawn: NDArray[np.float32]  # (3, PATHS) radiance that a light brings if nothing is in the way
    chance: NDArray[np.float32]  # (2, PATHS) opacity, -1 where no gradient is asked for; variate
    asking: NDArray[np.int32]  # (PATHS,) places that ask for a gradient
    gradient: NDArray[np.float32]  # (3, PATHS) index position where it is wanted; then gradient
    # (PATHS,) as `kept` reads them
    under_way: NDArray  # ray
    event: NDArray  # scattering point, but for its material
    material: NDArray | None  # None: that of the scene everywhere
    shadow: NDArray  # ray toward a light
    # A stage reads what the rays of the one before have met, and queues its own
    first: Queue
    second: Queue
    pool: Pool


def new_room():
    """Room for a thread."""
    ahead, under_way, event, material, shadow = (
        np.zeros(PATHS, f"S{size}") for size in (80, 64, 96, 32, 40)
    )
    return Room(
        np.zeros(MOST + 1, np.int64), np.zeros((3, PATHS), np.int64),
        np.zeros((3, PATHS + 1), np.float32), np.zeros(PATHS, np.bool_), ahead,
        np.zeros(PATHS + 1, "S32"),
        np.zeros(PATHS, np.int32), np.zeros(PATHS, np.int32), np.zeros((4, PATHS), np.uint64),
        *(np.zeros((k, PATHS), np.float32) for k in (3, 3, 3, 2)), np.zeros(PATHS, np.int32),
        np.zeros((3, PATHS), np.float32), under_way, event, material, shadow, new_queue(PATHS),
        new_queue(PATHS), new_pool(),
    )  # fmt: skip


@device
def whole(n):
    """N up to the next multiple of `WIDTH`."""
    return (n + i64(WIDTH - 1)) & i64(-WIDTH)


# Random numbers


@device
def keep_random(net, room, i, rng):
    """Keep the random numbers of path i; `net` is that of `rng`."""
    room.random[0, i] = rng.counter
    if net is not None:
        room.random[1, i], room.random[2, i] = net.key, net.place
        room.random[3, i] = np.uint64(net.sets)


@device
def random_of(sobol, room, i):
    """Random numbers of path i, in a scene with or without Sobol points."""
    if sobol is None:
        return Stream(room.random[0, i], sobol)
    net = Sobol(room.random[1, i], room.random[2, i], i64(room.random[3, i]))
    return Stream(room.random[0, i], net)


# Rays


@device
def set_off(queue, i, o, d, length, rng):
    """Queue the ray of path i, if it has any length. Returns rng."""
    after, tau = stratified_exponential(rng)
    walks = length > ZERO
    rng = after if walks else rng
    enqueue(queue, i, o, d, length if walks else ZERO, tau, rng.counter)
    return rng


@device
def after_walk(sobol, room, queue, i):
    """Random numbers of path i after its walk."""
    rng = random_of(sobol, room, i)
    return Stream(queue.counter[i], rng.net)


@device
def collision(queue, i, enter):
    """First collision of path i: (t, index position, scalar, sigma_t); t < 0 without one."""
    found = queue.found
    walked = found[DISTANCE, i]
    o, d = ray_of(queue, i)
    t = enter + f64(walked) if walked >= ZERO else -1.0
    return t, at(o, d, walked), found[FOUND_SCALAR, i], found[FOUND_SIGMA, i]


@device
def passed(queue, i):
    """Transmittance of the shadow ray of path i."""
    return queue.found[THROUGH, i]


@device
def meets(room, i):
    """Whether the ray under way of path i meets something."""
    _, _, receiver, _, _, _ = kept(room.under_way, i, no_ray())
    return room.first.found[DISTANCE, i] >= ZERO or receiver >= 0


# Colours


@device
def colour_of(colours, i):
    """Column i of an array (3, n)."""
    return colours[0, i], colours[1, i], colours[2, i]


@device
def set_colour(colours, i, colour):
    """Write column i of an array (3, n)."""
    colours[0, i], colours[1, i], colours[2, i] = colour


@device
def add_light(room, i, light):
    """Add to what path number i of the batch sends to the camera."""
    set_colour(room.radiance, i, add(colour_of(room.radiance, i), light))


# What is kept, as the type that is kept


@device
def no_end():
    """Camera ray, where it ends, light that it meets and the distance to it."""
    return (0.0, 0.0, 0.0), NOWHERE, (0.0, i32(0), i32(0), i32(0)), i32(-1), ZERO


@device
def no_ray():
    """Ray under way: origin, direction; receiver in its way, at which distance, its triangle.

    And where the ray enters the volume.
    """
    return (0.0, 0.0, 0.0), NOWHERE, i32(-1), 0.0, i32(-1), 0.0


@device
def no_event():
    """Scattering point as of a medium without gloss or phase function, and the distance to it."""
    return blank_vertex(None, None, NOWHERE, NOWHERE, NOWHERE), 0.0


@device
def no_material(gloss, phase):
    """Gloss and phase function of a scattering point."""
    v = blank_vertex(gloss, phase, NOWHERE, NOWHERE, NOWHERE)
    return v.gloss, v.phase


@device
def keep_material(material, i, gloss, phase, v):
    """Keep the material of a scattering point, if it is not the same everywhere."""
    if material is not None:
        keep(material, i, (v.gloss, v.phase), no_material(gloss, phase))


@device
def material_of(material, i, gloss, phase):
    """Material of the scattering point of path i: the scene's, or its own."""
    if material is None:
        return gloss, phase
    return kept(material, i, no_material(gloss, phase))


@device
def keep_vertex(room, i, gloss, phase, v, t):
    """Keep the scattering point of path i, at distance t; gloss and phase are the scene's."""
    keep(room.event, i, (of_material(v, None, None), t), no_event())
    keep_material(room.material, i, gloss, phase, v)


@device
def vertex_of(room, i, gloss, phase):
    """Scattering point of path i."""
    v, _ = kept(room.event, i, no_event())
    gloss, phase = material_of(room.material, i, gloss, phase)
    return of_material(v, gloss, phase)


@device
def no_shadow():
    """Ray toward a light: origin, the same in index coordinates, direction, distance."""
    return NOWHERE, NOWHERE, NOWHERE, ZERO


@device
def nothing_seen():
    """Albedo, normal and distance of what the camera sees."""
    return BLACK, NOWHERE, -1.0
