"""Maps from the unit square to disks, spheres and hemispheres."""

import math

import numpy as np

from .jit import device

f32 = np.float32
ZERO, ONE, TWO = f32(0.0), f32(1.0), f32(2.0)
PI = f32(math.pi)
TWO_PI = f32(2.0 * math.pi)
QUARTER_PI, HALF_PI = f32(math.pi / 4.0), f32(math.pi / 2.0)
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
        r, phi = a, QUARTER_PI * (b / a)
    else:
        r, phi = b, HALF_PI - QUARTER_PI * (a / b)
    return r * math.cos(phi), r * math.sin(phi)


@device
def uniform_sphere(u, v):
    """Uniform direction; density 1/(4 pi)."""
    z = ONE - TWO * u
    r = math.sqrt(max(ZERO, ONE - z * z))
    phi = TWO_PI * v
    return (r * math.cos(phi), r * math.sin(phi), z)


@device
def cosine_hemisphere(u, v):
    """Direction around +z with density cos(theta)/pi (Malley's method).

    Its cosine is at least 1e-4, which one in 10^8 would be below: rounding must not carry the
    direction under the surface, where its light would be lost.
    """
    a, b = concentric_disk(u, v)
    return (a, b, math.sqrt(max(LEAST, ONE - a * a - b * b)))
