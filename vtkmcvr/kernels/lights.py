"""Lights: what they send to a point, and which of them a ray meets.

Every light answers with a LightSample. Area lights block light, with either side; delta lights
(directional, point) can't be met by a ray, so only light sampling finds them.
"""

import math
from typing import NamedTuple

import numpy as np

from .environment import sample_environment
from .grid import INFINITE
from .jit import device
from .light_texture import texture_factor
from .light_tree import BEYOND, LIGHT, choose_light, light_chance, meets
from .rng import stratified_pair
from .shapes import facing, sample_shape, shape_distance, shape_pdf
from .vec import BLACK, dot, from_basis, mul, scale, sub

f32, i64 = np.float32, np.int64
ZERO, ONE = f32(0.0), f32(1.0)
NO_DIRECTION = (ZERO, ZERO, ONE)
DIRECTIONAL, POINT = 0, 1
# What lies nearer than this share of the distance to a light is in its way
IN_FRONT = f32(1.0 - 1e-4)


class LightSample(NamedTuple):
    """Light arriving at a point from one direction."""

    wi: tuple  # toward the light
    distance: np.float32
    radiance: tuple  # radiance over density; for delta lights irradiance on a facing plane
    pdf: np.float32  # per steradian, selection included; 0 for delta lights


@device
def row(table, i):
    """Row of an (n, 3) table as a vector."""
    return (table[i, 0], table[i, 1], table[i, 2])


# Area lights


@device
def local_direction(frame, i, d):
    """World direction in the frame of light i."""
    return (
        frame[i, 1, 0] * d[0] + frame[i, 1, 1] * d[1] + frame[i, 1, 2] * d[2],
        frame[i, 2, 0] * d[0] + frame[i, 2, 1] * d[1] + frame[i, 2, 2] * d[2],
        frame[i, 3, 0] * d[0] + frame[i, 3, 1] * d[1] + frame[i, 3, 2] * d[2],
    )


@device
def local_position(frame, i, x):
    """World position in the frame of light i."""
    return local_direction(frame, i, sub(x, (frame[i, 0, 0], frame[i, 0, 1], frame[i, 0, 2])))


@device
def world_direction(frame, i, d):
    """Direction in the frame of light i in the world."""
    u = (frame[i, 1, 0], frame[i, 1, 1], frame[i, 1, 2])
    v = (frame[i, 2, 0], frame[i, 2, 1], frame[i, 2, 2])
    return from_basis(u, v, (frame[i, 3, 0], frame[i, 3, 1], frame[i, 3, 2]), d)


@device
def area_light_distance(lights, i, o, d):
    """Distance at which the ray meets area light i, INFINITE if it does not."""
    frame = lights.frame
    o, d = local_position(frame, i, o), local_direction(frame, i, d)
    return shape_distance(lights.shapes, lights.kind[i], row(lights.size, i), o, d)


@device
def nearest_light(tree, lights, o, d, for_camera):
    """First area light along the ray: (index or -1, distance or INFINITE)."""
    index, nearest = i64(-1), INFINITE
    if lights is None or tree is None:
        return index, nearest
    k, nodes, n = i64(0), len(tree.flux), len(lights.kind)
    while k < nodes:
        if not meets(tree, k, o, d):
            k = i64(tree.links[k, BEYOND])
            continue
        i = i64(tree.links[k, LIGHT])
        if i >= 0 and i < n and (not for_camera or lights.visible[i]):
            t = area_light_distance(lights, i, o, d)
            if t < nearest:
                index, nearest = i, t
        k += 1
    return index, nearest


@device
def nearest_visible(seen, tree, lights, o, d):
    """First area light that a camera ray sees: (index or -1, distance or INFINITE)."""
    if seen is None:
        return i64(-1), INFINITE
    return nearest_light(tree, lights, o, d, True)


@device
def light_seen(tree, lights, o, d):
    """`nearest_visible`, or nothing in a scene without area lights."""
    if lights is None:
        return i64(-1), INFINITE
    return nearest_visible(lights.seen, tree, lights, o, d)


@device
def blocked(tree, lights, x, light):
    """Whether an area light is in the way of a light sample."""
    if lights is None or tree is None:
        return False
    _, distance = nearest_light(tree, lights, x, light.wi, False)
    return distance < IN_FRONT * light.distance


