"""Canonical surfaces of area lights, each in its own frame around the origin.

A rectangle (half width, half height) and a disk (radius, inner radius) lie in z = 0 with the normal
+z; a sphere has a radius; a cylinder (radius, -, half height) is an open tube around z whose normal
points outward. Directions are drawn uniformly in solid angle or uniformly over the area; `extent`
says which, so that sampling and density always agree.
"""

import math

import numpy as np

from .elementary import on_circle
from .grid import INFINITE
from .jit import device
from .spherical_rectangle import rectangle_solid_angle, sample_near_rectangle
from .vec import BLACK, at, dot, from_basis, orthonormal_basis, scale, sub
from .warp import PI, TWO_PI, uniform_sphere

f32 = np.float32
ZERO, ONE, TWO, FOUR = f32(0.0), f32(1.0), f32(2.0), f32(4.0)
RECTANGLE, DISK, SPHERE, CYLINDER = map(np.int32, range(4))


# Where a ray meets it


@device
def sphere_distance(spheres, size, o, d):
    """Distance to the sphere, INFINITE if the ray does not meet it."""
    if spheres is None:
        return INFINITE
    middle = -dot(o, d)
    closest = at(o, d, middle)
    square = size[0] * size[0] - dot(closest, closest)
    if not square >= ZERO:
        return INFINITE
    half = math.sqrt(square)
    if middle - half > ZERO:
        return middle - half
    return middle + half if middle + half > ZERO else INFINITE


@device
def cylinder_distance(cylinders, size, o, d):
    """Distance to the tube, INFINITE if the ray does not meet it."""
    if cylinders is None:
        return INFINITE
    a = d[0] * d[0] + d[1] * d[1]
    if not a > ZERO:
        return INFINITE
    middle = -(o[0] * d[0] + o[1] * d[1]) / a
    x, y = o[0] + d[0] * middle, o[1] + d[1] * middle
    square = size[0] * size[0] - x * x - y * y
    if not square >= ZERO:
        return INFINITE
    half = math.sqrt(square / a)
    if middle - half > ZERO and abs(o[2] + d[2] * (middle - half)) <= size[2]:
        return middle - half
    if middle + half > ZERO and abs(o[2] + d[2] * (middle + half)) <= size[2]:
        return middle + half
    return INFINITE


@device
def shape_distance(shapes, kind, size, o, d):
    """Distance at which the ray first meets the surface, INFINITE if it does not."""
    if kind == SPHERE:
        return sphere_distance(shapes.spheres, size, o, d)
    if kind == CYLINDER:
        return cylinder_distance(shapes.cylinders, size, o, d)
    if d[2] == ZERO:
        return INFINITE
    t = -o[2] / d[2]
    if not t > ZERO:
        return INFINITE
    x, y = o[0] + d[0] * t, o[1] + d[1] * t
    if kind == DISK:
        square = x * x + y * y
        inside = size[1] * size[1] <= square and square <= size[0] * size[0]
    else:
        inside = abs(x) <= size[0] and abs(y) <= size[1]
    return t if inside else INFINITE


@device
def facing(kind, size, two_sided, o, d, distance):
    """Cosine at the light for a ray that meets it; 0 on its dark side."""
    if kind == SPHERE:
        # Drawn by solid angle: only the side matters
        cosine = ONE if dot(o, o) > size[0] * size[0] else -ONE
    elif kind == CYLINDER:
        p = at(o, d, distance)
        cosine = -(p[0] * d[0] + p[1] * d[1]) / size[0]
    else:
        cosine = -d[2]
    return abs(cosine) if two_sided else max(cosine, ZERO)


# What is drawn from: its solid angle, or its area


@device
def sphere_cap(size, o):
    """1 - cosine of the half angle under which the sphere is seen, precise for small ones."""
    square = size[0] * size[0] / dot(o, o)
    return square / (ONE + math.sqrt(ONE - square))


@device
def visible_arc(cylinders, size, two_sided, o):
    """Half angle of the tube's outer side that can be seen from o; all around where both emit."""
    if cylinders is None:
        return PI
    away = math.sqrt(o[0] * o[0] + o[1] * o[1])
    if two_sided or away <= size[0]:
        return PI
    return math.acos(size[0] / away)


