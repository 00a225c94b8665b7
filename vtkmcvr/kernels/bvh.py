"""Where a ray meets the triangles of a bounding volume hierarchy, see `bvh_build`.

The walk needs no stack: it follows parent links, nearer child first (Hapala et al., "Efficient
stack-less BVH traversal for ray tracing", 2011), because kernels allocate nothing.
"""

import numpy as np

from .jit import device, exact
from .vec import add, dot, normalize, scale, sub

f32, f64, i32 = np.float32, np.float64, np.int32
ZERO, ONE = f32(0.0), f32(1.0)
FROM_PARENT, FROM_SIBLING, FROM_CHILD = 0, 1, 2
# Slack of the slab test, three roundings on either side (Ize 2013)
SLAB_SLACK = f32(1.0 + 6 * 2.0**-24)
STEEPEST = f32(1e30)


@device
def inverse(x):
    """1 / x, or 0 where that is not finite: the ray does not move along the axis."""
    if abs(x) < ONE / STEEPEST:
        return ZERO
    return ONE / x


@device
def node_hit(bounds, node, o, steep, t_min, t_max):
    """Whether the ray is in the node's box somewhere between t_min and t_max."""
    for axis in range(3):
        low, high = bounds[node, axis] - o[axis], bounds[node, axis + 3] - o[axis]
        if steep[axis] == ZERO:
            if low > ZERO or high < ZERO:
                return False
            continue
        a, b = low * steep[axis], high * steep[axis]
        near, far = min(a, b), max(a, b)
        # Outward on either sign
        t_min = max(t_min, min(near * SLAB_SLACK, near / SLAB_SLACK))
        t_max = min(t_max, max(far * SLAB_SLACK, far / SLAB_SLACK))
    return t_min <= t_max


@device
def near_child(bvh, node, d):
    """Child that a ray along d meets first."""
    axis = bvh.axis[node]
    return bvh.first[node] + (i32(1) if d[axis] < ZERO else i32(0))


@device
def corner(bvh, triangle, first):
    """Corner of a triangle, which starts at column 0, 3 or 6."""
    t = bvh.triangles
    return (t[triangle, first], t[triangle, first + 1], t[triangle, first + 2])


@exact
def side(a, b, d):
    """Side of the edge a b on which a ray along d passes, which starts at 0.

    In float64 the products of float32 coordinates are exact, so that b a gives exactly the opposite
    of a b: two triangles agree about their common edge, and no ray slips through between them.
    """
    x = f64(a[1]) * f64(b[2]) - f64(a[2]) * f64(b[1])
    y = f64(a[2]) * f64(b[0]) - f64(a[0]) * f64(b[2])
    z = f64(a[0]) * f64(b[1]) - f64(a[1]) * f64(b[0])
    return x * d[0] + y * d[1] + z * d[2]


@device
def triangle_distance(bvh, triangle, o, d):
    """Distance at which the ray meets a triangle, from either side; -STEEPEST without.

    Pluecker test, watertight (Davidovic et al., "3D rasterization", 2012).
    """
    a = sub(corner(bvh, triangle, 0), o)
    b = sub(corner(bvh, triangle, 3), o)
    c = sub(corner(bvh, triangle, 6), o)
    u, v, w = side(c, b, d), side(a, c, d), side(b, a, d)
    if (u < 0.0 or v < 0.0 or w < 0.0) and (u > 0.0 or v > 0.0 or w > 0.0):
        return -STEEPEST
    total = u + v + w
    if total == 0.0:
        return -STEEPEST
    return f32((u * dot(a, d) + v * dot(b, d) + w * dot(c, d)) / total)


@device
def cross(a, b):
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@device
def nearest_triangle(bvh, o, d, t_min, t_max, any_hit):
    """First triangle that the ray meets after t_min and before t_max: (triangle or -1, t).

    With `any_hit` the first one found, which answers whether the way is free.
    """
    found = i32(-1)
    if bvh is None:
        return found, t_max
    steep = (inverse(d[0]), inverse(d[1]), inverse(d[2]))
    node, state = i32(0), FROM_PARENT
    while True:
        if state == FROM_CHILD:
            above = bvh.parent[node]
            if above < 0:
                return found, t_max
            if node == near_child(bvh, above, d):
                node, state = i32(node ^ i32(1)), FROM_SIBLING
            else:
                node = above
            continue
        if node_hit(bvh.bounds, node, o, steep, t_min, t_max):
            if bvh.count[node] == 0:
                node, state = i32(near_child(bvh, node, d)), FROM_PARENT
                continue
            for k in range(bvh.first[node], bvh.first[node] + bvh.count[node]):
                t = triangle_distance(bvh, k, o, d)
                if t > t_min and t < t_max:
                    found, t_max = i32(k), t
            if any_hit and found >= 0:
                return found, t_max
        # Done with this node
        if bvh.parent[node] < 0:
            return found, t_max
        if state == FROM_PARENT:
            node, state = i32(node ^ i32(1)), FROM_SIBLING
        else:
            node, state = bvh.parent[node], FROM_CHILD


@device
def triangle_normal(bvh, triangle, x):
    """Normal of the face, and normal for shading, at a point of a triangle; unit vectors."""
    a = corner(bvh, triangle, 0)
    e1, e2 = sub(corner(bvh, triangle, 3), a), sub(corner(bvh, triangle, 6), a)
    area = cross(e1, e2)
    face = normalize(area)
    if len(bvh.normals) == 0:
        return face, face
    s = sub(x, a)
    square = dot(area, area)
    u = dot(cross(s, e2), area) / square
    v = dot(cross(e1, s), area) / square
    n = bvh.normals
    n0 = (n[triangle, 0], n[triangle, 1], n[triangle, 2])
    n1 = (n[triangle, 3], n[triangle, 4], n[triangle, 5])
    n2 = (n[triangle, 6], n[triangle, 7], n[triangle, 8])
    mixed = add(scale(n0, ONE - u - v), add(scale(n1, u), scale(n2, v)))
    if dot(mixed, face) < ZERO:
        face = scale(face, -ONE)
    if not dot(mixed, mixed) > ZERO:
        return face, face
    return face, normalize(mixed)
