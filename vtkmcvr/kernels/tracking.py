"""The one walker of the medium: delta tracking and ratio tracking over a grid of local majorants.

Delta tracking: Woodcock et al. 1965. Ratio tracking: Novak, Selle, Jarosz, "Residual ratio tracking
for estimating attenuation in participating media", TOG 33(6), 2014. Majorant grid: Szirmay-Kalos et
al. 2011.
"""

import math

import numpy as np

from .grid import INFINITE
from .jit import device
from .rng import exponential, stratified, stratified_exponential, uniform
from .transfer import classify
from .vec import at, select

f32, i32, index = np.float32, np.int32, np.uintp
ONE, ZERO = f32(1.0), f32(0.0)
ESCAPED = f32(-1.0)
# What an extinction above its majorant turns into, so that the film can count it: no sum of
# radiance is -inf otherwise
VIOLATED = f32(-math.inf)


@device
def first_cell(o, per_cell, n):
    """Cell of index coordinate o along an axis of n cells."""
    return min(max(i32(o * per_cell), i32(0)), i32(n - 1))


@device
def first_crossing(o, d, cell, cell_size):
    """Distance to the next cell face along an axis, distance between faces, and step (+-1)."""
    still = d == ZERO
    inverse = ONE / select(still, ONE, d)
    face = select(d > ZERO, f32(cell + i32(1)), f32(cell)) * cell_size
    between = cell_size * inverse
    return (
        select(still, INFINITE, (face - o) * inverse),
        select(still, INFINITE, max(between, -between)),
        select(d < ZERO, i32(-1), i32(1)),
    )


@device
def leap(o, d, t, per_cell, n, cell, step, crossing, between):
    """Cell along an axis after a leap to distance t, and its next crossing."""
    landed = first_cell(o + d * t, per_cell, n)
    return landed, crossing + between * f32((landed - cell) * step)


@device
def walk(medium, transfer, o, d, length, ratio, rng):
    """Walk from o along d over `length` world units.

    Without `ratio` (None): delta tracking. Returns (t, scalar, sigma_t, 0, rng): the distance of
    the first real collision with the scalar and the extinction found there, or ESCAPED and T = 1.
    With `ratio`: ratio tracking. Returns (ESCAPED, 0, 0, T, rng): an unbiased estimate of the
    transmittance, ended by Russian roulette once T is below `ratio.roulette`.

    o is in index coordinates, d in index coordinates per world unit, so t is in world units. An
    empty cell holds minus the radius, in cells, of the empty cube around it, which the ray crosses
    in one leap. The loop ends: every step moves on to another cell or past the end, and inside a
    cell each tentative collision moves on by an exponential step of mean 1/majorant, which the cap
    on extinction keeps above the float32 resolution of t.

    An extinction above its majorant would bias the result; it comes back as a sigma_t of inf and as
    T = VIOLATED, and spoils the sample (HC-04).
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
                return ESCAPED, ZERO, ZERO, T, rng
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
            scalar, sigma_t = classify(
                transfer.gradient_opacity, transfer.table_2d, medium, transfer, at(o, d, t)
            )
            if ratio is None:
                rng, u = uniform(rng)
                if u * sigma_maj < sigma_t:
                    if sigma_t > sigma_maj:
                        return t, scalar, -VIOLATED, VIOLATED, rng
                    return t, scalar, sigma_t, ZERO, rng
            else:
                T *= ONE - sigma_t / sigma_maj
                if T < ratio.roulette:
                    if sigma_t > sigma_maj:
                        return ESCAPED, ZERO, ZERO, VIOLATED, rng
                    rng, u = uniform(rng)
                    if u * ratio.roulette >= T:
                        return ESCAPED, ZERO, ZERO, ZERO, rng
                    T = ratio.roulette
            rng, tau = exponential(rng)
        # Next cell
        t = leave
        if leave >= length:
            return ESCAPED, ZERO, ZERO, T, rng
        if tx <= ty and tx <= tz:
            cx += sx
            tx += dx
            if cx < 0 or cx >= nx:
                return ESCAPED, ZERO, ZERO, T, rng
        elif ty <= tz:
            cy += sy
            ty += dy
            if cy < 0 or cy >= ny:
                return ESCAPED, ZERO, ZERO, T, rng
        else:
            cz += sz
            tz += dz
            if cz < 0 or cz >= nz:
                return ESCAPED, ZERO, ZERO, T, rng


@device
def march(marching, medium, transfer, o, d, length, ratio, rng):
    """As `walk`, in steps of equal length, extinction constant in each; biased.

    The first step is cut off at random, so that errors are noise instead of bands.
    """
    step = marching.step
    rng, u = stratified(rng)
    rng, tau = stratified_exponential(rng)
    depth = ZERO
    steps = i32(length / step) + i32(2)
    for i in range(steps):
        start = (f32(i) - u) * step
        near, far = max(start, ZERO), min(start + step, length)
        if far > near:
            scalar, sigma_t = classify(
                transfer.gradient_opacity, transfer.table_2d, medium, transfer,
                at(o, d, f32(0.5) * (near + far)),
            )  # fmt: skip
            depth += sigma_t * (far - near)
            if ratio is None:
                if depth > tau:
                    return far - (depth - tau) / sigma_t, scalar, sigma_t, ZERO, rng
    if ratio is None:
        return ESCAPED, ZERO, ZERO, ONE, rng
    return ESCAPED, ZERO, ZERO, math.exp(-depth), rng


@device
def sample_collision(marching, medium, transfer, o, d, length, rng):
    """Distance of the first collision, distributed as sigma_t(t) T(t).

    Returns (t, scalar, sigma_t, rng); t is ESCAPED (negative) when the ray leaves without one.
    """
    if marching is None:
        t, scalar, sigma_t, _, rng = walk(medium, transfer, o, d, length, None, rng)
    else:
        t, scalar, sigma_t, _, rng = march(marching, medium, transfer, o, d, length, None, rng)
    return t, scalar, sigma_t, rng


@device
def transmittance(shadows, marching, medium, transfer, ratio, o, d, length, rng):
    """Estimate of the transmittance over `length` from o along d, unbiased but when marching.

    `shadows` None: light is not attenuated, T = 1 at no cost. `ratio` None: binary estimate by
    delta tracking, as Exposure Render does; otherwise ratio tracking. Returns (T, rng).
    """
    if shadows is None:
        return ONE, rng
    length = min(length, shadows.reach)
    if length <= ZERO:
        return ONE, rng
    if marching is None:
        _, _, _, T, rng = walk(medium, transfer, o, d, length, ratio, rng)
    else:
        _, _, _, T, rng = march(marching, medium, transfer, o, d, length, ratio, rng)
    return T, rng
