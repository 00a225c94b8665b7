"""Paths in step on the CPU, stage by stage: their rays, what these meet, and the film.

What GPUs do to keep their threads alike ("wavefront" path tracing: Laine, Karras and Aila,
"Megakernels considered harmful", HPG 2013) serves SIMD lanes, branch prediction and compilation
here. The same functions as in `path.radiance`. Walks through the medium, in `packets`, have lanes
of their own; the other stages are loops over paths, whose turns LLVM puts side by side (`loops`).
`surface_stages` and `light_stages` have those of what is met. Each stage is a kernel, compiled and
cached by itself, and takes the part of the scene that it needs: a new effect compiles the stages
that know of it.

A path's numbers do not depend on the paths beside it: all go in lanes, none in what is left over.
"""

import numpy as np

from .event import event_at, nearest_approach, receiver_ahead, way_through
from .jit import device, glue, launched
from .kept import keep, kept
from .lights import light_seen
from .loops import apart
from .path import WHITE, in_index, missed
from .room import (
    COLUMN,
    COLUMN_0,
    COLUMN_1,
    EVENTS,
    LIVE,
    MOST,
    PATHS,
    ROW,
    ROW_1,
    SAMPLE,
    TAKEN,
    add_light,
    after_walk,
    collision,
    colour_of,
    keep_random,
    keep_vertex,
    meets,
    no_end,
    no_ray,
    nothing_seen,
    set_colour,
    set_off,
    whole,
)
from .sample import add_sample, camera_ray
from .vec import BLACK, at, mul, narrow

f32, f64, i32, i64 = np.float32, np.float64, np.int32, np.int64
# Not Python's own 0, for which Numba would compile each function that takes it once more
NO_PATHS = i64(0)
NO_PLACE = (0.0, 0.0, 0.0)


# Rays of the camera


@device
def choose(count, due, room):
    """Next samples to take, in the order of pixels. Returns their number.

    Those of dark pixels are taken at once: they add nothing.
    """
    numbers, chosen = room.numbers, room.sample
    row, column, sample = numbers[ROW], numbers[COLUMN], numbers[SAMPLE]
    n = NO_PATHS
    while n < PATHS and row < numbers[ROW_1]:
        if due.dark[row, column]:
            count[row, column] = max(count[row, column], due.goal[row, column])
        sample = max(sample, count[row, column])
        if sample < due.goal[row, column]:
            chosen[0, n], chosen[1, n], chosen[2, n] = row, column, sample
            sample += 1
            n += 1
            continue
        sample = i64(0)
        column += 1
        if column >= numbers[COLUMN_1]:
            column = numbers[COLUMN_0]
            row += 1
    numbers[ROW], numbers[COLUMN], numbers[SAMPLE] = row, column, sample
    # Copies of the last one
    for i in range(n, whole(n)):
        for k in range(3):
            chosen[k, i] = chosen[k, n - 1]
    return n


@glue
def send(scene, room, i, origin, d, o_index, d_index, shift, limit, rng):
    """Queue the ray of path i to its next event before `limit`."""
    receiver, limit, triangle = receiver_ahead(scene.receivers, scene.mesh, origin, d, shift, limit)
    enter, length = way_through(scene.medium, o_index, d_index, limit)
    o = narrow(at(o_index, d_index, enter))
    rng = set_off(room.first, i, o, narrow(d_index), length, rng)
    keep(room.under_way, i, (origin, d, receiver, limit, triangle, enter), no_ray())
    keep_random(rng.net, room, i, rng)


@launched
def begin(count, due, scene, room):
    """Camera rays of the next samples that are due, if any are."""
    n = choose(count, due, room)
    room.numbers[TAKEN], room.numbers[LIVE], room.numbers[EVENTS] = n, n, 0
    room.first.size[0] = n
    for i in range(whole(n)):
        apart()
        row, column, sample = room.sample[0, i], room.sample[1, i], room.sample[2, i]
        origin, d, stop, rng = camera_ray(count.shape[1], scene, row, column, sample, due.seed)
        light, distance = light_seen(scene.all_lights, scene.area_lights, narrow(origin), d)
        keep(room.ahead, i, (origin, d, stop, light, distance), no_end())
        keep(room.seen, i, nothing_seen(), nothing_seen())
        set_colour(room.radiance, i, BLACK)
        set_colour(room.throughput, i, WHITE)
        room.path[i] = i32(i)
        o_index, d_index = in_index(scene.camera, origin, d)
        shift = nearest_approach(scene.receivers, origin, d)
        limit = f64(min(distance, stop[0]))
        send(scene, room, i, origin, d, o_index, d_index, shift, limit, rng)


# Events


@launched
def leave(room):
    """Light of the rays under way that meet nothing, after the first event."""
    for i in range(whole(room.numbers[LIVE])):
        apart()
        if not meets(room, i):
            path = room.path[i]
            add_light(room, path, mul(colour_of(room.throughput, i), colour_of(room.met, i)))


@device
def close_ranks(room):
    """Give the paths whose rays meet something places without a gap. Returns their number."""
    live = NO_PATHS
    for i in range(room.numbers[LIVE]):
        met = meets(room, i)
        room.before[live] = i32(i)
        live += met
        if room.numbers[EVENTS] == 0:
            room.missed[i] = not met
    if room.numbers[EVENTS] == room.numbers[MOST]:
        live = NO_PATHS
    for i in range(live, whole(live)):
        room.before[i] = room.before[live - 1]
    return live


@launched
def meet(scene, room):
    """What the rays under way meet."""
    live = close_ranks(room)
    for i in range(whole(live)):
        apart()
        k = room.before[i]
        origin, d, receiver, limit, triangle, enter = kept(room.under_way, k, no_ray())
        t, p, scalar, sigma_t = collision(room.first, k, enter)
        rng = after_walk(scene.sobol, room, room.first, k)
        # Index coordinates are for other volumes, which paths in step know none of
        t, v, rng = event_at(
            scene, origin, d, NO_PLACE, NO_PLACE, t, p, scalar, sigma_t, receiver, limit, triangle,
            rng,
        )  # fmt: skip
        keep_vertex(room, i, scene.gloss, scene.phase, v, t)
        keep_random(rng.net, room, i, rng)
        set_colour(room.throughput, i, colour_of(room.throughput, k))
        room.path[i] = room.path[k] if i < live else i32(PATHS)
    room.numbers[LIVE] = live
    room.numbers[EVENTS] += 1


# Film


@glue
def radiance_of(scene, room, i):
    """Light that path i sends to the camera."""
    L = colour_of(room.radiance, i)
    if room.missed[i]:
        origin, d, stop, light, distance = kept(room.ahead, i, no_end())
        L, _, _, _, _ = missed(scene, origin, d, stop[0], light, distance)
    return L


@launched
def expose(film, scene, room):
    """Add the samples to the film."""
    for i in range(room.numbers[TAKEN]):
        _, d, stop, _, _ = kept(room.ahead, i, no_end())
        L = radiance_of(scene, room, i)
        albedo, normal, t = kept(room.seen, i, nothing_seen())
        row, column, sample = room.sample[0, i], room.sample[1, i], room.sample[2, i]
        add_sample(
            film, scene, row, column, sample, d, stop, L, t >= 0.0, max(t, 0.0), albedo, normal
        )
