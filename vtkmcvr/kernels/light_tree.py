"""Which light to ask: one of a few, or of many as a binary tree.

Choosing goes down the tree by estimated irradiance of each half (Conty Estevez and Kulla,
"Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018); bounds on the cosines
at the light and at the surface are conservative, so that whatever sends light can be chosen.
"""

import math

import numpy as np

from ..packed import LightNode
from .jit import device
from .rng import stratified
from .vec import dot, scale, sub

f32, i32, i64 = np.float32, np.int32, np.int64
ZERO, QUARTER, HALF, ONE = f32(0.0), f32(0.25), f32(0.5), f32(1.0)
# How the flux of a cluster becomes irradiance: falls off with the square of the distance; is the
# same everywhere, from a place or from a direction; comes from all around
DECAYING, STEADY, DISTANT, AROUND = 0, 1, 2, 3
BEYOND, PARENT, LIGHT = 0, 1, 2
# Share of the choice that ignores the estimates, so that a bad one costs no more than tenfold
EVEN_SHARE = f32(0.1)
# Cosines are bounded up to rounding; what is barely in reach keeps a small chance
SLACK, LEAST_COSINE = f32(-1e-3), f32(0.02)
LEAST_RADIUS = f32(1e-30)


@device
def cosine_less(cos_a, cos_b, sin_b):
    """Cosine of max(a - b, 0)."""
    if cos_a >= cos_b:
        return ONE
    return cos_a * cos_b + math.sqrt(max(ONE - cos_a * cos_a, ZERO)) * sin_b


@device
def node(tree, k):
    """Node k."""
    bound, cone = tree.bound, tree.cone
    return LightNode(
        (bound[k, 0], bound[k, 1], bound[k, 2]), bound[k, 3],
        (cone[k, 0], cone[k, 1], cone[k, 2]), cone[k, 3], cone[k, 4], tree.flux[k],
        tree.within[k], tree.law[k],
    )  # fmt: skip


@device
def importance(lights, x, on_surface, normal):
    """Estimated irradiance at x from the lights of a node, times the cosine on a surface.

    0 only where none of them reaches x.
    """
    flux = lights.flux
    law = lights.law
    if law == AROUND:
        return HALF * flux if on_surface else flux

    # Direction to the cluster, and the angle under which it is seen
    cos_b, sin_b = ONE, ZERO
    axis, spread = lights.axis, lights.spread
    sine_spread = math.sqrt(max(ONE - spread * spread, ZERO))
    if law == DISTANT:
        toward = scale(axis, -ONE)
        cos_b, sin_b = spread, sine_spread
    else:
        toward = sub(lights.centre, x)
        radius = lights.radius
        square = dot(toward, toward)
        if square <= radius * radius:
            # Among the lights: more of them are on the side of the middle
            flux = lights.within
            if on_surface:
                aside = ONE + dot(normal, toward) / max(radius, LEAST_RADIUS)
                flux *= max(QUARTER * aside * aside, LEAST_COSINE)
            return flux
        if law == DECAYING:
            flux /= square
        away = math.sqrt(square)
        toward = scale(toward, ONE / away)
        sin_b = radius / away
        cos_b = math.sqrt(max(ONE - sin_b * sin_b, ZERO))
        # At the light
        if spread > -ONE:
            cosine = cosine_less(-dot(axis, toward), spread, sine_spread)
            cosine = cosine_less(cosine, cos_b, sin_b)
            if cosine < lights.reach + SLACK:
                return ZERO
            flux *= max(cosine, LEAST_COSINE)

    # At the surface
    if on_surface:
        middle = dot(normal, toward)
        most = cosine_less(middle, cos_b, sin_b)
        if most < SLACK:
            return ZERO
        flux *= max(QUARTER * most + (ONE - QUARTER) * max(middle, ZERO), LEAST_COSINE)
    return flux


# Down the tree


@device
def first_share(tree, k, x, on_surface, normal):
    """Share of the first child in the choice at node k; -1 where no child reaches x."""
    first, second = ZERO, ZERO
    child = k + 1
    for _ in range(2):
        first, second = second, importance(node(tree, child), x, on_surface, normal)
        child = i64(tree.links[k + 1, BEYOND])
    return first / (first + second) if first + second > ZERO else -ONE


