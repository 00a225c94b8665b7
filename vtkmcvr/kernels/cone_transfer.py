"""Classification of a stretch of a ray: pre-integrated transfer functions.

The one place where layers turn scalars into extinction and colour (Engel, Kraus and Ertl,
"High-quality pre-integrated volume rendering", 2001): no slice is too thick for a detail of the
transfer function, as long as the scalar goes evenly along it. Labels, masks and cuts follow the
rules of `transfer` and `cut`, so that slices show what light transport shows.
"""

import math

import numpy as np

from .cut import clip_interval, in_regions, outside_holes
from .grid import trilinear
from .jit import device
from .labels import label_row
from .transfer import classify, colour, of_label
from .vec import wide

f32, f64, i32, index = np.float32, np.float64, np.int32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Table position of a scalar that is not known: no data
NOTHING = f32(-1.0)
# Table entries apart below which the difference of two integrals is worse than their midpoint
NARROW = f32(0.02)


@device
def entry_at(medium, integrals, p):
    """Table position, in entries of a row, of the scalar at index position p."""
    scalar = trilinear(medium.values, p)
    if math.isnan(scalar):
        return NOTHING
    return min(max((scalar - integrals.lowest) * integrals.per_scalar, ZERO), integrals.last)


@device
def clipped(clip, o, d, enter, leave):
    """Part of a ray's interval inside all clip planes and balls."""
    if clip is None:
        return enter, leave
    enter, leave = clip_interval(clip, wide(o), wide(d), f64(enter), f64(leave))
    return f32(enter), f32(leave)


@device
def first_entry(labels, transfer, p):
    """Where the row of the label at index position p starts."""
    if labels is None:
        return i32(0)
    return i32(label_row(labels, p)) * transfer.entries


@device
def integrated_at(sigma_t, depth, first, last, x):
    """Extinction at position x of a row, 0 where there is no data, and its integral up to there."""
    i = min(i32(max(x, ZERO)), i32(last) - i32(1))
    f = x - f32(i)
    a = sigma_t[index(first + i)]
    slope = sigma_t[index(first + i + i32(1))] - a
    integral = depth[index(first + i)] + f * (a + HALF * f * slope)
    return (ZERO if x < ZERO else a + slope * f), integral


@device
def integral_at(sigma_t, depth, first, last, x):
    """Integral of the piecewise linear extinction up to position x of a row."""
    _, integral = integrated_at(sigma_t, depth, first, last, x)
    return integral


@device
def mean_between(x, y, sigma_x, sigma_y, depth_x, depth_y):
    """Mean extinction along a stretch on which the table position goes evenly from x to y.

    Of the extinction and its integral at both ends: half of an end's extinction where the other is
    no data.
    """
    if x < ZERO or y < ZERO or abs(y - x) < NARROW:
        return HALF * (sigma_x + sigma_y)
    return max(f32(depth_y - depth_x) / (y - x), ZERO)


@device
def mean_extinction(sigma_t, depth, first, last, x, y):
    """The same, looked up in a row of a table."""
    sigma_x, depth_x = integrated_at(sigma_t, depth, first, last, x)
    sigma_y, depth_y = integrated_at(sigma_t, depth, first, last, y)
    return mean_between(x, y, sigma_x, sigma_y, depth_x, depth_y)


@device
def stretch_extinction(gradient_opacity, table_2d, labels, medium, transfer, integrals, x, y, p):
    """Extinction of a short stretch of a ray with middle p, as light meets it and as it is.

    Pre-integrated where it depends on the scalar alone; with gradients, that of the middle. Labels,
    holes and cropping regions are those of the middle.
    """
    if gradient_opacity is None:
        if table_2d is None:
            first = first_entry(labels, transfer, p)
            there = in_regions(medium.regions, p, outside_holes(medium.holes, p, ONE))
            i = integrals
            light = there * mean_extinction(i.sigma_t, i.depth, first, i.last, x, y)
            if not integrals.limited:
                return light, light
            return light, there * mean_extinction(i.whole, i.whole_depth, first, i.last, x, y)
    _, sigma_t = classify(gradient_opacity, table_2d, medium, transfer, p)
    return min(sigma_t, integrals.most), sigma_t


@device
def stretch_albedo(colour_grid, table_2d, labels, medium, transfer, integrals, x, y, p):
    """Albedo of a stretch: weighted by extinction where it depends on the scalar alone."""
    if colour_grid is None:
        if table_2d is None:
            return mean_albedo(integrals, first_entry(labels, transfer, p), x, y)
    row = of_label(labels, transfer, p)
    return colour(colour_grid, table_2d, medium, row, p, trilinear(medium.values, p))


@device
def mean_albedo(integrals, first, x, y):
    """Albedo along a stretch from table position x to y of a row, weighted by extinction."""
    x, y = max(min(x, y), ZERO), max(max(x, y), ZERO)
    last = i32(integrals.last)
    i, j = min(i32(x), last - i32(1)), min(i32(y) + i32(1), last)
    a, b = index(first + i), index(first + j)
    # In double precision throughout: the inverse of what is faint in single precision is infinite
    total = integrals.depth[b] - integrals.depth[a]
    if j - i <= i32(2) or not total > f64(0.0):
        c = index(first + i32(HALF * (x + y) + HALF))
        return integrals.colour[c, 0], integrals.colour[c, 1], integrals.colour[c, 2]
    inverse = f64(1.0) / total
    return (
        f32((integrals.light[b, 0] - integrals.light[a, 0]) * inverse),
        f32((integrals.light[b, 1] - integrals.light[a, 1]) * inverse),
        f32((integrals.light[b, 2] - integrals.light[a, 2]) * inverse),
    )
