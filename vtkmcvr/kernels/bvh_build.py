"""Triangles in a bounding volume hierarchy: binary, split by the surface area heuristic.

The build is the binned one of Wald, "On fast construction of SAH-based bounding volume
hierarchies" (2007).

Nodes are in pairs: node 0 is the root, node 1 is unused, the sibling of a node is `node ^ 1`.
"""

import numpy as np

from .jit import device, kernel

BINS, LEAF_SIZE = 16, 4


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
