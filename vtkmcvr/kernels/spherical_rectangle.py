"""Rectangles sampled by solid angle (Urena, Fajardo and King, EGSR 2013).

In float64: the solid angle is what a sum of four angles leaves of 2 pi. The rectangle lies in z = 0
of its frame, o is seen from.
"""

import math

import numpy as np

from .jit import device
from .vec import BLACK

f32, f64 = np.float32, np.float64
ZERO, ONE = f32(0.0), f32(1.0)
# Distance over half diagonal, squared, beyond which sampling the area is nearly as good
FAR = f32(16.0)
LEAST_SOLID_ANGLE = 1e-6


@device
def spherical_rectangle(size, o):
    """Solid angle S, z, x0, y0, x1, y1 and the constants b0, b1, k of the paper's algorithm."""
    z = -abs(f64(o[2]))
    x0, x1 = -f64(size[0]) - f64(o[0]), f64(size[0]) - f64(o[0])
    y0, y1 = -f64(size[1]) - f64(o[1]), f64(size[1]) - f64(o[1])
    n0 = -y0 / math.sqrt(z * z + y0 * y0)
    n1 = x1 / math.sqrt(z * z + x1 * x1)
    n2 = y1 / math.sqrt(z * z + y1 * y1)
    n3 = -x0 / math.sqrt(z * z + x0 * x0)
    k = 2.0 * math.pi - math.acos(-n2 * n3) - math.acos(-n3 * n0)
    solid_angle = math.acos(-n0 * n1) + math.acos(-n1 * n2) - k
    return solid_angle, z, x0, y0, x1, y1, n0, n2, k


@device
def rectangle_solid_angle(near, size, o):
    """Solid angle to sample, 0 where the area is sampled instead: far away, or seen edge-on."""
    if near is None:
        return ZERO
    square = o[0] * o[0] + o[1] * o[1] + o[2] * o[2]
    if o[2] == ZERO or square > FAR * (size[0] * size[0] + size[1] * size[1]):
        return ZERO
    solid_angle = spherical_rectangle(size, o)[0]
    return f32(solid_angle) if solid_angle > LEAST_SOLID_ANGLE else ZERO


@device
def sample_near_rectangle(near, size, o, u, v):
    """Direction from o, uniform over the solid angle of the rectangle, and the distance to it."""
    if near is None:
        return BLACK, ZERO
    solid_angle, z, x0, y0, x1, y1, b0, b1, k = spherical_rectangle(size, o)
    # The part to the left of x has the share u of the solid angle
    angle = f64(u) * solid_angle + k
    f = (math.cos(angle) * b0 - b1) / math.sin(angle)
    c = math.copysign(1.0, f) / math.sqrt(f * f + b0 * b0)
    c = min(max(c, -1.0), 1.0)
    x = min(max(-c * z / math.sqrt(max(1.0 - c * c, 1e-30)), x0), x1)
    # Along y, the cosine is uniform
    square = x * x + z * z
    h0, h1 = y0 / math.sqrt(square + y0 * y0), y1 / math.sqrt(square + y1 * y1)
    h = h0 + f64(v) * (h1 - h0)
    y = min(max(h * math.sqrt(square / max(1.0 - h * h, 1e-30)), y0), y1)
    distance = math.sqrt(square + y * y)
    down = z if o[2] > ZERO else -z
    return (f32(x / distance), f32(y / distance), f32(down / distance)), f32(distance)
