"""Film position -> ray."""

import math

import numpy as np

from .jit import device
from .rng import stratified_pair
from .vec import add, at, dot, narrow, normalize, scale, sub
from .warp import concentric_disk

f32 = np.float32
HALF = 0.5


@device
def filtered_position(table, cell, u):
    """Film coordinate drawn from the pixel filter around the centre of pixel `cell`.

    The jitter is drawn from the filter itself (filter importance sampling), so pixels stay
    uncorrelated.
    """
    x = u * f32(len(table) - 1)
    i = min(int(x), len(table) - 2)
    return cell + HALF + (table[i] + (table[i + 1] - table[i]) * (x - f32(i)))


@device
def eye_of(side_by_side, camera, column, x):
    """Origin and direction of film position (0, 0) of the pixel's eye, and x on its film."""
    if side_by_side is None:
        return camera.origin, camera.direction, x
    if column < side_by_side.columns:
        return camera.origin, camera.direction, x
    return (
        add(camera.origin, side_by_side.origin),
        add(camera.direction, side_by_side.direction),
        x - side_by_side.columns,
    )


@device
def unrolled(panorama, heading):
    """Direction of a longitude and latitude; any other camera's heading is a direction already."""
    if panorama is None:
        return heading
    longitude, latitude, _ = heading
    level = math.cos(latitude)
    d = scale(panorama.up, math.sin(latitude))
    d = at(d, panorama.forward, level * math.cos(longitude))
    return at(d, panorama.right, level * math.sin(longitude))


@device
def aperture_point(corners, u, v):
    """Uniform point of the aperture of radius 1: the unit disk, or a polygon by its triangles."""
    if corners is None:
        return concentric_disk(u, v)
    side = u * f32(len(corners) - 1)
    k = min(int(side), len(corners) - 2)
    along = side - f32(k)
    out = math.sqrt(v)
    return (
        out * (corners[k, 0] + along * (corners[k + 1, 0] - corners[k, 0])),
        out * (corners[k, 1] + along * (corners[k + 1, 1] - corners[k, 1])),
    )


@device
def through_lens(lens, origin, direction, rng):
    """Origin and direction of the ray after the lens (Exposure Render C1; focal plane, HC-50).

    In a parallel projection the lens moves along with the ray (telecentric): the blur is the same
    all over the film.
    """
    if lens is None:
        return origin, direction, rng
    rng, u, v = stratified_pair(rng)
    a, b = aperture_point(lens.corners, u, v)
    offset = add(scale(lens.right, a * lens.radius), scale(lens.up, b * lens.radius))
    focus = scale(direction, lens.focus_distance / dot(direction, lens.axis))
    return add(origin, offset), normalize(sub(focus, offset)), rng


@device
def film_position(camera, column, row, rng):
    """Film position of one sample of a pixel. Returns (x, y, rng)."""
    rng, u, v = stratified_pair(rng)
    x = filtered_position(camera.filter, column, u)
    y = filtered_position(camera.filter, row, v)
    return x, y, rng


@device
def ray_through(camera, lens, column, x, y, rng):
    """Ray of a film position. Returns (origin float64, unit direction float32, rng)."""
    origin, heading, x = eye_of(camera.side_by_side, camera, column, x)
    origin = at(at(origin, camera.origin_x, x), camera.origin_y, y)
    heading = at(at(heading, camera.direction_x, x), camera.direction_y, y)
    heading = unrolled(camera.panorama, heading)
    direction = narrow(scale(heading, 1.0 / math.sqrt(dot(heading, heading))))
    return through_lens(lens, origin, direction, rng)
