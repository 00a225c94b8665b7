"""Stages of paths in step that bring light: drawn by lights and by scattering, and shadow rays."""

import numpy as np

from .direct import draw_by_light, draw_by_scatter, light_met
from .jit import device, launched
from .kept import keep, kept
from .loops import apart
from .path import scatter_on
from .room import (
    LIVE,
    add_light,
    after_walk,
    colour_of,
    keep_random,
    no_shadow,
    passed,
    random_of,
    set_colour,
    set_off,
    vertex_of,
    whole,
)
from .stages import send
from .vec import BLACK, add, at, largest, mul, narrow, scale, transform, wide
from .visibility import blocked, shaded_interval

f64 = np.float64
ZERO = np.float32(0.0)


@device
def keep_drawn(room, i, v, drawn):
    """Keep the light that is drawn for path i, and the way to it."""
    set_colour(room.drawn, i, drawn.f)
    keep(room.shadow, i, (v.x, v.p, drawn.wi, drawn.distance), no_shadow())


@launched
def by_light(scene, room):
    """Light drawn by lights."""
    for i in range(whole(room.numbers[LIVE])):
        apart()
        v = vertex_of(room, i, scene.gloss, scene.phase)
        rng = random_of(scene.sobol, room, i)
        drawn, rng = draw_by_light(scene.choice, scene, v, rng)
        keep_drawn(room, i, v, drawn)
        keep_random(rng.net, room, i, rng)


@launched
def shade(scene, room, queue):
    """Shadow rays toward the lights that are drawn."""
    queue.size[0] = room.numbers[LIVE]
    for i in range(whole(room.numbers[LIVE])):
        apart()
        x, p, wi, distance = kept(room.shadow, i, no_shadow())
        lit = largest(colour_of(room.drawn, i)) > ZERO
        if lit and blocked(scene.receivers, scene.mesh, scene.shadows, x, wi, distance):
            set_colour(room.drawn, i, BLACK)
            lit = False
        o, d = wide(p), wide(transform(scene.medium.index_from_world, wi))
        enter, length = shaded_interval(scene.shadows, scene.medium, o, d, distance)
        rng = random_of(scene.sobol, room, i)
        rng = set_off(queue, i, narrow(at(o, d, enter)), narrow(d), length if lit else ZERO, rng)
        keep_random(rng.net, room, i, rng)


@launched
def by_scatter(scene, room):
    """Light of single scattering: what lights have drawn, and that drawn by scattering."""
    for i in range(whole(room.numbers[LIVE])):
        apart()
        v = vertex_of(room, i, scene.gloss, scene.phase)
        light = scale(colour_of(room.drawn, i), passed(room.second, i))
        rng = after_walk(scene.sobol, room, room.second, i)
        add_light(room, room.path[i], add(v.emitted, light))
        drawn, rng = draw_by_scatter(
            scene.ambient, scene.environment, scene.area_lights, scene, v, rng
        )
        keep_drawn(room, i, v, drawn)
        keep_random(rng.net, room, i, rng)


@launched
def collect(room):
    """Light of single scattering that scattering has drawn."""
    for i in range(whole(room.numbers[LIVE])):
        apart()
        light = scale(colour_of(room.drawn, i), passed(room.first, i))
        add_light(room, room.path[i], light)


@launched
def go_on(scattering, scene, room):
    """Light of an event of multiple scattering, and the ray to the next one."""
    room.first.size[0] = room.numbers[LIVE]
    for i in range(whole(room.numbers[LIVE])):
        apart()
        v = vertex_of(room, i, scene.gloss, scene.phase)
        throughput = colour_of(room.throughput, i)
        light = scale(colour_of(room.drawn, i), passed(room.second, i))
        rng = after_walk(scene.sobol, room, room.second, i)
        add_light(room, room.path[i], mul(throughput, add(v.emitted, light)))
        wi, throughput, pdf, rng = scatter_on(scattering, scene, v, throughput, rng)
        met, distance = light_met(scene, scene.choice, v, wi, pdf)
        # A path that has ended sends a ray without length, which brings nothing
        ends = largest(throughput) <= ZERO
        set_colour(room.throughput, i, BLACK if ends else throughput)
        set_colour(room.met, i, BLACK if ends else met)
        d_index = wide(transform(scene.medium.index_from_world, wi))
        limit = 0.0 if ends else f64(distance)
        send(scene, room, i, wide(v.x), wi, wide(v.p), d_index, 0.0, limit, rng)