@device
def extent(shapes, kind, size, two_sided, o):
    """(solid angle, 0) where directions are drawn by solid angle, else (0, area)."""
    if kind == SPHERE:
        if dot(o, o) <= size[0] * size[0]:
            return FOUR * PI, ZERO
        return TWO_PI * sphere_cap(size, o), ZERO
    if kind == CYLINDER:
        return ZERO, FOUR * visible_arc(shapes.cylinders, size, two_sided, o) * size[0] * size[2]
    if kind == DISK:
        return ZERO, PI * (size[0] * size[0] - size[1] * size[1])
    return rectangle_solid_angle(shapes.near_rectangles, size, o), FOUR * size[0] * size[1]


@device
def shape_pdf(shapes, kind, size, two_sided, o, d, distance):
    """Density per steradian of `sample_shape` for a ray that meets the surface at this distance."""
    cosine = facing(kind, size, two_sided, o, d, distance)
    if not cosine > ZERO:
        return ZERO
    solid_angle, area = extent(shapes, kind, size, two_sided, o)
    if solid_angle > ZERO:
        return ONE / solid_angle
    return distance * distance / (cosine * area)


# Drawing directions


@device
def toward(o, p):
    """Unit vector from o to p and distance; no direction where they coincide."""
    v = sub(p, o)
    distance = math.sqrt(dot(v, v))
    if not distance > ZERO:
        return BLACK, ZERO
    return scale(v, ONE / distance), distance


@device
def sample_disk(disks, size, o, u, v):
    """Uniform over the area of the disk or ring."""
    if disks is None:
        return BLACK, ZERO
    inner = size[1] * size[1]
    r = math.sqrt(inner + u * (size[0] * size[0] - inner))
    c, s = on_circle(v)
    return toward(o, (r * c, r * s, ZERO))


@device
def sample_sphere(spheres, size, o, u, v):
    """Uniform over the cone that the sphere fills (Shirley, Wang and Zimmerman, TOG 15(1), 1996).

    From inside, uniform over all directions.
    """
    if spheres is None:
        return BLACK, ZERO
    square = dot(o, o)
    if square <= size[0] * size[0]:
        d = uniform_sphere(u, v)
        return d, sphere_distance(spheres, size, o, d)
    away = math.sqrt(square)
    x = u * sphere_cap(size, o)
    sine_square = x * (TWO - x)
    sine = math.sqrt(sine_square)
    c, s = on_circle(v)
    axis = scale(o, -ONE / away)
    a, b = orthonormal_basis(axis)
    d = from_basis(a, b, axis, (sine * c, sine * s, ONE - x))
    depth = math.sqrt(max(ZERO, size[0] * size[0] - square * sine_square))
    return d, away * (ONE - x) - depth


@device
def sample_cylinder(cylinders, size, two_sided, o, u, v):
    """Uniform over the part of the tube that can be seen."""
    if cylinders is None:
        return BLACK, ZERO
    phi = math.atan2(o[1], o[0]) + (TWO * u - ONE) * visible_arc(cylinders, size, two_sided, o)
    z = (TWO * v - ONE) * size[2]
    return toward(o, (size[0] * math.cos(phi), size[0] * math.sin(phi), z))


@device
def sample_shape(shapes, kind, size, two_sided, o, u, v):
    """Direction from o to a point of the surface, and its distance."""
    if kind == SPHERE:
        return sample_sphere(shapes.spheres, size, o, u, v)
    if kind == CYLINDER:
        return sample_cylinder(shapes.cylinders, size, two_sided, o, u, v)
    if kind == DISK:
        return sample_disk(shapes.disks, size, o, u, v)
    if rectangle_solid_angle(shapes.near_rectangles, size, o) > ZERO:
        return sample_near_rectangle(shapes.near_rectangles, size, o, u, v)
    return toward(o, ((TWO * u - ONE) * size[0], (TWO * v - ONE) * size[1], ZERO))
