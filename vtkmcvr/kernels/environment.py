"""Light from infinity: constant, a gradient, or a latitude-longitude map sampled by its radiance.

Local frame of a map: +y is up (row 0), columns run with atan2(x, -z). Pixels are values at texel
centres, bilinear between them; a texel is chosen with the exact mean of that interpolant times its
solid angle.
"""

import math

import numpy as np

from ..packed import MOST_TEXELS
from .elementary import angle, on_circle
from .jit import device
from .rng import stratified_pair
from .vec import BLACK, add, dot, scale, transform
from .warp import HALF_PI, PI, TWO_PI

f32, i32 = np.float32, np.int32
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Halvings of a table that leave one step of it, for as many entries as a map may have
HALVINGS = MOST_TEXELS.bit_length() - 1


@device
def gradient_radiance(gradient, middle, d):
    """Radiance from direction d: three colours, linear in the angle of elevation."""
    if gradient is None:
        return middle
    v = math.asin(min(max(dot(gradient.up, d), -ONE), ONE)) / HALF_PI
    end = gradient.top if v > ZERO else gradient.bottom
    return add(scale(middle, ONE - abs(v)), scale(end, abs(v)))


@device
def ambient_radiance(ambient, d):
    """Radiance of the constant or gradient environment from direction d."""
    if ambient is None:
        return BLACK
    return gradient_radiance(ambient.gradient, ambient.radiance, d)


@device
def map_position(environment, d):
    """Column and row (texel units, continuous) of a world direction."""
    rows, columns, _ = environment.pixels.shape
    local = transform(environment.local_from_world, d)
    phi = angle(-local[2], local[0])
    phi = phi + TWO_PI if phi < ZERO else phi
    theta = angle(local[1], math.sqrt(local[0] * local[0] + local[2] * local[2]))
    return phi / TWO_PI * f32(columns), theta / PI * f32(rows)


@device
def texel_of(x, n):
    """Number of the texel at position x >= 0 along a side of n."""
    return min(i32(x), i32(n - 1))


@device
def environment_radiance(environment, d):
    """Radiance arriving from direction d, bilinear."""
    if environment is None:
        return BLACK
    pixels = environment.pixels
    rows, columns, _ = pixels.shape
    x, y = map_position(environment, d)
    x = x - HALF
    x = x + f32(columns) if x < ZERO else x
    y = min(max(y - HALF, ZERO), f32(rows - 1))
    i, j = texel_of(x, columns), texel_of(y, rows)
    i1 = i + i32(1) if i + 1 < columns else i32(0)
    j1 = min(j + i32(1), i32(rows - 1))
    fx, fy = x - f32(i), y - f32(j)
    a, b = (ONE - fx) * (ONE - fy), fx * (ONE - fy)
    c, e = (ONE - fx) * fy, fx * fy
    return (
        pixels[j, i, 0] * a + pixels[j, i1, 0] * b + pixels[j1, i, 0] * c + pixels[j1, i1, 0] * e,
        pixels[j, i, 1] * a + pixels[j, i1, 1] * b + pixels[j1, i, 1] * c + pixels[j1, i1, 1] * e,
        pixels[j, i, 2] * a + pixels[j, i1, 2] * b + pixels[j1, i, 2] * c + pixels[j1, i1, 2] * e,
    )


@device
def texel_density(environment, j, i):
    """Density per steradian inside texel (row j, column i)."""
    _, columns, _ = environment.pixels.shape
    chance = environment.row_cdf[j + 1] - environment.row_cdf[j]
    chance *= environment.column_cdf[j, i + 1] - environment.column_cdf[j, i]
    height = environment.row_edge[j] - environment.row_edge[j + 1]
    return chance * f32(columns) / (TWO_PI * height)


@device
def environment_pdf(environment, d):
    """Density of `sample_environment` per steradian."""
    if environment is None:
        return ZERO
    rows, columns, _ = environment.pixels.shape
    x, y = map_position(environment, d)
    return texel_density(environment, texel_of(y, rows), texel_of(x, columns))


@device
def cdf_index(cdf, u):
    """Index i with cdf[i] <= u < cdf[i + 1], and the fraction of u inside that step.

    Always as many halvings, so that they can go in lanes.
    """
    lo, hi = i32(0), i32(len(cdf) - 1)
    for _ in range(HALVINGS):
        middle = (lo + hi) >> i32(1)
        below = cdf[middle] <= u
        lo, hi = middle if below else lo, hi if below else middle
    step = cdf[lo + 1] - cdf[lo]
    fraction = (u - cdf[lo]) / step if step > ZERO else HALF
    return lo, min(max(fraction, ZERO), ONE)


@device
def sample_environment(environment, rng):
    """Direction drawn by radiance. Returns (wi, radiance, density, rng)."""
    _, columns, _ = environment.pixels.shape
    rng, u, v = stratified_pair(rng)
    j, fy = cdf_index(environment.row_cdf, u)
    i, fx = cdf_index(environment.column_cdf[j], v)
    # Uniform in solid angle inside the texel
    top, bottom = environment.row_edge[j], environment.row_edge[j + 1]
    y = top + (bottom - top) * fy
    r = math.sqrt(max(ZERO, ONE - y * y))
    c, s = on_circle((f32(i) + fx) / f32(columns))
    wi = transform(environment.world_from_local, (r * s, y, -r * c))
    return wi, environment_radiance(environment, wi), texel_density(environment, j, i), rng
