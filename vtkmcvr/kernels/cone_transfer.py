"""Classification of a stretch of a ray: pre-integrated transfer functions.

The one place where layers turn scalars into extinction and colour (Engel, Kraus and Ertl,
"High-quality pre-integrated volume rendering", 2001): no slice is too thick for a detail of the
transfer function, as long as the scalar goes evenly along it.
"""

import math

import numpy as np

from .grid import trilinear
from .jit import device
from .transfer import classify, colour

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Table position of a scalar that is not known: no data
NOTHING = f32(-1.0)
# Table entries apart below which the difference of two integrals is worse than their midpoint
NARROW = f32(0.02)


@device
def entry_at(medium, integrals, p):
    """Table position, in entries, of the scalar at index position p."""
    scalar = trilinear(medium.values, p)
    if math.isnan(scalar):
        return NOTHING
    last = f32(len(integrals.sigma_t) - 1)
    return min(max((scalar - integrals.lowest) * integrals.per_scalar, ZERO), last)


@device
def sigma_at(integrals, x):
    """Extinction at table position x; 0 where there is no data."""
    if x < ZERO:
        return ZERO
    i = min(i32(x), i32(len(integrals.sigma_t) - 2))
    a = integrals.sigma_t[index(i)]
    return a + (integrals.sigma_t[index(i + i32(1))] - a) * (x - f32(i))


@device
def integral_at(integrals, x):
    """Integral of the piecewise linear extinction from the first entry to position x."""
    i = min(i32(max(x, ZERO)), i32(len(integrals.sigma_t) - 2))
    f = x - f32(i)
    a = integrals.sigma_t[index(i)]
    slope = integrals.sigma_t[index(i + i32(1))] - a
    return integrals.depth[index(i)] + f * (a + HALF * f * slope)


@device
def mean_extinction(integrals, x, y, integral):
    """Mean extinction along a stretch on which the table position goes evenly from x to y.

    `integral` is the difference of `integral_at` between them. Half of an end's extinction where
    the other is no data.
    """
    if x < ZERO or y < ZERO or abs(y - x) < NARROW:
        return HALF * (sigma_at(integrals, x) + sigma_at(integrals, y))
    return max(f32(integral) / (y - x), ZERO)


@device
def stretch_extinction(gradient_opacity, table_2d, medium, transfer, integrals, x, y, before, p):
    """Extinction of a short stretch of a ray. Returns (sigma_t, integral up to y).

    Pre-integrated where it depends on the scalar alone; with gradients, that of the middle p.
    """
    if gradient_opacity is None:
        if table_2d is None:
            integral = integral_at(integrals, y)
            return mean_extinction(integrals, x, y, integral - before), integral
    _, sigma_t = classify(gradient_opacity, table_2d, medium, transfer, p)
    return sigma_t, before


@device
def stretch_albedo(colour_grid, table_2d, medium, transfer, integrals, x, y, p):
    """Albedo of a stretch: weighted by extinction where it depends on the scalar alone."""
    if colour_grid is None:
        if table_2d is None:
            return mean_albedo(integrals, x, y)
    return colour(colour_grid, table_2d, medium, transfer, p, trilinear(medium.values, p))


@device
def mean_albedo(integrals, x, y):
    """Albedo along a stretch from table position x to y, weighted by extinction."""
    x, y = max(min(x, y), ZERO), max(max(x, y), ZERO)
    last = i32(len(integrals.sigma_t) - 1)
    i, j = min(i32(x), last - i32(1)), min(i32(y) + i32(1), last)
    total = f32(integrals.depth[index(j)] - integrals.depth[index(i)])
    if j - i <= i32(2) or not total > ZERO:
        c = index(i32(HALF * (x + y) + HALF))
        return integrals.colour[c, 0], integrals.colour[c, 1], integrals.colour[c, 2]
    a, b = index(i), index(j)
    inverse = ONE / total
    return (
        f32(integrals.light[b, 0] - integrals.light[a, 0]) * inverse,
        f32(integrals.light[b, 1] - integrals.light[a, 1]) * inverse,
        f32(integrals.light[b, 2] - integrals.light[a, 2]) * inverse,
    )
