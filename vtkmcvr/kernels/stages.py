"""CPU launcher of single scattering: some hundred paths in step, stage by stage.

The same functions as in `path.radiance`, path by path, but for the walks through the medium, which
`packets` makes for all paths at once. What a path needs later is kept from stage to stage.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .brdf import first_normal
from .direct import draw_by_light, draw_by_scatter
from .event import NOWHERE, event_at, nearest_approach, receiver_ahead, way_through
from .jit import device, glue, launched
from .kept import PLACE, keep, kept
from .lights import light_seen
from .packets import BY_DELTA, transmittance_found, walk_all, walk_shadows
from .path import in_index, missed
from .pool import (
    DISTANCE,
    FOUND_SCALAR,
    FOUND_SIGMA,
    Pool,
    Queue,
    enqueue,
    new_pool,
    new_queue,
    ray_of,
)  # fmt: skip
from .rng import Stream, stratified_exponential
from .sample import add_sample, camera_ray
from .vec import BLACK, add, at, largest, narrow, scale, transform, wide
from .visibility import blocked, shaded_interval

f32, f64, i32 = np.float32, np.float64, np.int32
ZERO, ONE = f32(0.0), f32(1.0)
# Not Python's own 0, for which Numba would compile each function that takes it once more
NO_RAYS = np.int64(0)
# Paths in step: as many as leave their state in the level 2 cache
PATHS = 2048
# Instead of a ray's number: nothing is in the way, nothing comes through
CLEAR, HIDDEN = i32(-1), i32(-2)


class Room(NamedTuple):
    """Room for paths in step."""

    sample: NDArray[np.int64]  # (PATHS, 3) row, column, number of the sample
    ray: NDArray[np.int32]  # (PATHS,) number in the queue, or CLEAR or HIDDEN
    hit: NDArray[np.bool_]  # (PATHS,) whether the camera ray has met something
    ahead: NDArray[np.uint8]  # (PATHS, PLACE) camera ray
    lit: NDArray[np.uint8]  # vertex and light
    seen: NDArray[np.uint8]  # what the camera sees
    # A stage reads what the rays of the one before have met, and queues its own
    first: Queue
    second: Queue
    pool: Pool


def new_room():
    """Room for a tile."""
    return Room(
        np.zeros((PATHS, 3), np.int64), np.zeros(PATHS, np.int32), np.zeros(PATHS, np.bool_),
        *(np.empty((PATHS, PLACE), np.uint8) for _ in range(3)), new_queue(PATHS),
        new_queue(PATHS), new_pool(),
    )  # fmt: skip


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
def after_walk(room, queue, i, rng):
    """Random numbers of path i after its walk."""
    k = room.ray[i]
    if k < 0:
        return rng
    return Stream(queue.counter[k], rng.net)


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
def passed(ratio, room, queue, i):
    """Transmittance of the shadow ray of path i."""
    k = room.ray[i]
    if k < 0:
        return ONE if k == CLEAR else ZERO
    return transmittance_found(ratio, queue, k)


@glue
def toward_light(scene, room, queue, i, rays, v, drawn, rng):
    """Queue the shadow ray of path i. Returns (rays in the queue, rng)."""
    room.ray[i] = HIDDEN
    if largest(drawn.f) > ZERO and not blocked(
        scene.receivers, scene.mesh, scene.shadows, v.x, drawn.wi, drawn.distance
    ):
        o = wide(v.p)
        d = wide(transform(scene.medium.index_from_world, drawn.wi))
        enter, length = shaded_interval(scene.shadows, scene.medium, o, d, drawn.distance)
        rays, rng = set_off(room, queue, i, rays, narrow(at(o, d, enter)), narrow(d), length, rng)
    return rays, rng


@device
def choose(film, goal, rows, columns, cursor, room):
    """Next samples to take, in the order of pixels. Returns (their number, cursor).

    `cursor` is (row, column, sample) of the first one that may be due.
    """
    row, column, sample = cursor
    n = 0
    while n < PATHS and row < rows[1]:
        if sample < goal[row, column]:
            room.sample[n, 0], room.sample[n, 1], room.sample[n, 2] = row, column, sample
            sample += 1
            n += 1
            continue
        column += 1
        if column >= columns[1]:
            column = columns[0]
            row += 1
        if row < rows[1]:
            sample = film.count[row, column]
    return n, (row, column, sample)


@launched
def render_in_step(film, scene, row_0, row_1, column_0, column_1, goal, seed, room):
    """`cpu.render_tile`, by stages; scattering is single and `more` and `marching` are None."""
    if row_0 >= row_1 or column_0 >= column_1:
        return
    rows, columns = (row_0, row_1), (column_0, column_1)
    cursor = (row_0, column_0, film.count[row_0, column_0])
    while True:
        n, cursor = choose(film, goal, rows, columns, cursor, room)
        if n == 0:
            return
        # Camera rays
        rays = NO_RAYS
        for i in range(n):
            row, column, sample = room.sample[i, 0], room.sample[i, 1], room.sample[i, 2]
            origin, d, stop, rng = camera_ray(film, scene, row, column, sample, seed)
            o_index, d_index = in_index(scene.camera, origin, d)
            light, distance = light_seen(scene.light_tree, scene.area_lights, narrow(origin), d)
            receiver, limit, triangle = receiver_ahead(
                scene.receivers, scene.mesh, origin, d,
                nearest_approach(scene.receivers, origin, d), f64(min(distance, stop[0])),
            )  # fmt: skip
            enter, length = way_through(scene.medium, o_index, d_index, limit)
            rays, rng = set_off(
                room, room.first, i, rays, narrow(at(o_index, d_index, enter)), narrow(d_index),
                length, rng,
            )  # fmt: skip
            ahead = (origin, d, stop, light, distance, receiver, limit, triangle, enter, rng)
            keep(room.ahead, i, ahead)
        walk_all(scene.medium, scene.transfer, BY_DELTA, ZERO, room.first, rays, room.pool)
        # What they meet, and light by light
        rays = NO_RAYS
        for i in range(n):
            origin, d, stop, light, distance, receiver, limit, triangle, enter, rng = kept(
                room.ahead, i, ahead
            )
            o_index, d_index = in_index(scene.camera, origin, d)
            t, p, scalar, sigma_t = collision(room, room.first, i, enter)
            rng = after_walk(room, room.first, i, rng)
            t, v, rng = event_at(
                scene, origin, d, o_index, d_index, t, p, scalar, sigma_t, receiver, limit,
                triangle, rng,
            )  # fmt: skip
            room.hit[i] = t >= 0.0
            if t < 0.0:
                L, _, _, _, _ = missed(scene, origin, d, stop[0], light, distance)
                keep(room.seen, i, (L, BLACK, BLACK, BLACK, BLACK, -1.0))
                continue
            drawn, rng = draw_by_light(scene.choice, scene, v, rng)
            rays, rng = toward_light(scene, room, room.second, i, rays, v, drawn, rng)
            vertex = (v, drawn, rng, t)
            keep(room.lit, i, vertex)
        walk_shadows(scene.ratio, scene.medium, scene.transfer, room.second, rays, room.pool)
        # Light by scatter
        rays = NO_RAYS
        for i in range(n):
            if not room.hit[i]:
                continue
            v, drawn, rng, t = kept(room.lit, i, vertex)
            by_light = scale(drawn.f, passed(scene.ratio, room, room.second, i))
            rng = after_walk(room, room.second, i, rng)
            drawn, rng = draw_by_scatter(
                scene.ambient, scene.environment, scene.area_lights, scene, v, rng
            )
            rays, rng = toward_light(scene, room, room.first, i, rays, v, drawn, rng)
            normal = first_normal(scene.normal_map, scene.medium, v)
            keep(room.seen, i, (v.emitted, by_light, drawn.f, v.albedo, normal, t))
        walk_shadows(scene.ratio, scene.medium, scene.transfer, room.first, rays, room.pool)
        # Film
        for i in range(n):
            L, by_light, f, albedo, normal, t = kept(
                room.seen, i, (BLACK, BLACK, BLACK, BLACK, BLACK, -1.0)
            )
            hit = t >= 0.0
            if hit:
                L = add(L, add(by_light, scale(f, passed(scene.ratio, room, room.first, i))))
            _, d, stop, _, _, _, _, _, _, _ = kept(room.ahead, i, ahead)
            row, column, sample = room.sample[i, 0], room.sample[i, 1], room.sample[i, 2]
            add_sample(
                film, scene, row, column, sample, d, stop, L, hit, max(t, 0.0), albedo, normal
            )
