"""Many lights as a binary tree: which one to ask, and which one a ray meets.

Choosing goes down the tree by estimated irradiance of each half (Conty Estevez and Kulla,
"Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018); bounds on the cosines
at the light and at the surface are conservative, so that whatever sends light can be chosen.
"""

import math

import numpy as np

from .jit import device
from .rng import stratified
from .vec import dot, scale, sub

f32, i64 = np.float32, np.int64
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
def importance(tree, k, x, on_surface, normal):
    """Estimated irradiance at x from the lights of node k, times the cosine on a surface.

    0 only where none of them reaches x.
    """
    flux = tree.flux[k]
    law = tree.law[k]
    if law == AROUND:
        return HALF * flux if on_surface else flux

    # Direction to the cluster, and the angle under which it is seen
    cos_b, sin_b = ONE, ZERO
    axis = (tree.cone[k, 0], tree.cone[k, 1], tree.cone[k, 2])
    spread, reach = tree.cone[k, 3], tree.cone[k, 4]
    sine_spread = math.sqrt(max(ONE - spread * spread, ZERO))
    if law == DISTANT:
        toward = scale(axis, -ONE)
        cos_b, sin_b = spread, sine_spread
    else:
        toward = sub((tree.bound[k, 0], tree.bound[k, 1], tree.bound[k, 2]), x)
        radius = tree.bound[k, 3]
        square = dot(toward, toward)
        if square <= radius * radius:
            # Among the lights: more of them are on the side of the middle
            flux = tree.within[k]
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
            if cosine < reach + SLACK:
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


@device
def first_share(tree, k, x, on_surface, normal):
    """Share of the first child in the choice at node k; -1 where no child reaches x."""
    first, second = ZERO, ZERO
    child = k + 1
    for _ in range(2):
        first, second = second, importance(tree, child, x, on_surface, normal)
        child = i64(tree.links[k + 1, BEYOND])
    return first / (first + second) if first + second > ZERO else -ONE


@device
def light_chance(tree, i, x, on_surface, normal):
    """Probability with which `choose_light` takes light i."""
    if tree is None:
        return ZERO
    k, chance = i64(tree.leaf[i]), ONE - EVEN_SHARE
    while k > 0:
        parent = i64(tree.links[k, PARENT])
        share = first_share(tree, parent, x, on_surface, normal)
        chance *= max(share, ZERO) if k == parent + 1 else ONE - abs(share)
        k = parent
    return chance + EVEN_SHARE / f32(len(tree.leaf))


@device
def choose_light(tree, x, on_surface, normal, rng):
    """One light by estimated contribution. Returns (index, probability or 0, rng)."""
    rng, u = stratified(rng)
    n = len(tree.leaf)
    if u < EVEN_SHARE:
        i = min(i64(u / EVEN_SHARE * f32(n)), i64(n - 1))
        return i, light_chance(tree, i, x, on_surface, normal), rng
    u = (u - EVEN_SHARE) / (ONE - EVEN_SHARE)
    k, chance = i64(0), ONE - EVEN_SHARE
    while tree.links[k, LIGHT] < 0:
        share = first_share(tree, k, x, on_surface, normal)
        if share < ZERO:
            return i64(0), ZERO, rng
        # What is left of u chooses further down
        if u < share:
            k = k + 1
            chance *= share
            u /= share
        else:
            k = i64(tree.links[k + 1, BEYOND])
            chance *= ONE - share
            u = (u - share) / (ONE - share)
    return i64(tree.links[k, LIGHT]), chance + EVEN_SHARE / f32(n), rng


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
