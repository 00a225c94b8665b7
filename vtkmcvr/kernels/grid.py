"""The scalar field: interpolation, gradient, bounds. Positions are index coordinates (i, j, k)."""

import numpy as np

from .jit import device
from .vec import transform

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, ONE = f32(0.0), f32(1.0)
NEXT = np.uintp(1)
INFINITE = f32(1e30)
FAR = 1e30


@device
def corners(values, i, j, k):
    """Values at eight neighbouring points, along x first, then y, then z."""
    i1, j1, k1 = i + NEXT, j + NEXT, k + NEXT
    return (
        f32(values[k, j, i]), f32(values[k, j, i1]), f32(values[k, j1, i]), f32(values[k, j1, i1]),
        f32(values[k1, j, i]), f32(values[k1, j, i1]), f32(values[k1, j1, i]),
        f32(values[k1, j1, i1]),
    )  # fmt: skip


@device
def trilinear(values, p):
    """Scalar at index position p, clamped to the outer points; NaN where a corner is NaN.

    `values` is [k, j, i]; every axis has at least two points. Indices are unsigned because signed
    ones would each be tested for being negative.
    """
    nz, ny, nx = values.shape
    # In this order the larger one is not NaN: no position leads out of the array
    x = min(max(ZERO, p[0]), f32(nx - 1))
    y = min(max(ZERO, p[1]), f32(ny - 1))
    z = min(max(ZERO, p[2]), f32(nz - 1))
    a, b, c = min(i32(x), i32(nx - 2)), min(i32(y), i32(ny - 2)), min(i32(z), i32(nz - 2))
    fx, fy, fz = x - f32(a), y - f32(b), z - f32(c)
    v000, v100, v010, v110, v001, v101, v011, v111 = corners(values, index(a), index(b), index(c))
    c00 = v000 + (v100 - v000) * fx
    c10 = v010 + (v110 - v010) * fx
    c01 = v001 + (v101 - v001) * fx
    c11 = v011 + (v111 - v011) * fx
    c0 = c00 + (c10 - c00) * fy
    c1 = c01 + (c11 - c01) * fy
    return c0 + (c1 - c0) * fz


@device
def slope(values, before, after, width):
    """Difference quotient of the scalar between two index positions `width` apart along an axis."""
    return (trilinear(values, after) - trilinear(values, before)) / width


@device
def gradient(values, world_from_index_gradient, p):
    """World-space gradient (scalar per world unit) at index position p, float32 3-tuple.

    Central differences over one voxel, one-sided at the border (HC-22); the inverse transpose of
    the index-to-world map turns index differences into world ones.
    """
    nz, ny, nx = values.shape
    x0, x1 = max(p[0] - ONE, ZERO), min(p[0] + ONE, f32(nx - 1))
    y0, y1 = max(p[1] - ONE, ZERO), min(p[1] + ONE, f32(ny - 1))
    z0, z1 = max(p[2] - ONE, ZERO), min(p[2] + ONE, f32(nz - 1))
    g = (
        slope(values, (x0, p[1], p[2]), (x1, p[1], p[2]), x1 - x0),
        slope(values, (p[0], y0, p[2]), (p[0], y1, p[2]), y1 - y0),
        slope(values, (p[0], p[1], z0), (p[0], p[1], z1), z1 - z0),
    )
    return transform(world_from_index_gradient, g)


@device
def box_interval(o, d, lo, hi):
    """Parametric interval in which the ray (o, d) is inside the box; empty if first >= second.

    Slab test that lets no NaN through: a component of d that is zero leaves the interval as it is
    or empties it. All arguments are float64.
    """
    t0, t1 = -FAR, FAR
    for axis in range(3):
        if d[axis] == 0.0:
            if o[axis] < lo[axis] or o[axis] > hi[axis]:
                t1 = -FAR
                t0 = FAR
        else:
            inverse = 1.0 / d[axis]
            near = (lo[axis] - o[axis]) * inverse
            far = (hi[axis] - o[axis]) * inverse
            t0 = max(t0, min(near, far))
            t1 = min(t1, max(near, far))
    return t0, t1
