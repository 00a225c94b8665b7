"""Classification after interpolation: scalar and gradient -> extinction, colour, other channels."""

import math

import numpy as np

from ..packed import Transfer
from .cut import in_regions, outside_holes
from .grid import gradient, trilinear
from .jit import device
from .labels import label_row
from .vec import BLACK, dot, select

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, ONE = f32(0.0), f32(1.0)
NEXT = np.uintp(1)


@device
def table_position(transfer, scalar):
    """Entry and fraction. The table spans all scalars; rounding may pass its ends by a hair."""
    x = (scalar - transfer.lowest) * transfer.per_scalar
    i = min(i32(x), transfer.entries - i32(2))
    return index(transfer.first + i), x - f32(i)


@device
def row_start(labels, transfer, p):
    """First entry of the tables' row of the nearest voxel's label."""
    if labels is None:
        return transfer.first
    return i32(i32(label_row(labels, p)) * transfer.entries)


@device
def of_label(labels, transfer, p):
    """Transfer function at index position p: the row of the nearest voxel's label."""
    t = transfer
    return Transfer(
        t.sigma_t, t.colour, t.lowest, t.per_scalar, t.gradient_opacity, t.table_2d, t.colour_grid,
        t.emission, t.specular, t.exponent, t.phase, row_start(labels, t, p), t.entries,
    )  # fmt: skip


@device
def entries(table, i):
    """Entry i of a table, and the next one."""
    return table[i], table[i + NEXT]


@device
def extinction(transfer, scalar):
    """sigma_t (1/world unit) of a scalar; 0 for NaN (no data is transparent)."""
    # In this order the larger one is not NaN
    i, f = table_position(transfer, max(transfer.lowest, scalar))
    a, b = entries(transfer.sigma_t, i)
    return select(scalar == scalar, a + (b - a) * f, ZERO)


@device
def clamped_position(x, n):
    """Entry and fraction of a table of n entries at position x, which may lie beyond its ends."""
    x = min(max(x, ZERO), f32(n - 1))
    i = min(i32(x), i32(n - 2))
    return index(i), x - f32(i)


@device
def magnitude_at(medium, world_from_index_gradient, p):
    """Gradient magnitude at index position p, scalar per world unit; -1 beside missing data."""
    g = gradient(medium.values, world_from_index_gradient, p)
    square = dot(g, g)
    if math.isnan(square):
        return -ONE
    return math.sqrt(square)


@device
def gradient_factor(gradient_opacity, medium, p):
    """Factor on the extinction at index position p; 0 beside missing data."""
    magnitude = magnitude_at(medium, gradient_opacity.world_from_index_gradient, p)
    if magnitude < ZERO:
        return ZERO
    factor = gradient_opacity.factor
    i, f = clamped_position(magnitude * gradient_opacity.per_gradient, len(factor))
    return factor[i] + (factor[i + NEXT] - factor[i]) * f


@device
def position_2d(table, magnitude, scalar):
    """Entries and fractions in a table of scalar and gradient magnitude."""
    rows, columns = table.sigma_t.shape
    j, v = clamped_position((magnitude - table.lowest_gradient) * table.per_gradient, rows)
    i, u = clamped_position((scalar - table.lowest) * table.per_scalar, columns)
    return j, v, i, u


@device
def bilinear(a, b, c, d, u, v):
    """Between a and b (u = 0, 1 at v = 0), c and d (at v = 1)."""
    low = a + (b - a) * u
    return low + (c + (d - c) * u - low) * v


@device
def extinction_2d(table, medium, p, scalar):
    """sigma_t of a table of scalar and gradient magnitude; 0 beside missing data."""
    magnitude = magnitude_at(medium, table.world_from_index_gradient, p)
    if magnitude < ZERO:
        return ZERO
    j, v, i, u = position_2d(table, magnitude, scalar)
    t = table.sigma_t
    return bilinear(t[j, i], t[j, i + NEXT], t[j + NEXT, i], t[j + NEXT, i + NEXT], u, v)


@device
def classify(gradient_opacity, table_2d, medium, transfer, p):
    """Scalar at index position p and its extinction. Returns (scalar, sigma_t).

    A gradient is fetched only where the transfer function depends on it and may be above zero.
    Where the medium is cut off, the extinction is 0.
    """
    scalar = trilinear(medium.values, p)
    sigma_t = extinction(of_label(medium.labels, transfer, p), scalar)
    sigma_t = outside_holes(medium.holes, p, sigma_t)
    sigma_t = in_regions(medium.regions, p, sigma_t)
    if gradient_opacity is not None:
        if sigma_t > ZERO:
            sigma_t *= gradient_factor(gradient_opacity, medium, p)
    if table_2d is not None:
        if sigma_t > ZERO:
            sigma_t = extinction_2d(table_2d, medium, p, scalar)
    return scalar, sigma_t


@device
def rgb(table, transfer, scalar):
    """Entry of an (n, 3) table."""
    i, f = table_position(transfer, scalar)
    return (
        table[i, 0] + (table[i + NEXT, 0] - table[i, 0]) * f,
        table[i, 1] + (table[i + NEXT, 1] - table[i, 1]) * f,
        table[i, 2] + (table[i + NEXT, 2] - table[i, 2]) * f,
    )


@device
def colour_2d(table, medium, p, scalar):
    """Colour of a table of scalar and gradient magnitude."""
    magnitude = magnitude_at(medium, table.world_from_index_gradient, p)
    j, v, i, u = position_2d(table, magnitude, scalar)
    t, i1, j1 = table.colour, i + NEXT, j + NEXT
    return (
        bilinear(t[j, i, 0], t[j, i1, 0], t[j1, i, 0], t[j1, i1, 0], u, v),
        bilinear(t[j, i, 1], t[j, i1, 1], t[j1, i, 1], t[j1, i1, 1], u, v),
        bilinear(t[j, i, 2], t[j, i1, 2], t[j1, i, 2], t[j1, i1, 2], u, v),
    )


@device
def colour(colour_grid, table_2d, medium, transfer, p, scalar):
    """Single-scattering albedo, which is also the diffuse colour, at p. Linear RGB."""
    if colour_grid is not None:
        s = colour_grid.scale
        return (
            s * trilinear(colour_grid.red, p),
            s * trilinear(colour_grid.green, p),
            s * trilinear(colour_grid.blue, p),
        )
    if table_2d is not None:
        return colour_2d(table_2d, medium, p, scalar)
    return rgb(transfer.colour, transfer, scalar)


@device
def number_channel(table, transfer, scalar, constant):
    """A channel of one number: looked up where it varies."""
    if table is None:
        return constant
    i, f = table_position(transfer, scalar)
    return table[i] + (table[i + NEXT] - table[i]) * f


@device
def rgb_channel(table, transfer, scalar, constant):
    """A channel of three numbers: looked up where it varies."""
    if table is None:
        return constant
    return rgb(table, transfer, scalar)


@device
def emitted(emission, transfer, scalar, albedo):
    """Radiance that a collision adds: sigma_a / sigma_t of the medium's own, (1 - albedo) L_e."""
    if emission is None:
        return BLACK
    own = rgb(emission, transfer, scalar)
    return (
        (ONE - albedo[0]) * own[0],
        (ONE - albedo[1]) * own[1],
        (ONE - albedo[2]) * own[2],
    )
