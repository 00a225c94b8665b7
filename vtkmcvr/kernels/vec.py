"""Vectors are 3-tuples of float32 (float64 where a ray enters the volume)."""

import math

import numpy as np

from .jit import device

f32, f64 = np.float32, np.float64
BLACK = (f32(0.0), f32(0.0), f32(0.0))


@device
def select(condition, a, b):
    """One of two numbers; of lanes, lane by lane."""
    return a if condition else b


@device
def dot(a, b):
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@device
def add(a, b):
    """Sum."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@device
def sub(a, b):
    """Difference."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@device
def mul(a, b):
    """Product by component, as of two colours."""
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


@device
def scale(a, s):
    """Vector times scalar."""
    return (a[0] * s, a[1] * s, a[2] * s)


@device
def at(o, d, t):
    """Point of the ray (o, d) at distance t."""
    return (o[0] + d[0] * t, o[1] + d[1] * t, o[2] + d[2] * t)


@device
def normalize(a):
    """Unit vector; the zero vector stays zero."""
    square = dot(a, a)
    if not square > f32(0.0):
        return a
    return scale(a, f32(1.0) / math.sqrt(square))


@device
def transform(m, a):
    """Matrix (three row tuples) times vector."""
    return (dot(m[0], a), dot(m[1], a), dot(m[2], a))


@device
def narrow(a):
    """float64 vector as float32."""
    return (f32(a[0]), f32(a[1]), f32(a[2]))


@device
def wide(a):
    """float32 vector as float64."""
    return (f64(a[0]), f64(a[1]), f64(a[2]))


@device
def largest(a):
    """Largest component."""
    return max(a[0], max(a[1], a[2]))


@device
def orthonormal_basis(n):
    """Two unit vectors orthogonal to unit n and to each other.

    Branchless and stable for every n (Duff et al., "Building an Orthonormal Basis, Revisited",
    JCGT 6(1), 2017).
    """
    sign = f32(1.0) if n[2] >= f32(0.0) else f32(-1.0)
    a = f32(-1.0) / (sign + n[2])
    b = n[0] * n[1] * a
    s = (f32(1.0) + sign * n[0] * n[0] * a, sign * b, -sign * n[0])
    t = (b, sign + n[1] * n[1] * a, -n[1])
    return s, t


@device
def from_basis(s, t, n, local):
    """Vector with coordinates `local` in the frame (s, t, n)."""
    return (
        s[0] * local[0] + t[0] * local[1] + n[0] * local[2],
        s[1] * local[0] + t[1] * local[1] + n[1] * local[2],
        s[2] * local[0] + t[2] * local[1] + n[2] * local[2],
    )
