"""What a ray meets next: a collision in one of the volumes, or a receiver.

Several volumes in one place are independent Poisson processes of collisions: the nearest of their
first collisions is the first of the sum of their extinctions, and transmittances multiply. So each
volume is walked on its own, over its own grid and majorants.
"""

import numpy as np
from numba import literal_unroll

from .cut import clip_interval
from .grid import box_interval
from .jit import device, glue
from .receivers import nearest_receiver
from .scatter import blank_vertex, medium_vertex, receiver_vertex
from .tracking import sample_collision
from .vec import add, at, dot, narrow, scale, transform, wide

f32, f64, i32 = np.float32, np.float64, np.int32
ZERO, ONE = f32(0.0), f32(1.0)
NOWHERE = (ZERO, ZERO, ZERO)


@device
def ray_interval(medium, o, d):
    """Interval in which the ray may collide: in the active box, inside all clip shapes."""
    enter, leave = box_interval(o, d, medium.active_lo, medium.active_hi)
    return clip_interval(medium.clip, o, d, enter, leave)


@device
def way_through(medium, o, d, limit):
    """Part of a ray before `limit` where it may collide: (where it starts, its length)."""
    enter, leave = ray_interval(medium, o, d)
    enter = max(enter, 0.0)
    return enter, f32(min(leave, limit) - enter)


@glue
def collide(marching, medium, transfer, o, d, limit, rng):
    """First collision of the ray (o, d), in index coordinates, before `limit`.

    Returns (t, index position, scalar, sigma_t, rng); t is negative without one. All is float64
    but the walk, which is float32 from where the ray enters.
    """
    enter, length = way_through(medium, o, d, limit)
    t, p, scalar, sigma_t = -1.0, NOWHERE, ZERO, ZERO
    if length > ZERO:
        entry, step = narrow(at(o, d, enter)), narrow(d)
        walked, scalar, sigma_t, rng = sample_collision(
            marching, medium, transfer, entry, step, length, rng
        )
        if walked >= ZERO:
            t, p = enter + f64(walked), at(entry, step, walked)
    return t, p, scalar, sigma_t, rng


@device
def place_in(layer, origin, d):
    """Ray in the index coordinates of another volume, float64."""
    o = add(layer.index_of_centre, transform(layer.index_from_world, origin))
    return o, transform(layer.index_from_world, wide(d))


@device
def collide_in(layer, marching, origin, d, limit, rng):
    """`collide` in another volume."""
    o, step = place_in(layer, origin, d)
    return collide(marching, layer.medium, layer.transfer, o, step, limit, rng)


@device
def collide_more(more, marching, origin, d, limit, rng):
    """First collision before `limit` in the other volumes.

    Returns (number of the volume or -1, t, index position in it, scalar, sigma_t, rng).
    """
    if more is None:
        return i32(-1), limit, NOWHERE, ZERO, ZERO, rng
    nearest = limit
    found, p, scalar, sigma_t = i32(-1), NOWHERE, ZERO, ZERO
    number = i32(0)
    for layer in literal_unroll(more):
        t, q, s, extinction, rng = collide_in(layer, marching, origin, d, nearest, rng)
        if t >= 0.0:
            nearest, found, p, scalar, sigma_t = t, number, q, s, extinction
        number = i32(number + 1)
    return found, nearest, p, scalar, sigma_t, rng


@device
def vertex_in(layer, phase, x, p, place, wo, scalar, sigma_t, rng):
    """`medium_vertex` in another volume."""
    return medium_vertex(
        layer.medium, layer.transfer, layer.surface, layer.gloss, phase, x, p, place, wo, scalar,
        sigma_t, rng,
    )  # fmt: skip


@device
def layer_vertex(more, gloss, phase, number, x, p, wo, place, scalar, sigma_t, rng):
    """Vertex of a collision in one of the other volumes, at its index position `place`."""
    if more is None:
        return blank_vertex(gloss, phase, x, p, wo), rng
    v = blank_vertex(gloss, phase, x, p, wo)
    i = i32(0)
    for layer in literal_unroll(more):
        if i == number:
            v, rng = vertex_in(layer, phase, x, p, place, wo, scalar, sigma_t, rng)
        i = i32(i + 1)
    return v, rng


@device
def receiver_ahead(receivers, mesh, origin, d, shift, limit):
    """First receiver before `limit`: (index or -1, t or `limit`, triangle or -1).

    It is looked for from the point at distance `shift` on, forward and back to the origin.
    """
    if receivers is None:
        return i32(-1), limit, i32(-1)
    o = narrow(at(origin, wide(d), shift))
    index, t, triangle = nearest_receiver(
        receivers, mesh, o, d, f32(-shift), f32(limit - shift), False
    )
    if index >= 0:
        limit = f64(t) + shift
    return index, limit, triangle


@device
def nearest_approach(receivers, origin, d):
    """Where a camera ray comes closest to the middle: float32 is at its best around there."""
    if receivers is None:
        return 0.0
    return max(-dot(origin, wide(d)), 0.0)


@glue
def next_event(scene, origin, d, o_index, d_index, shift, limit, rng):
    """First collision or receiver before `limit`. Returns (t, vertex, rng); t < 0 without one.

    origin and o_index, d_index (the same ray in index coordinates) are float64.
    """
    receiver, limit, triangle = receiver_ahead(
        scene.receivers, scene.mesh, origin, d, shift, f64(limit)
    )
    t, p, scalar, sigma_t, rng = collide(
        scene.marching, scene.medium, scene.transfer, o_index, d_index, limit, rng
    )
    return event_at(
        scene, origin, d, o_index, d_index, t, p, scalar, sigma_t, receiver, limit, triangle, rng
    )


@glue
def event_at(
    scene, origin, d, o_index, d_index, t, p, scalar, sigma_t, receiver, limit, triangle, rng
):
    """Vertex of what a ray meets first. Returns (t, vertex, rng); t < 0 where it meets nothing.

    t, p, scalar and sigma_t are of the first volume's collision, t < 0 without one; `receiver` is
    that at distance `limit`, -1 without one.
    """
    nearest = t if t >= 0.0 else limit
    number, nearest, place, other_scalar, other_sigma_t, rng = collide_more(
        scene.more, scene.marching, origin, d, nearest, rng
    )
    wo = scale(d, -ONE)
    if number >= 0:
        t = nearest
        x, p = narrow(at(origin, wide(d), t)), narrow(at(o_index, d_index, t))
        v, rng = layer_vertex(
            scene.more, scene.gloss, scene.phase, number, x, p, wo, place, other_scalar,
            other_sigma_t, rng,
        )  # fmt: skip
    elif t >= 0.0:
        x = narrow(at(origin, wide(d), t))
        v, rng = medium_vertex(
            scene.medium, scene.transfer, scene.surface, scene.gloss, scene.phase, x, p, p, wo,
            scalar, sigma_t, rng,
        )  # fmt: skip
    elif receiver >= 0:
        t = limit
        x = narrow(at(origin, wide(d), t))
        v = receiver_vertex(
            scene.receivers, scene.mesh, scene.gloss, scene.phase, scene.camera, receiver,
            triangle, x, wo,
        )  # fmt: skip
    else:
        v = blank_vertex(scene.gloss, scene.phase, NOWHERE, NOWHERE, wo)
    return t, v, rng
