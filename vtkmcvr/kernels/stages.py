"""Paths in step on the CPU, stage by stage: those of single and of multiple scattering.

What GPUs do to keep their threads alike ("wavefront" path tracing: Laine, Karras and Aila,
"Megakernels considered harmful", HPG 2013) serves SIMD lanes, branch prediction and compilation
here. The same functions as in `path.radiance`, path by path, but for the walks through the medium,
which `packets` makes for all paths at once. Each stage is a kernel, compiled and cached by itself,
and takes the part of the scene that it needs: a new effect compiles the stages that know of it.
"""

import numpy as np

from .brdf import first_normal
from .direct import draw_by_light, draw_by_scatter, light_met
from .event import event_at, nearest_approach, receiver_ahead, way_through
from .jit import device, glue, launched
from .kept import keep, kept
from .lights import light_seen
from .path import WHITE, in_index, missed, scatter_on
from .room import (
    COLUMN,
    COLUMN_0,
    COLUMN_1,
    ENDED,
    EVENTS,
    HIDDEN,
    LIVE,
    MISSED,
    MOST,
    NO_RAYS,
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
    no_end,
    no_ray,
    no_shadow,
    no_vertex,
    nothing_seen,
    passed,
    random_of,
    set_colour,
    set_off,
)  # fmt: skip
from .sample import add_sample, camera_ray
from .vec import BLACK, add, at, largest, mul, narrow, scale, transform, wide
from .visibility import blocked, shaded_interval

f32, f64, i32, i64 = np.float32, np.float64, np.int32, np.int64
ZERO = f32(0.0)
NO_PLACE = (0.0, 0.0, 0.0)


# Rays of the camera


@device
def choose(count, due, room):
    """Next samples to take, in the order of pixels. Returns their number.

    Those of dark pixels are taken at once: they add nothing.
    """
    numbers = room.numbers
    row, column, sample = numbers[ROW], numbers[COLUMN], numbers[SAMPLE]
    n = NO_RAYS
    while n < PATHS and row < numbers[ROW_1]:
        if due.dark[row, column]:
            count[row, column] = max(count[row, column], due.goal[row, column])
        sample = max(sample, count[row, column])
        if sample < due.goal[row, column]:
            room.sample[n, 0], room.sample[n, 1], room.sample[n, 2] = row, column, sample
            sample += 1
            n += 1
            continue
        sample = i64(0)
        column += 1
        if column >= numbers[COLUMN_1]:
            column = numbers[COLUMN_0]
            row += 1
    numbers[ROW], numbers[COLUMN], numbers[SAMPLE] = row, column, sample
    return n


@glue
def send(scene, room, i, rays, origin, d, o_index, d_index, shift, limit, rng):
    """Queue the ray of path i to its next event before `limit`. Returns rays in the queue."""
    receiver, limit, triangle = receiver_ahead(scene.receivers, scene.mesh, origin, d, shift, limit)
    enter, length = way_through(scene.medium, o_index, d_index, limit)
    rays, rng = set_off(
        room, room.first, i, rays, narrow(at(o_index, d_index, enter)), narrow(d_index), length,
        rng,
    )  # fmt: skip
    keep(room.under_way, i, (origin, d, receiver, limit, triangle, enter), no_ray())
    keep_random(rng.net, room, i, rng)
    return rays


@launched
def begin(count, due, scene, room):
    """Camera rays of the next samples that are due, if any are."""
    n = choose(count, due, room)
    room.numbers[TAKEN], room.numbers[LIVE], room.numbers[EVENTS] = n, n, 0
    rays = NO_RAYS
    for i in range(n):
        row, column, sample = room.sample[i, 0], room.sample[i, 1], room.sample[i, 2]
        origin, d, stop, rng = camera_ray(count.shape[1], scene, row, column, sample, due.seed)
        light, distance = light_seen(scene.all_lights, scene.area_lights, narrow(origin), d)
        keep(room.ahead, i, (d, stop, light, distance), no_end())
        o_index, d_index = in_index(scene.camera, origin, d)
        shift = nearest_approach(scene.receivers, origin, d)
        limit = f64(min(distance, stop[0]))
        rays = send(scene, room, i, rays, origin, d, o_index, d_index, shift, limit, rng)
        room.live[i] = i32(i)
    room.first.size[0] = rays


# Events


@device
def end_outside(room, i):
    """End path i, whose ray meets no medium and no receiver."""
    if room.numbers[EVENTS] == 0:
        room.ray[i] = MISSED
        keep(room.seen, i, nothing_seen(), nothing_seen())
    else:
        room.ray[i] = ENDED
        add_light(room, i, mul(colour_of(room.throughput, i), colour_of(room.met, i)))


