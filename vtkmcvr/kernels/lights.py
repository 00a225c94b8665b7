"""Finite and directional lights: what they send to a point, and which of them a ray meets.

Every light answers with a LightSample. Rectangles block light, with either side; delta lights
(directional, point) can't be met by a ray, so only light sampling finds them.
"""

import math
from typing import NamedTuple

import numpy as np

from .environment import sample_environment
from .grid import INFINITE
from .jit import device
from .rng import stratified, stratified_pair
from .vec import BLACK, at, dot, normalize, scale, sub

f32 = np.float32
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
LEAST_COSINE = f32(0.1)
NO_DIRECTION = (ZERO, ZERO, ONE)
DIRECTIONAL, POINT = 0, 1


class LightSample(NamedTuple):
    """Light arriving at a point from one direction."""

    wi: tuple  # toward the light
    distance: np.float32
    radiance: tuple  # radiance over density; for delta lights irradiance on a facing plane
    pdf: np.float32  # per steradian, selection included; 0 for delta lights
    rectangle: int  # index of the rectangle sampled, -1 otherwise


@device
def row(table, i):
    """Row of an (n, 3) table as a vector."""
    return (table[i, 0], table[i, 1], table[i, 2])


@device
def rectangle_facing(rectangles, i, wi):
    """Cosine at the light for a direction wi toward it; 0 on its dark side."""
    cosine = -dot(row(rectangles.normal, i), wi)
    if rectangles.two_sided[i]:
        return abs(cosine)
    return max(cosine, ZERO)


@device
def rectangle_distance(rectangles, i, o, d):
    """Distance at which the ray meets rectangle i, INFINITE if it does not."""
    normal = row(rectangles.normal, i)
    corner = sub(row(rectangles.corner, i), o)
    against = dot(normal, d)
    if against == ZERO:
        return INFINITE
    t = dot(normal, corner) / against
    if not t > ZERO:
        return INFINITE
    inside = sub(scale(d, t), corner)
    edge_u, edge_v = row(rectangles.edge_u, i), row(rectangles.edge_v, i)
    a, b = dot(inside, edge_u), dot(inside, edge_v)
    if a < ZERO or b < ZERO or a > dot(edge_u, edge_u) or b > dot(edge_v, edge_v):
        return INFINITE
    return t


@device
def nearest_rectangle(rectangles, o, d, for_camera):
    """First rectangle along the ray: (index or -1, distance or INFINITE)."""
    index, nearest = -1, INFINITE
    if rectangles is None:
        return index, nearest
    for i in range(len(rectangles.area)):
        if not for_camera or rectangles.visible[i]:
            t = rectangle_distance(rectangles, i, o, d)
            if t < nearest:
                index, nearest = i, t
    return index, nearest


@device
def rectangle_radiance(rectangles, index, wi):
    """Radiance of the rectangle that a ray along wi has met; black on its dark side."""
    if rectangles is None:
        return BLACK
    if rectangle_facing(rectangles, index, wi) <= ZERO:
        return BLACK
    return row(rectangles.radiance, index)


@device
def light_weight(choice, i, x, on_surface, normal):
    """Estimated contribution of light i at x: its irradiance, times the cosine on a surface.

    At least a tenth of it where the light's middle is below the horizon, since its edge may be
    above.
    """
    weight = choice.weight[i]
    if not on_surface:
        return weight
    kind = choice.anchor[i, 3]
    if kind < ZERO:
        return HALF * weight
    anchor = row(choice.anchor, i)
    toward = normalize(sub(anchor, scale(x, kind)))
    return weight * max(dot(normal, toward), LEAST_COSINE)


@device
def light_chance(choice, i, x, on_surface, normal):
    """Probability with which `choose_light` takes light i."""
    if choice is None:
        return ZERO
    total = ZERO
    for k in range(len(choice.weight)):
        total += light_weight(choice, k, x, on_surface, normal)
    return light_weight(choice, i, x, on_surface, normal) / total


@device
def choose_light(choice, x, on_surface, normal, rng):
    """One light by estimated contribution. Returns (index, probability, rng)."""
    rng, u = stratified(rng)
    n = len(choice.weight)
    total = ZERO
    for k in range(n):
        total += light_weight(choice, k, x, on_surface, normal)
    left = u * total
    for k in range(n):
        weight = light_weight(choice, k, x, on_surface, normal)
        if left < weight:
            return k, weight / total, rng
        left -= weight
    # The sum of the parts may fall short of the total by rounding
    return n - 1, light_weight(choice, n - 1, x, on_surface, normal) / total, rng


