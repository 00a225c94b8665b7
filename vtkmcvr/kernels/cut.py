"""Cuts: where a volume is left out, and the faces that this opens.

Convex cuts (planes, boxes, balls) shorten a ray's interval before it is walked, so that a look-up
costs nothing; what is not convex (holes, cropping regions) is asked at tentative collisions only.
Positions are index coordinates; heights over a face are world units.
"""

import math

import numpy as np

from .grid import FAR
from .jit import device
from .vec import dot, transform

f32, i32 = np.float32, np.int32
ZERO, ONE, THREE, NINE = f32(0.0), f32(1.0), i32(3), i32(9)
NO_FACE = (ZERO, ZERO, ZERO)


@device
def row4(table, i):
    """Row of an (n, 4) table as a tuple."""
    return (table[i, 0], table[i, 1], table[i, 2], table[i, 3])


@device
def height_over(plane, p):
    """Signed world distance of index position p from a plane (a, b, c, e)."""
    return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3]


@device
def ball_offset(world_from_index, ball, p):
    """World vector from the centre of a ball to index position p."""
    return transform(world_from_index, (p[0] - ball[0], p[1] - ball[1], p[2] - ball[2]))


@device
def clip_interval(clip, o, d, enter, leave):
    """Part of the ray's interval inside all clip planes and balls; empty if first >= second.

    The ray is float64.
    """
    if clip is None:
        return enter, leave
    for i in range(len(clip.planes)):
        plane = row4(clip.planes, i)
        height = height_over(plane, o)
        climb = plane[0] * d[0] + plane[1] * d[1] + plane[2] * d[2]
        if climb > 0.0:
            enter = max(enter, -height / climb)
        elif climb < 0.0:
            leave = min(leave, -height / climb)
        elif height < 0.0:
            leave = -FAR
    for i in range(len(clip.spheres)):
        ball = row4(clip.spheres, i)
        q = ball_offset(clip.world_from_index, ball, o)
        v = transform(clip.world_from_index, d)
        square = dot(v, v)
        middle = -dot(q, v) / square
        nearest = (q[0] + v[0] * middle, q[1] + v[1] * middle, q[2] + v[2] * middle)
        # Half the chord, squared: no cancellation of large squares (Haines et al. 2019)
        chord = (ball[3] * ball[3] - dot(nearest, nearest)) / square
        if chord > 0.0:
            half = math.sqrt(chord)
            enter = max(enter, middle - half)
            leave = min(leave, middle + half)
        else:
            leave = -FAR
    return enter, leave


@device
def box_height(planes, box, p):
    """(face, height) of the box face over which p is lowest; the height is negative outside."""
    first = 6 * box
    face, lowest = first, height_over(row4(planes, first), p)
    for i in range(first + 1, first + 6):
        height = height_over(row4(planes, i), p)
        if height < lowest:
            face, lowest = i, height
    return face, lowest


@device
def outside_holes(holes, p, sigma_t):
    """sigma_t, or 0 where index position p is in a hole."""
    if holes is None:
        return sigma_t
    for i in range(len(holes.planes) // 6):
        _, height = box_height(holes.planes, i, p)
        if height > ZERO:
            return ZERO
    for i in range(len(holes.spheres)):
        q = ball_offset(holes.world_from_index, row4(holes.spheres, i), p)
        if dot(q, q) < holes.spheres[i, 3] * holes.spheres[i, 3]:
            return ZERO
    return sigma_t


@device
def third(x, lower, upper):
    """0 below lower, 2 above upper, 1 between."""
    return i32(x > lower) + i32(x > upper)


@device
def region_kept(regions, x, y, z):
    """Whether a cropping region is kept."""
    return ((regions.flags >> (x + THREE * y + NINE * z)) & i32(1)) != i32(0)


@device
def in_regions(regions, p, sigma_t):
    """sigma_t, or 0 where index position p is in a cropping region that is cut off."""
    if regions is None:
        return sigma_t
    lo, hi = regions.lower, regions.upper
    x, y, z = third(p[0], lo[0], hi[0]), third(p[1], lo[1], hi[1]), third(p[2], lo[2], hi[2])
    if region_kept(regions, x, y, z):
        return sigma_t
    return ZERO