@launched
def meet(scene, room):
    """What the rays under way meet."""
    live = NO_RAYS
    for j in range(room.numbers[LIVE]):
        i = room.live[j]
        origin, d, receiver, limit, triangle, enter = kept(room.under_way, i, no_ray())
        t, p, scalar, sigma_t = collision(room, room.first, i, enter)
        rng = after_walk(scene.sobol, room, room.first, i)
        # Index coordinates are for other volumes, which paths in step know none of
        t, v, rng = event_at(
            scene, origin, d, NO_PLACE, NO_PLACE, t, p, scalar, sigma_t, receiver, limit, triangle,
            rng,
        )  # fmt: skip
        if t < 0.0:
            end_outside(room, i)
            continue
        if room.numbers[EVENTS] == room.numbers[MOST]:
            room.ray[i] = ENDED
            continue
        if room.numbers[EVENTS] == 0:
            normal = first_normal(scene.normal_map, scene.medium, v)
            keep(room.seen, i, (v.albedo, normal, t), nothing_seen())
            set_colour(room.radiance, i, BLACK)
            set_colour(room.throughput, i, WHITE)
        keep(room.vertex, i, v, no_vertex(scene.gloss, scene.phase))
        keep_random(rng.net, room, i, rng)
        room.live[live] = i
        live += 1
    room.numbers[LIVE] = live
    room.numbers[EVENTS] += 1


# Light


@device
def keep_drawn(room, i, v, drawn):
    """Keep the light that is drawn for path i, and the way to it."""
    set_colour(room.drawn, i, drawn.f)
    keep(room.shadow, i, (v.x, v.p, drawn.wi, drawn.distance), no_shadow())


@launched
def by_light(scene, room):
    """Light drawn by lights."""
    for j in range(room.numbers[LIVE]):
        i = room.live[j]
        v = kept(room.vertex, i, no_vertex(scene.gloss, scene.phase))
        rng = random_of(scene.sobol, room, i)
        drawn, rng = draw_by_light(scene.choice, scene, v, rng)
        keep_drawn(room, i, v, drawn)
        keep_random(rng.net, room, i, rng)


@launched
def shade(scene, room, queue):
    """Shadow rays toward the lights that are drawn."""
    rays = NO_RAYS
    for j in range(room.numbers[LIVE]):
        i = room.live[j]
        x, p, wi, distance = kept(room.shadow, i, no_shadow())
        room.ray[i] = HIDDEN
        if largest(colour_of(room.drawn, i)) > ZERO and not blocked(
            scene.receivers, scene.mesh, scene.shadows, x, wi, distance
        ):
            o, d = wide(p), wide(transform(scene.medium.index_from_world, wi))
            enter, length = shaded_interval(scene.shadows, scene.medium, o, d, distance)
            rng = random_of(scene.sobol, room, i)
            rays, rng = set_off(
                room, queue, i, rays, narrow(at(o, d, enter)), narrow(d), length, rng
            )
            keep_random(rng.net, room, i, rng)
    queue.size[0] = rays


@launched
def by_scatter(scene, room):
    """Light of single scattering: what lights have drawn, and that drawn by scattering."""
    for j in range(room.numbers[LIVE]):
        i = room.live[j]
        v = kept(room.vertex, i, no_vertex(scene.gloss, scene.phase))
        light = scale(colour_of(room.drawn, i), passed(room, room.second, i))
        rng = after_walk(scene.sobol, room, room.second, i)
        set_colour(room.radiance, i, add(v.emitted, light))
        drawn, rng = draw_by_scatter(
            scene.ambient, scene.environment, scene.area_lights, scene, v, rng
        )
        keep_drawn(room, i, v, drawn)
        keep_random(rng.net, room, i, rng)


@launched
def go_on(scattering, scene, room):
    """Light of an event of multiple scattering, and the ray to the next one."""
    live, rays = NO_RAYS, NO_RAYS
    for j in range(room.numbers[LIVE]):
        i = room.live[j]
        v = kept(room.vertex, i, no_vertex(scene.gloss, scene.phase))
        throughput = colour_of(room.throughput, i)
        light = scale(colour_of(room.drawn, i), passed(room, room.second, i))
        rng = after_walk(scene.sobol, room, room.second, i)
        add_light(room, i, mul(throughput, add(v.emitted, light)))
        room.ray[i] = ENDED
        wi, throughput, pdf, rng = scatter_on(scattering, scene, v, throughput, rng)
        if largest(throughput) <= ZERO:
            continue
        met, distance = light_met(scene, scene.choice, v, wi, pdf)
        set_colour(room.throughput, i, throughput)
        set_colour(room.met, i, met)
        d_index = wide(transform(scene.medium.index_from_world, wi))
        rays = send(
            scene, room, i, rays, wide(v.x), wi, wide(v.p), d_index, 0.0, f64(distance), rng
        )
        room.live[live] = i
        live += 1
    room.first.size[0] = rays
    room.numbers[LIVE] = live


# Film


@glue
def radiance_of(scene, room, i, d, stop, light, distance):
    """Light that path i sends to the camera."""
    L = colour_of(room.radiance, i)
    if room.ray[i] == MISSED:
        origin, _, _, _, _, _ = kept(room.under_way, i, no_ray())
        L, _, _, _, _ = missed(scene, origin, d, stop[0], light, distance)
    elif room.ray[i] != ENDED:
        # Light by scatter
        L = add(L, scale(colour_of(room.drawn, i), passed(room, room.first, i)))
    return L


@launched
def expose(film, scene, room):
    """Add the samples to the film."""
    for i in range(room.numbers[TAKEN]):
        d, stop, light, distance = kept(room.ahead, i, no_end())
        L = radiance_of(scene, room, i, d, stop, light, distance)
        albedo, normal, t = kept(room.seen, i, nothing_seen())
        row, column, sample = room.sample[i, 0], room.sample[i, 1], room.sample[i, 2]
        add_sample(
            film, scene, row, column, sample, d, stop, L, t >= 0.0, max(t, 0.0), albedo, normal
        )
