"""Lights: what they send to a point, and which of them a ray meets.

Every light answers with a LightSample. Area lights block light, with either side; delta lights
(directional, point) can't be met by a ray, so only light sampling finds them.
"""

import math
from typing import NamedTuple

import numpy as np

from ..packed import AreaLight
from .environment import sample_environment
from .grid import INFINITE
from .jit import device
from .light_texture import texture_factor
from .light_tree import BEYOND, LIGHT, choose_light, light_chance, meets
from .rng import stratified_pair
from .shapes import RECTANGLE, facing, sample_shape, shape_distance, shape_pdf
from .vec import BLACK, dot, from_basis, mul, scale, sub

f32, i32, i64 = np.float32, np.int32, np.int64
ZERO, ONE = f32(0.0), f32(1.0)
NO_DIRECTION = (ZERO, ZERO, ONE)
DIRECTIONAL, POINT = 0, 1
NO_LIGHT = AreaLight(
    RECTANGLE, BLACK, BLACK, BLACK, BLACK, BLACK, BLACK, np.bool_(False), np.bool_(False)
)
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
def light_of_many(many, i):
    """Area light i of a table."""
    if many is None:
        return NO_LIGHT
    frame = many.frame
    return AreaLight(
        many.kind[i], (frame[i, 0, 0], frame[i, 0, 1], frame[i, 0, 2]),
        (frame[i, 1, 0], frame[i, 1, 1], frame[i, 1, 2]),
        (frame[i, 2, 0], frame[i, 2, 1], frame[i, 2, 2]),
        (frame[i, 3, 0], frame[i, 3, 1], frame[i, 3, 2]), row(many.size, i), row(many.radiance, i),
        many.two_sided[i], many.visible[i],
    )  # fmt: skip


@device
def area_light(few, many, i):
    """Area light i."""
    if few is None:
        return light_of_many(many, i)
    k, found = i32(0), few[0]
    for light in few:
        found = light if k == i else found
        k = i32(k + 1)
    return found


@device
def local_direction(light, d):
    """World direction in the frame of a light."""
    return dot(light.u, d), dot(light.v, d), dot(light.w, d)


@device
def local_position(light, x):
    """World position in the frame of a light."""
    return local_direction(light, sub(x, light.centre))


@device
def area_light_distance(shapes, light, o, d):
    """Distance at which the ray meets an area light, INFINITE if it does not."""
    o, d = local_position(light, o), local_direction(light, d)
    return shape_distance(shapes, light.kind, light.size, o, d)


@device
def nearest_of_many(tree, many, shapes, o, d, for_camera):
    """`nearest_light` of a tree."""
    index, nearest = i32(-1), INFINITE
    if tree is None or many is None:
        return index, nearest
    k, nodes, n = i64(0), len(tree.flux), len(many.kind)
    while k < nodes:
        if not meets(tree, k, o, d):
            k = i64(tree.links[k, BEYOND])
            continue
        i = tree.links[k, LIGHT]
        if i >= 0 and i < n and (not for_camera or many.visible[i]):
            t = area_light_distance(shapes, light_of_many(many, i), o, d)
            if t < nearest:
                index, nearest = i, t
        k += 1
    return index, nearest


@device
def nearest_of_few(few, tree, lights, o, d, for_camera):
    """`nearest_light` of a few, each of which is asked, or else of many."""
    if few is None:
        return nearest_of_many(tree, lights.many, lights.shapes, o, d, for_camera)
    k, index, nearest = i32(0), i32(-1), INFINITE
    for light in few:
        t = area_light_distance(lights.shapes, light, o, d)
        if t < nearest and (not for_camera or light.visible):
            index, nearest = k, t
        k = i32(k + 1)
    return index, nearest


@device
def nearest_light(all_lights, lights, o, d, for_camera):
    """First area light along the ray: (index or -1, distance or INFINITE)."""
    if lights is None or all_lights is None:
        return i32(-1), INFINITE
    return nearest_of_few(lights.few, all_lights.tree, lights, o, d, for_camera)


@device
def nearest_visible(seen, all_lights, lights, o, d):
    """First area light that a camera ray sees: (index or -1, distance or INFINITE)."""
    if seen is None:
        return i32(-1), INFINITE
    return nearest_light(all_lights, lights, o, d, True)


@device
def light_seen(all_lights, lights, o, d):
    """`nearest_visible`, or nothing in a scene without area lights."""
    if lights is None:
        return i32(-1), INFINITE
    return nearest_visible(lights.seen, all_lights, lights, o, d)


@device
def blocked(all_lights, lights, x, light):
    """Whether an area light is in the way of a light sample."""
    if lights is None or all_lights is None:
        return False
    _, distance = nearest_light(all_lights, lights, x, light.wi, False)
    return distance < IN_FRONT * light.distance


@device
def area_light_radiance(lights, i, x, wi, distance):
    """Radiance of area light i, which the ray along wi meets; black on its dark side."""
    if lights is None:
        return BLACK
    light = area_light(lights.few, lights.many, i)
    o, d = local_position(light, x), local_direction(light, wi)
    if not facing(light.kind, light.size, light.two_sided, o, d, distance) > ZERO:
        return BLACK
    factor = texture_factor(lights.textures, i, light.kind, light.size, o, d, distance)
    return mul(light.radiance, factor)


@device
def area_light_pdf(lights, i, x, wi, distance):
    """Density per steradian with which `sample_area_light` finds this direction."""
    if lights is None:
        return ZERO
    light = area_light(lights.few, lights.many, i)
    o, d = local_position(light, x), local_direction(light, wi)
    return shape_pdf(lights.shapes, light.kind, light.size, light.two_sided, o, d, distance)


@device
def sample_area_light(lights, i, chance, x, rng):
    """Direction to a point of area light i, seen from x. Returns (sample, rng)."""
    if lights is None:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO), rng
    rng, u, v = stratified_pair(rng)
    light = area_light(lights.few, lights.many, i)
    kind, size, two_sided = light.kind, light.size, light.two_sided
    o = local_position(light, x)
    d, distance = sample_shape(lights.shapes, kind, size, two_sided, o, u, v)
    pdf = ZERO
    if distance > ZERO:
        pdf = chance * shape_pdf(lights.shapes, kind, size, two_sided, o, d, distance)
    if not pdf > ZERO:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO), rng
    factor = texture_factor(lights.textures, i, kind, size, o, d, distance)
    radiance = scale(mul(light.radiance, factor), ONE / pdf)
    return LightSample(from_basis(light.u, light.v, light.w, d), distance, radiance, pdf), rng


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
        return i32(0)
    return lights.number


@device
def sample_light(
    choice, all_lights, area_lights, delta_lights, environment, x, on_surface, normal, rng
):
    """One light, chosen by its estimated contribution, and a direction toward it."""
    i, chance, rng = choose_light(all_lights, x, on_surface, normal, rng)
    if chance <= ZERO:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO), rng
    if i == choice.environment:
        return sample_map(environment, chance, rng)
    n = count_area_lights(area_lights)
    if i < n:
        return sample_area_light(area_lights, i, chance, x, rng)
    return delta_sample(delta_lights, i - n, chance, x), rng


@device
def light_pdf(all_lights, lights, i, x, on_surface, normal, wi, distance):
    """Density per steradian with which `sample_light` finds area light i along wi."""
    pdf = area_light_pdf(lights, i, x, wi, distance)
    if not pdf > ZERO:
        return ZERO
    return pdf * light_chance(all_lights, i, x, on_surface, normal)