@device
def rectangle_pdf(rectangles, chance, index, wi, distance):
    """Density per steradian with which light sampling finds this direction, selection included."""
    if rectangles is None:
        return ZERO
    cosine = rectangle_facing(rectangles, index, wi)
    if cosine <= ZERO:
        return ZERO
    return chance * distance * distance / (cosine * rectangles.area[index])


@device
def sample_rectangle(rectangles, i, chance, x, rng):
    """Uniform point of the rectangle, seen from x."""
    rng, u, v = stratified_pair(rng)
    corner = row(rectangles.corner, i)
    point = at(at(corner, row(rectangles.edge_u, i), u), row(rectangles.edge_v, i), v)
    toward = sub(point, x)
    distance = math.sqrt(dot(toward, toward))
    if distance <= ZERO:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO, i), rng
    wi = scale(toward, ONE / distance)
    cosine = rectangle_facing(rectangles, i, wi)
    if cosine <= ZERO:
        return LightSample(wi, distance, BLACK, ZERO, i), rng
    pdf = chance * distance * distance / (cosine * rectangles.area[i])
    return LightSample(wi, distance, scale(row(rectangles.radiance, i), ONE / pdf), pdf, i), rng


@device
def delta_sample(lights, i, chance, x):
    """Directional or point light i, seen from x."""
    axis = row(lights.axis, i)
    power = scale(row(lights.power, i), ONE / chance)
    if lights.kind[i] == DIRECTIONAL:
        return LightSample(scale(axis, -ONE), INFINITE, power, ZERO, -1)
    toward = sub(row(lights.position, i), x)
    distance = math.sqrt(dot(toward, toward))
    if distance <= ZERO:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO, -1)
    wi = scale(toward, ONE / distance)
    a = row(lights.attenuation, i)
    falloff = a[0] + a[1] * distance + a[2] * distance * distance
    cosine = -dot(axis, wi)
    if cosine < lights.cone[i, 0] or falloff <= ZERO:
        return LightSample(wi, distance, BLACK, ZERO, -1)
    if lights.cone[i, 1] > ZERO:
        falloff /= max(cosine, ZERO) ** lights.cone[i, 1]
    return LightSample(wi, distance, scale(power, ONE / falloff), ZERO, -1)


@device
def sample_map(environment, chance, rng):
    """Environment map."""
    wi, radiance, pdf, rng = sample_environment(environment, rng)
    pdf *= chance
    if pdf <= ZERO:
        return LightSample(wi, INFINITE, BLACK, ZERO, -1), rng
    return LightSample(wi, INFINITE, scale(radiance, ONE / pdf), pdf, -1), rng


@device
def count_rectangles(rectangles):
    """Number of rectangles; they come first in the light list."""
    if rectangles is None:
        return 0
    return len(rectangles.area)


@device
def ask_rectangle(rectangles, i, chance, x, rng):
    """`sample_rectangle`, or nothing in a scene without rectangles."""
    if rectangles is None:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO, -1), rng
    return sample_rectangle(rectangles, i, chance, x, rng)


@device
def ask_delta(lights, i, chance, x):
    """`delta_sample`, or nothing in a scene without delta lights."""
    if lights is None:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO, -1)
    return delta_sample(lights, i, chance, x)


@device
def ask_map(environment, chance, rng):
    """`sample_map`, or nothing in a scene without an environment map."""
    if environment is None:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO, -1), rng
    return sample_map(environment, chance, rng)


@device
def sample_light(choice, rectangles, delta_lights, environment, x, on_surface, normal, rng):
    """One light, chosen by its estimated contribution, and a direction toward it."""
    i, chance, rng = choose_light(choice, x, on_surface, normal, rng)
    if chance <= ZERO:
        return LightSample(NO_DIRECTION, ZERO, BLACK, ZERO, -1), rng
    if i == choice.environment:
        return ask_map(environment, chance, rng)
    n = count_rectangles(rectangles)
    if i < n:
        return ask_rectangle(rectangles, i, chance, x, rng)
    return ask_delta(delta_lights, i - n, chance, x), rng