@device
def leaf_share(tree, i, x, on_surface, normal):
    """Probability with which `down` arrives at light i."""
    if tree is None:
        return ZERO
    k, share = i64(tree.leaf[i]), ONE
    while k > 0:
        parent = i64(tree.links[k, PARENT])
        first = first_share(tree, parent, x, on_surface, normal)
        share *= max(first, ZERO) if k == parent + 1 else ONE - abs(first)
        k = parent
    return share


@device
def down(tree, u, x, on_surface, normal):
    """Light chosen by u, and its probability; 0 where no light reaches x."""
    if tree is None:
        return i32(0), ZERO
    k, share = i64(0), ONE
    while tree.links[k, LIGHT] < 0:
        first = first_share(tree, k, x, on_surface, normal)
        if first < ZERO:
            return i32(0), ZERO
        # What is left of u chooses further down
        if u < first:
            k = k + 1
            share *= first
            u /= first
        else:
            k = i64(tree.links[k + 1, BEYOND])
            share *= ONE - first
            u = (u - first) / (ONE - first)
    return tree.links[k, LIGHT], share


# One by one


@device
def share_among(few, i, x, on_surface, normal):
    """Probability with which `among` chooses light i."""
    k, total, own = i32(0), ZERO, ZERO
    for light in few:
        weight = importance(light, x, on_surface, normal)
        total += weight
        own = weight if k == i else own
        k = i32(k + 1)
    return own / total if total > ZERO else ZERO


@device
def among(few, u, x, on_surface, normal):
    """Light chosen by u, and its probability; 0 where no light reaches x."""
    k, chosen = i32(0), i32(0)
    total, own = ZERO, ZERO
    for light in few:
        weight = importance(light, x, on_surface, normal)
        total += weight
        # It takes the place of those before it by its share among them
        share = weight / total if total > ZERO else ZERO
        takes = u < share
        u = u / share if takes else (u - share) / (ONE - share)
        own = weight if takes else own
        chosen = k if takes else chosen
        k = i32(k + 1)
    return chosen, own / total if total > ZERO else ZERO


# Either


@device
def share_of(few, tree, i, x, on_surface, normal):
    """Probability of light i by its estimated contribution."""
    if few is None:
        return leaf_share(tree, i, x, on_surface, normal)
    return share_among(few, i, x, on_surface, normal)


@device
def by_share(few, tree, u, x, on_surface, normal):
    """Light chosen by u by estimated contribution, and its probability."""
    if few is None:
        return down(tree, u, x, on_surface, normal)
    return among(few, u, x, on_surface, normal)


@device
def light_chance(lights, i, x, on_surface, normal):
    """Probability with which `choose_light` takes light i."""
    if lights is None:
        return ZERO
    share = share_of(lights.few, lights.tree, i, x, on_surface, normal)
    return (ONE - EVEN_SHARE) * share + EVEN_SHARE / f32(lights.number)


@device
def choose_light(lights, x, on_surface, normal, rng):
    """One light by estimated contribution. Returns (index, probability or 0, rng)."""
    rng, u = stratified(rng)
    n = lights.number
    if u < EVEN_SHARE:
        i = min(i32(u / EVEN_SHARE * f32(n)), i32(n - 1))
        return i, light_chance(lights, i, x, on_surface, normal), rng
    u = (u - EVEN_SHARE) / (ONE - EVEN_SHARE)
    i, share = by_share(lights.few, lights.tree, u, x, on_surface, normal)
    if not share > ZERO:
        return i32(0), ZERO, rng
    return i, (ONE - EVEN_SHARE) * share + EVEN_SHARE / f32(n), rng


@device
def meets(tree, k, o, d):
    """Whether a ray may meet the sphere around node k."""
    radius = tree.bound[k, 3]
    if radius < ZERO:
        return False
    v = sub((tree.bound[k, 0], tree.bound[k, 1], tree.bound[k, 2]), o)
    along = dot(v, d)
    square = dot(v, v)
    if along < ZERO and square > radius * radius:
        return False
    closest = sub(v, scale(d, along))
    return dot(closest, closest) <= radius * radius
