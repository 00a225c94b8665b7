"""Textures of area lights: texture coordinates of a point on a surface, and bilinear lookup."""

import math

import numpy as np

from .jit import device
from .shapes import CYLINDER, RECTANGLE, SPHERE
from .vec import at
from .warp import PI, TWO_PI

f32 = np.float32
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
WHITE = (ONE, ONE, ONE)


@device
def texture_position(kind, size, p):
    """Position (s from left to right, t from top to bottom), in [0, 1], of a surface point."""
    if kind == SPHERE or kind == CYLINDER:
        s = math.atan2(p[1], p[0]) / TWO_PI
        s -= f32(math.floor(s))
        if kind == SPHERE:
            return s, math.acos(min(max(p[2] / size[0], -ONE), ONE)) / PI
        return s, HALF - HALF * p[2] / size[2]
    half_height = size[1] if kind == RECTANGLE else size[0]
    return HALF + HALF * p[0] / size[0], HALF - HALF * p[1] / half_height


@device
def texture_factor(textures, i, kind, size, o, d, distance):
    """Factor of the radiance of light i where the ray meets it, bilinear between texel centres."""
    if textures is None:
        return WHITE
    rows, columns = textures.layout[i, 1], textures.layout[i, 2]
    if rows == 0:
        return WHITE
    s, t = texture_position(kind, size, at(o, d, distance))
    x = min(max(s, ZERO), ONE) * f32(columns) - HALF
    y = min(max(t * f32(rows) - HALF, ZERO), f32(rows - 1))
    column, r0 = math.floor(x), int(y)
    fx, fy = x - f32(column), y - f32(r0)
    # What closes around the axis has no left and right end
    closed = kind == SPHERE or kind == CYLINDER
    c0 = column if column >= 0 else (columns - 1 if closed else 0)
    c1 = column + 1 if column + 1 < columns else (0 if closed else columns - 1)
    first = textures.layout[i, 0]
    r1 = min(r0 + 1, rows - 1)
    a, b = first + r0 * columns + c0, first + r0 * columns + c1
    c, e = first + r1 * columns + c0, first + r1 * columns + c1
    wa, wb, wc, we = (ONE - fx) * (ONE - fy), fx * (ONE - fy), (ONE - fx) * fy, fx * fy
    k = textures.texels
    return (
        k[a, 0] * wa + k[b, 0] * wb + k[c, 0] * wc + k[e, 0] * we,
        k[a, 1] * wa + k[b, 1] * wb + k[c, 1] * wc + k[e, 1] * we,
        k[a, 2] * wa + k[b, 2] * wb + k[c, 2] * wc + k[e, 2] * we,
    )
