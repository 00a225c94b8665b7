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
def through_lens(lens, origin, direction, rng):
    """Origin and direction of the ray after the lens (Exposure Render C1; focal plane, HC-50)."""
    if lens is None:
        return origin, direction, rng
    rng, u, v = stratified_pair(rng)
    a, b = concentric_disk(u, v)
    offset = add(scale(lens.right, a * lens.radius), scale(lens.up, b * lens.radius))
    focus = scale(direction, lens.focus_distance / dot(direction, lens.axis))
    return add(origin, offset), normalize(sub(focus, offset)), rng


@device
def camera_ray(camera, lens, column, row, rng):
    """Ray of one sample of a pixel. Returns (origin float64, unit direction float32, rng)."""
    rng, u, v = stratified_pair(rng)
    x = filtered_position(camera.filter, column, u)
    y = filtered_position(camera.filter, row, v)
    origin = at(at(camera.origin, camera.origin_x, x), camera.origin_y, y)
    heading = at(at(camera.direction, camera.direction_x, x), camera.direction_y, y)
    direction = narrow(scale(heading, 1.0 / math.sqrt(dot(heading, heading))))
    return through_lens(lens, origin, direction, rng)
