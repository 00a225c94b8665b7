"""Classification after interpolation: scalar -> extinction and colour, from one table."""

import math

import numpy as np

from .jit import device

f32, i32, index = np.float32, np.int32, np.uintp
NEXT = np.uintp(1)


@device
def table_position(transfer, scalar):
    """Entry and fraction. The table spans all scalars; rounding may pass its ends by a hair."""
    x = (scalar - transfer.lowest) * transfer.per_scalar
    i = min(i32(x), i32(len(transfer.sigma_t) - 2))
    return index(i), x - f32(i)


@device
def extinction(transfer, scalar):
    """sigma_t (1/world unit) of a scalar; 0 for NaN (no data is transparent)."""
    if math.isnan(scalar):
        return f32(0.0)
    scalar = max(scalar, transfer.lowest)
    i, f = table_position(transfer, scalar)
    a = transfer.sigma_t[i]
    return a + (transfer.sigma_t[i + NEXT] - a) * f


@device
def colour(transfer, scalar):
    """Single-scattering albedo, which is also the diffuse colour, of a scalar. Linear RGB."""
    i, f = table_position(transfer, scalar)
    table = transfer.colour
    return (
        table[i, 0] + (table[i + NEXT, 0] - table[i, 0]) * f,
        table[i, 1] + (table[i + NEXT, 1] - table[i, 1]) * f,
        table[i, 2] + (table[i + NEXT, 2] - table[i, 2]) * f,
    )


@device
def opacity(transfer, table, scalar):
    """Opacity in [0, 1] as the transfer function gives it, before the unit distance."""
    i, f = table_position(transfer, scalar)
    return table[i] + (table[i + NEXT] - table[i]) * f
