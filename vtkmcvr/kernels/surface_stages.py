"""Stages of paths in step that ask for gradients: which events are by a surface, what is seen.

Gradients are looked up in lanes, for all paths at once.
"""

import numpy as np

from .brdf import surface_by_gradient, surface_draw, toward_camera
from .cut_faces import cut_face
from .grid import gradient, slope, trilinear
from .jit import device, launched
from .kept import keep, kept
from .lanes_memory import load, store
from .loops import WIDTH, apart
from .over_lanes import over_lanes
from .pool import DISTANCE, FOUND_SIGMA
from .room import (
    LIVE,
    PATHS,
    colour_of,
    keep_random,
    no_event,
    nothing_seen,
    random_of,
    set_colour,
    whole,
)
from .scatter import faced
from .vec import BLACK

i32 = np.int32
ZERO, ONE = np.float32(0.0), np.float32(1.0)
NO_PATHS = np.int64(0)

trilinear = over_lanes(trilinear)
slope = over_lanes(slope)
gradient = over_lanes(gradient)


@device
def fetch_gradients(medium, world_from_index_gradient, rows, n):
    """Gradients at n index positions, which take the positions' place."""
    for i in range(0, n, WIDTH):
        p = load(rows, i), load(rows, PATHS + i), load(rows, 2 * PATHS + i)
        x, y, z = gradient(medium.values, world_from_index_gradient, p)
        store(rows, i, x)
        store(rows, PATHS + i, y)
        store(rows, 2 * PATHS + i, z)


@device
def asking(room):
    """Find the paths that ask for a gradient, up to whole lanes. Returns their number."""
    n = NO_PATHS
    for i in range(room.numbers[LIVE]):
        room.asking[n] = i32(i)
        n += room.chance[0, i] >= ZERO
    # The last one does what it does once more
    for i in range(n, whole(n)):
        room.asking[i] = room.asking[n - 1]
    return whole(n)


@launched
def face(scene, room):
    """Which collisions are by the surface: `brdf.surface_event`, of all at once."""
    surface, medium = scene.surface, scene.medium
    for i in range(whole(room.numbers[LIVE])):
        apart()
        k = room.before[i]
        rng = random_of(scene.sobol, room, i)
        alpha, xi, maybe, after = surface_draw(surface, room.first.found[FOUND_SIGMA, k], rng)
        in_medium = room.first.found[DISTANCE, k] >= ZERO
        rng = after if in_medium else rng
        keep_random(rng.net, room, i, rng)
        room.chance[0, i], room.chance[1, i] = alpha if in_medium and maybe else -ONE, xi
    n = asking(room)
    for j in range(n):
        apart()
        v, _ = kept(room.event, room.asking[j], no_event())
        set_colour(room.gradient, j, v.p)
    fetch_gradients(medium, surface.world_from_index_gradient, room.gradient, n)
    for j in range(n):
        apart()
        i = room.asking[j]
        v, t = kept(room.event, i, no_event())
        alpha, xi, g = room.chance[0, i], room.chance[1, i], colour_of(room.gradient, j)
        yes, normal = surface_by_gradient(surface, alpha, xi, g, v.wo)
        on_cut, outward = cut_face(medium.clip, None, None, v.p, v.wo)
        normal = outward if on_cut else normal
        keep(room.event, i, (faced(v, yes or on_cut, normal), t), no_event())


@launched
def see(scene, room):
    """What the camera sees: the first event."""
    for i in range(whole(room.numbers[LIVE])):
        apart()
        v, t = kept(room.event, i, no_event())
        keep(room.seen, room.path[i], (v.albedo, BLACK, t), nothing_seen())


@launched
def see_normals(scene, room):
    """What the camera sees: the first event, and `brdf.first_normal` there."""
    for i in range(whole(room.numbers[LIVE])):
        apart()
        v, _ = kept(room.event, i, no_event())
        set_colour(room.gradient, i, BLACK if v.on_surface else v.p)
    n = whole(room.numbers[LIVE])
    fetch_gradients(scene.medium, scene.normal_map.world_from_index_gradient, room.gradient, n)
    for i in range(n):
        apart()
        v, t = kept(room.event, i, no_event())
        normal = v.normal if v.on_surface else toward_camera(colour_of(room.gradient, i), v.wo)
        keep(room.seen, room.path[i], (v.albedo, normal, t), nothing_seen())
