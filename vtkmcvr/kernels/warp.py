"""Maps from the unit square to disks, spheres and hemispheres."""

import math

import numpy as np

from .elementary import cosine_and_sine, on_circle
from .jit import device

f32 = np.float32
ZERO, ONE, TWO = f32(0.0), f32(1.0), f32(2.0)
PI = f32(math.pi)
TWO_PI, HALF_PI = f32(2.0 * math.pi), f32(0.5 * math.pi)
INVERSE_PI = f32(1.0 / math.pi)
LEAST = f32(1e-8)
INVERSE_4PI = f32(0.25 / math.pi)


@device
def concentric_disk(u, v):
    """Uniform point of the unit disk (Shirley and Chiu, JGT 2(3), 1997)."""
    a = TWO * u - ONE
    b = TWO * v - ONE
    if a == ZERO and b == ZERO:
        return ZERO, ZERO
    if abs(a) > abs(b):
        c, s = cosine_and_sine(b / a)
        return a * c, a * s
    c, s = cosine_and_sine(a / b)
    return b * s, b * c


@device
def uniform_sphere(u, v):
    """Uniform direction; density 1/(4 pi)."""
    z = ONE - TWO * u
    r = math.sqrt(max(ZERO, ONE - z * z))
    a, b = on_circle(v)
    return (r * a, r * b, z)


@device
def cosine_hemisphere(u, v):
    """Direction around +z with density cos(theta)/pi (Malley's method).

    Its cosine is at least 1e-4, which one in 10^8 would be below: rounding must not carry the
    direction under the surface, where its light would be lost.
    """
    a, b = concentric_disk(u, v)
    return (a, b, math.sqrt(max(LEAST, ONE - a * a - b * b)))
