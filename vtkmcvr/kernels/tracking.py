"""The one walker of the medium: delta tracking and ratio tracking over a grid of local majorants.

Delta tracking: Woodcock et al. 1965. Ratio tracking: Novak, Selle, Jarosz, "Residual ratio tracking
for estimating attenuation in participating media", TOG 33(6), 2014. Majorant grid: Szirmay-Kalos et
al. 2011.
"""

import numpy as np

from .grid import INFINITE, trilinear
from .jit import device
from .rng import exponential, stratified_exponential, uniform
from .transfer import extinction
from .vec import at

f32, i32, index = np.float32, np.int32, np.uintp
ONE, ZERO = f32(1.0), f32(0.0)
ESCAPED = f32(-1.0)


@device
def first_cell(o, per_cell, n):
    """Cell of index coordinate o along an axis of n cells."""
    return min(max(i32(o * per_cell), i32(0)), i32(n - 1))


@device
def first_crossing(o, d, cell, cell_size):
    """Distance to the next cell face along an axis, distance between faces, and step (+-1)."""
    if d > ZERO:
        inverse = ONE / d
        return (f32(cell + i32(1)) * cell_size - o) * inverse, cell_size * inverse, i32(1)
    if d < ZERO:
        inverse = ONE / d
        return (f32(cell) * cell_size - o) * inverse, -cell_size * inverse, i32(-1)
    return INFINITE, INFINITE, i32(1)


@device
def leap(o, d, t, per_cell, n, cell, step, crossing, between):
    """Cell along an axis after a leap to distance t, and its next crossing."""
    landed = first_cell(o + d * t, per_cell, n)
    return landed, crossing + between * f32((landed - cell) * step)


@device
def walk(medium, transfer, o, d, length, ratio, rng):
    """Walk from o along d over `length` world units.

    Without `ratio` (None): delta tracking. Returns (t, scalar, 0, rng): the distance of the first
    real collision with the scalar found there, or ESCAPED. With `ratio`: ratio tracking. Returns
    (ESCAPED, 0, T, rng): an unbiased estimate of the transmittance, ended by Russian roulette once
    T is below `ratio.roulette`.

    o is in index coordinates, d in index coordinates per world unit, so t is in world units. An
    empty cell holds minus the radius, in cells, of the empty cube around it, which the ray crosses
    in one leap. The loop ends: every step moves on to another cell or past the end, and inside a
    cell each tentative collision moves on by an exponential step of mean 1/majorant, which the cap
    on extinction keeps above the float32 resolution of t.
    """
    majorant = medium.majorant
    nz, ny, nx = majorant.shape
    size = medium.cell_size
    per_cell = medium.cells_per_index
    cx, cy, cz = (
        first_cell(o[0], per_cell, nx), first_cell(o[1], per_cell, ny), first_cell(o[2], per_cell,
        nz)
    )  # fmt: skip
    tx, dx, sx = first_crossing(o[0], d[0], cx, size)
    ty, dy, sy = first_crossing(o[1], d[1], cy, size)
    tz, dz, sz = first_crossing(o[2], d[2], cz, size)

    t = ZERO
    T = ONE
    rng, tau = stratified_exponential(rng)
    while True:
        sigma_maj = majorant[index(cz), index(cy), index(cx)]
        # Empty cube: leap to its end
        if sigma_maj <= -ONE:
            t = min(min(tx - sigma_maj * dx, ty - sigma_maj * dy), tz - sigma_maj * dz)
            if t >= length:
                return ESCAPED, ZERO, T, rng
            cx, tx = leap(o[0], d[0], t, per_cell, nx, cx, sx, tx, dx)
            cy, ty = leap(o[1], d[1], t, per_cell, ny, cy, sy, ty, dy)
            cz, tz = leap(o[2], d[2], t, per_cell, nz, cz, sz, tz, dz)
            continue
        # Tentative collisions in this cell
        leave = min(min(tx, ty), min(tz, length))
        while True:
            reach = (leave - t) * sigma_maj
            if tau >= reach:
                tau -= reach
                break
            t += tau / sigma_maj
            scalar = trilinear(medium.values, at(o, d, t))
            sigma_t = extinction(transfer, scalar)
            if ratio is None:
                rng, u = uniform(rng)
                if u * sigma_maj < sigma_t:
                    return t, scalar, ZERO, rng
            else:
                T *= ONE - sigma_t / sigma_maj
                if T < ratio.roulette:
                    rng, u = uniform(rng)
                    if u * ratio.roulette >= T:
                        return ESCAPED, ZERO, ZERO, rng
                    T = ratio.roulette
            rng, tau = exponential(rng)
        # Next cell
        t = leave
        if leave >= length:
            return ESCAPED, ZERO, T, rng
        if tx <= ty and tx <= tz:
            cx = i32(cx + sx)
            tx += dx
            if cx < 0 or cx >= nx:
                return ESCAPED, ZERO, T, rng
        elif ty <= tz:
            cy = i32(cy + sy)
            ty += dy
            if cy < 0 or cy >= ny:
                return ESCAPED, ZERO, T, rng
        else:
            cz = i32(cz + sz)
            tz += dz
            if cz < 0 or cz >= nz:
                return ESCAPED, ZERO, T, rng


@device
def sample_collision(medium, transfer, o, d, length, rng):
    """Distance of the first collision, distributed as sigma_t(t) T(t). Returns (t, scalar, rng).

    t is ESCAPED (negative) when the ray leaves without one.
    """
    t, scalar, _, rng = walk(medium, transfer, o, d, length, None, rng)
    return t, scalar, rng


@device
def transmittance(medium, transfer, shadows, ratio, o, d, length, rng):
    """Unbiased estimate of the transmittance over `length` from o along d. Returns (T, rng).

    `shadows` None: light is not attenuated, T = 1 at no cost. `ratio` None: binary estimate by
    delta tracking, as Exposure Render does; otherwise ratio tracking.
    """
    if shadows is None:
        return ONE, rng
    length = min(length, shadows.reach)
    if length <= ZERO:
        return ONE, rng
    _, _, T, rng = walk(medium, transfer, o, d, length, ratio, rng)
    return T, rng
