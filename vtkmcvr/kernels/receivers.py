"""Receivers: opaque planes, boxes, spheres and meshes that a ray may meet.

A shape is the image of a unit shape under an affine map: the ray is taken back into the unit
shape's frame, where the intersection is a line or two; distances stay those of the world.
"""

import math

import numpy as np

from .bvh import nearest_triangle, triangle_normal
from .grid import INFINITE, box_interval
from .jit import device
from .vec import at, dot, normalize, scale, wide

f32, i32 = np.float32, np.int32
ZERO, ONE = f32(0.0), f32(1.0)
PLANE, BOX, SPHERE = 0, 1, 2
LOW, HIGH = (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)
# Rays that leave a receiver start this share of their distance from the middle off its face: some
# roundings of the float32 hit point
LIFT = f32(2e-6)


@device
def local(m, i, a, w):
    """Point (w = 1) or direction (w = 0) in the frame of unit shape i."""
    return (
        m[i, 0, 0] * a[0] + m[i, 0, 1] * a[1] + m[i, 0, 2] * a[2] + m[i, 0, 3] * w,
        m[i, 1, 0] * a[0] + m[i, 1, 1] * a[1] + m[i, 1, 2] * a[2] + m[i, 1, 3] * w,
        m[i, 2, 0] * a[0] + m[i, 2, 1] * a[1] + m[i, 2, 2] * a[2] + m[i, 2, 3] * w,
    )


@device
def square_distance(o, d):
    """Square |x|, |y| <= 1 in the plane z = 0."""
    if d[2] == ZERO:
        return -INFINITE, -INFINITE
    t = -o[2] / d[2]
    if abs(o[0] + d[0] * t) > ONE or abs(o[1] + d[1] * t) > ONE:
        return -INFINITE, -INFINITE
    return t, t


@device
def ball_distance(o, d):
    """Unit sphere, both intersections (Haines et al., "Precision improvements", 2019)."""
    square = dot(d, d)
    middle = -dot(o, d) / square
    nearest = at(o, d, middle)
    chord = (ONE - dot(nearest, nearest)) / square
    if not chord > ZERO:
        return -INFINITE, -INFINITE
    half = math.sqrt(chord)
    return middle - half, middle + half


@device
def shape_distance(receivers, i, o, d, t_min):
    """Distance beyond t_min at which the ray meets shape i, INFINITE without."""
    o = local(receivers.local_from_world, i, o, ONE)
    d = local(receivers.local_from_world, i, d, ZERO)
    kind = receivers.kind[i]
    near, far = -INFINITE, -INFINITE
    if kind == PLANE:
        near, far = square_distance(o, d)
    elif kind == BOX:
        enter, leave = box_interval(wide(o), wide(d), LOW, HIGH)
        if enter <= leave:
            near, far = f32(enter), f32(leave)
    else:
        near, far = ball_distance(o, d)
    if near > t_min:
        return near
    if far > t_min:
        return far
    return INFINITE


@device
def nearest_receiver(receivers, mesh, o, d, t_min, t_max, any_hit):
    """First receiver that the ray meets after t_min and before t_max.

    Returns (index or -1, t, triangle or -1). With `any_hit` any one will do.
    """
    index, triangle = i32(-1), i32(-1)
    if receivers is None:
        return index, t_max, triangle
    for i in range(len(receivers.kind)):
        t = shape_distance(receivers, i, o, d, t_min)
        if t < t_max:
            index, t_max = i32(i), t
            if any_hit:
                return index, t_max, triangle
    triangle, t_max = nearest_triangle(mesh, o, d, t_min, t_max, any_hit)
    if triangle >= 0:
        index = mesh_owner(mesh, triangle)
    return index, t_max, triangle


@device
def mesh_owner(mesh, triangle):
    """Receiver to which a triangle belongs."""
    if mesh is None:
        return i32(-1)
    return mesh.owner[triangle]


@device
def shape_normal(receivers, i, x):
    """Unit normal of shape i at its point x: the local one, by the inverse transpose."""
    m = receivers.local_from_world
    p = local(m, i, x, ONE)
    n = p
    if receivers.kind[i] == PLANE:
        n = (ZERO, ZERO, ONE)
    elif receivers.kind[i] == BOX:
        a, b, c = abs(p[0]), abs(p[1]), abs(p[2])
        if a >= b and a >= c:
            n = (p[0], ZERO, ZERO)
        elif b >= c:
            n = (ZERO, p[1], ZERO)
        else:
            n = (ZERO, ZERO, p[2])
    return normalize((
        m[i, 0, 0] * n[0] + m[i, 1, 0] * n[1] + m[i, 2, 0] * n[2],
        m[i, 0, 1] * n[0] + m[i, 1, 1] * n[1] + m[i, 2, 1] * n[2],
        m[i, 0, 2] * n[0] + m[i, 1, 2] * n[1] + m[i, 2, 2] * n[2],
    ))  # fmt: skip


@device
def mesh_normal(mesh, triangle, x):
    """`triangle_normal`, or nothing in a scene without meshes."""
    if mesh is None:
        return (ZERO, ZERO, ZERO), (ZERO, ZERO, ZERO)
    return triangle_normal(mesh, triangle, x)


@device
def receiver_point(receivers, mesh, index, triangle, x, wo):
    """Where a path goes on from hit point x: (x just off the face, normal for shading).

    Both on the side of wo. A shading normal that looks away from wo gives way to the face's.
    """
    if triangle >= 0:
        face, normal = mesh_normal(mesh, triangle, x)
    else:
        face = shape_normal(receivers, index, x)
        normal = face
    if dot(face, wo) < ZERO:
        face, normal = scale(face, -ONE), scale(normal, -ONE)
    if dot(normal, wo) <= ZERO:
        normal = face
    reach = max(abs(x[0]), max(abs(x[1]), abs(x[2]))) + receivers.reach
    return at(x, face, LIFT * reach), normal


@device
def receiver_colour(receivers, index):
    """Diffuse reflectance."""
    c = receivers.colour
    return (c[index, 0], c[index, 1], c[index, 2])