@device
def area_light_radiance(lights, i, x, wi, distance):
    """Radiance of area light i, which the ray along wi meets; black on its dark side."""
    if lights is None:
        return BLACK
    o, d = local_position(lights.frame, i, x), local_direction(lights.frame, i, wi)
    kind, size = lights.kind[i], row(lights.size, i)
    if not facing(kind, size, lights.two_sided[i], o, d, distance) > ZERO:
        return BLACK
    factor = texture_factor(lights.textures, i, kind, size, o, d, distance)
    return mul(row(lights.radiance, i), factor)


@device
def area_light_pdf(lights, i, x, wi, distance):
    """Density per steradian with which `sample_area_light` finds this direction."""
    if lights is None:
        return ZERO
    o, d = local_position(lights.frame, i, x), local_direction(lights.frame, i, wi)
    size = row(lights.size, i)
    return shape_pdf(lights.shapes, lights.kind[i], size, lights.two_sided[i], o, d, distance)


@device
def sample_area_light(lights, i, chance, x, rng):
    """Direction to a point of area light i, seen from x. Returns (sample, rng)."""
    if lights is None:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO), rng
    rng, u, v = stratified_pair(rng)
    kind, size, two_sided = lights.kind[i], row(lights.size, i), lights.two_sided[i]
    o = local_position(lights.frame, i, x)
    d, distance = sample_shape(lights.shapes, kind, size, two_sided, o, u, v)
    pdf = ZERO
    if distance > ZERO:
        pdf = chance * shape_pdf(lights.shapes, kind, size, two_sided, o, d, distance)
    if not pdf > ZERO:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO), rng
    factor = texture_factor(lights.textures, i, kind, size, o, d, distance)
    radiance = scale(mul(row(lights.radiance, i), factor), ONE / pdf)
    return LightSample(world_direction(lights.frame, i, d), distance, radiance, pdf), rng


# Lights that no ray meets


@device
def delta_sample(lights, i, chance, x):
    """Directional or point light i, seen from x."""
    if lights is None:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO)
    axis = row(lights.axis, i)
    power = scale(row(lights.power, i), ONE / chance)
    if lights.kind[i] == DIRECTIONAL:
        return LightSample(scale(axis, -ONE), INFINITE, power, ZERO)
    toward = sub(row(lights.position, i), x)
    distance = math.sqrt(dot(toward, toward))
    if distance <= ZERO:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO)
    wi = scale(toward, ONE / distance)
    a = row(lights.attenuation, i)
    falloff = a[0] + a[1] * distance + a[2] * distance * distance
    cosine = -dot(axis, wi)
    if cosine < lights.cone[i, 0] or falloff <= ZERO:
        return LightSample(wi, distance, BLACK, ZERO)
    if lights.cone[i, 1] > ZERO:
        falloff /= max(cosine, ZERO) ** lights.cone[i, 1]
    return LightSample(wi, distance, scale(power, ONE / falloff), ZERO)


@device
def sample_map(environment, chance, rng):
    """Environment map."""
    if environment is None:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO), rng
    wi, radiance, pdf, rng = sample_environment(environment, rng)
    pdf *= chance
    if pdf <= ZERO:
        return LightSample(wi, INFINITE, BLACK, ZERO), rng
    return LightSample(wi, INFINITE, scale(radiance, ONE / pdf), pdf), rng


# All of them


@device
def count_area_lights(lights):
    """Number of area lights; they come first in the light list."""
    if lights is None:
        return 0
    return len(lights.kind)


@device
def sample_light(choice, tree, area_lights, delta_lights, environment, x, on_surface, normal, rng):
    """One light, chosen by its estimated contribution, and a direction toward it."""
    i, chance, rng = choose_light(tree, x, on_surface, normal, rng)
    if chance <= ZERO:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO), rng
    if i == choice.environment:
        return sample_map(environment, chance, rng)
    n = count_area_lights(area_lights)
    if i < n:
        return sample_area_light(area_lights, i, chance, x, rng)
    return delta_sample(delta_lights, i - n, chance, x), rng


@device
def light_pdf(tree, lights, i, x, on_surface, normal, wi, distance):
    """Density per steradian with which `sample_light` finds area light i along wi."""
    pdf = area_light_pdf(lights, i, x, wi, distance)
    if not pdf > ZERO:
        return ZERO
    return pdf * light_chance(tree, i, x, on_surface, normal)
