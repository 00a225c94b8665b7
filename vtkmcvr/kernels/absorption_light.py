"""Light of a stretch of a camera ray: its mean colour, shaded by its normal, and what it emits."""

import math

import numpy as np

from .cone_transfer import NARROW, first_entry, integral_at
from .grid import gradient, trilinear
from .jit import device
from .transfer import colour, of_label
from .vec import BLACK, dot, scale

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Share of all that a table integrates to below which a difference of two integrals is noise
LEAST_SHARE = 1e-9


@device
def normal_at(world_from_index_gradient, medium, p, toward_eye):
    """Unit normal toward the eye; 0 where there is no gradient."""
    if world_from_index_gradient is None:
        return BLACK
    g = gradient(medium.values, world_from_index_gradient, p)
    square = dot(g, g)
    if not square > ZERO:
        return BLACK
    side = -ONE if dot(g, toward_eye) < ZERO else ONE
    return scale(g, side / math.sqrt(square))


@device
def shaded(phong, colour, normal, toward_eye):
    """Colour under a lamp at the eye, both sides lit, cut off at 1: as VTK's GPU ray caster has it.

    The lamp's reflection meets the eye at twice the angle of the normal: r.v = 2 (n.v)^2 - 1.
    """
    if phong is None:
        return colour
    facing = min(dot(normal, toward_eye), ONE)
    matt = phong.ambient + phong.diffuse * facing
    # Without a gradient, ambient light only
    mirrored = f32(2.0) * facing * facing - ONE
    glint = phong.specular * mirrored**phong.power if mirrored > ZERO else ZERO
    return (
        min(colour[0] * matt + glint, ONE),
        min(colour[1] * matt + glint, ONE),
        min(colour[2] * matt + glint, ONE),
    )


@device
def entry_colour(table, first, last, x):
    """Colour at table position x of a row."""
    i = min(i32(x), i32(last) - i32(1))
    f = x - f32(i)
    a, b = index(first + i), index(first + i + i32(1))
    return (
        table[a, 0] + (table[b, 0] - table[a, 0]) * f,
        table[a, 1] + (table[b, 1] - table[a, 1]) * f,
        table[a, 2] + (table[b, 2] - table[a, 2]) * f,
    )


@device
def light_integral(integrals, first, last, x, c):
    """Integral of extinction times colour, linear between entries, up to position x of a row."""
    i = min(i32(x), i32(last) - i32(1))
    f = x - f32(i)
    j = index(first + i)
    k = index(first + i + i32(1))
    a = integrals.sigma_t[j] * integrals.colour[j, c]
    slope = integrals.sigma_t[k] * integrals.colour[k, c] - a
    return integrals.light[j, c] + f * (a + HALF * f * slope)


@device
def mean_colour(integrals, first, x, y):
    """Colour between table positions x and y of a row, weighted by extinction."""
    last = integrals.last
    if abs(y - x) >= NARROW:
        low, high = min(x, y), max(x, y)
        sigma_t, depth = integrals.sigma_t, integrals.depth
        total = integral_at(sigma_t, depth, first, last, high)
        total -= integral_at(sigma_t, depth, first, last, low)
        if total > LEAST_SHARE * depth[index(first + i32(last))]:
            scale_by = 1.0 / total
            return (
                f32((light_integral(integrals, first, last, high, 0)
                - light_integral(integrals, first, last, low, 0)) * scale_by),
                f32((light_integral(integrals, first, last, high, 1)
                - light_integral(integrals, first, last, low, 1)) * scale_by),
                f32((light_integral(integrals, first, last, high, 2)
                - light_integral(integrals, first, last, low, 2)) * scale_by),
            )  # fmt: skip
    return entry_colour(integrals.colour, first, last, HALF * (x + y))


@device
def colour_of(colour_grid, table_2d, volume, x, y, p):
    """Colour of a stretch with middle p: pre-integrated where it depends on the scalar alone."""
    medium, transfer = volume.medium, volume.transfer
    if colour_grid is None:
        if table_2d is None:
            return mean_colour(volume.integrals, first_entry(medium.labels, transfer, p), x, y)
    row = of_label(medium.labels, transfer, p)
    return colour(colour_grid, table_2d, medium, row, p, trilinear(medium.values, p))


@device
def own_light(emission, volume, x, y, p, albedo):
    """Radiance of the medium's own, of the middle between two table positions: (1 - albedo) L_e."""
    if emission is None:
        return BLACK
    first = first_entry(volume.medium.labels, volume.transfer, p)
    own = entry_colour(emission, first, volume.integrals.last, HALF * (x + y))
    return (
        (ONE - albedo[0]) * own[0],
        (ONE - albedo[1]) * own[1],
        (ONE - albedo[2]) * own[2],
    )
