"""Triangles in a bounding volume hierarchy: binary, split by the surface area heuristic.

The build is the binned one of Wald, "On fast construction of SAH-based bounding volume
hierarchies" (2007). The walk needs no stack: it follows parent links, nearer child first (Hapala et
al., "Efficient stack-less BVH traversal for ray tracing", 2011), because kernels allocate nothing.

Nodes are in pairs: node 0 is the root, node 1 is unused, the sibling of a node is `node ^ 1`.
"""

import numpy as np

from .jit import device, exact, kernel
from .vec import add, dot, normalize, scale, sub

f32, f64, i32 = np.float32, np.float64, np.int32
ZERO, ONE = f32(0.0), f32(1.0)
BINS, LEAF_SIZE = 16, 4
FROM_PARENT, FROM_SIBLING, FROM_CHILD = 0, 1, 2
# Slack of the slab test, three roundings on either side (Ize 2013)
SLAB_SLACK = f32(1.0 + 6 * 2.0**-24)
STEEPEST = f32(1e30)


@device
def reset(boxes, row):
    """Make a box (lower corner, upper corner) empty."""
    for axis in range(3):
        boxes[row, axis] = np.inf
        boxes[row, axis + 3] = -np.inf


@device
def grow(boxes, row, others, other):
    """Let a box enclose another one."""
    for axis in range(3):
        boxes[row, axis] = min(boxes[row, axis], others[other, axis])
        boxes[row, axis + 3] = max(boxes[row, axis + 3], others[other, axis + 3])


@device
def area(boxes, row):
    """Half the surface area of a box that is not empty."""
    x = boxes[row, 3] - boxes[row, 0]
    y = boxes[row, 4] - boxes[row, 1]
    z = boxes[row, 5] - boxes[row, 2]
    return x * y + y * z + z * x


@device
def widest_axis(boxes, order, start, end):
    """Axis along which the middles of some boxes, doubled, are most apart: (axis, from, to)."""
    best, origin, far = 0, np.float64(0.0), np.float64(-1.0)
    for axis in range(3):
        low, high = np.inf, -np.inf
        for i in range(start, end):
            middle = np.float64(boxes[order[i], axis]) + boxes[order[i], axis + 3]
            low, high = min(low, middle), max(high, middle)
        if high - low > far - origin:
            best, origin, far = axis, low, high
    return best, origin, far


@device
def bin_of(boxes, box, axis, origin, per_bin):
    """Bin of a box's middle along an axis."""
    middle = np.float64(boxes[box, axis]) + boxes[box, axis + 3]
    return min(int((middle - origin) * per_bin), BINS - 1)


@device
def best_bin(boxes, order, start, end, axis, origin, per_bin, bins, counts, after):
    """Bin after which a split costs least by the surface area heuristic; -1 without one.

    Scratch: boxes of BINS bins and one more, their counts, and the costs behind each.
    """
    for b in range(BINS):
        reset(bins, b)
        counts[b] = 0
    for i in range(start, end):
        b = bin_of(boxes, order[i], axis, origin, per_bin)
        counts[b] += 1
        grow(bins, b, boxes, order[i])
    reset(bins, BINS)
    n = 0
    for b in range(BINS - 1, 0, -1):
        grow(bins, BINS, bins, b)
        n += counts[b]
        after[b - 1] = area(bins, BINS) * n if n > 0 else 0.0
    reset(bins, BINS)
    n = 0
    best, least = -1, np.inf
    for b in range(BINS - 1):
        grow(bins, BINS, bins, b)
        n += counts[b]
        if 0 < n < end - start:
            cost = area(bins, BINS) * n + after[b]
            if cost < least:
                best, least = b, cost
    return best


@device
def partition(boxes, order, start, end, axis, origin, per_bin, split):
    """Order some boxes so that those of bins up to `split` come first; returns where they end."""
    middle = start
    for i in range(start, end):
        box = order[i]
        if bin_of(boxes, box, axis, origin, per_bin) <= split:
            order[i] = order[middle]
            order[middle] = box
            middle += 1
    return middle


@kernel
def build(boxes, order, bounds, first, count, axes, parent, bins, counts, after):
    """Fill the nodes of a hierarchy over boxes (n, 6), and order the boxes.

    A leaf has `count` boxes from `first` on; an inner node has count 0 and its first child in
    `first`. Returns the number of nodes. Equal middles are split in half, so that it ends.
    """
    first[0], count[0], parent[0] = 0, len(order), -1
    used, node = 2, 0
    while node < used:
        start, end = first[node], first[node] + count[node]
        reset(bounds, node)
        for i in range(start, end):
            grow(bounds, node, boxes, order[i])
        axis, origin, far = widest_axis(boxes, order, start, end)
        axes[node] = axis
        if end - start > LEAF_SIZE:
            middle = (start + end) // 2
            per_bin = BINS / (far - origin)
            if far > origin and per_bin < np.inf:
                split = best_bin(
                    boxes, order, start, end, axis, origin, per_bin, bins, counts, after
                )
                if split >= 0:
                    middle = partition(boxes, order, start, end, axis, origin, per_bin, split)
            first[used], count[used] = start, middle - start
            first[used + 1], count[used + 1] = middle, end - middle
            parent[used] = node
            parent[used + 1] = node
            first[node], count[node] = used, 0
            used += 2
        # Node 1 is no node
        node += 2 if node == 0 else 1
    return used


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
