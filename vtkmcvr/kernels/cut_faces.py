"""Faces that cuts open, and their normals. Positions are index coordinates, heights world units."""

import math

import numpy as np

from .cut import ball_offset, box_height, height_over, region_kept, row4, third
from .grid import INFINITE
from .jit import device
from .vec import dot, scale

f32, i32 = np.float32, np.int32
ZERO, ONE = f32(0.0), f32(1.0)
NO_FACE = (ZERO, ZERO, ZERO)


@device
def lower_face(best, normal, height, depth, outward, wo):
    """The nearer of two cut faces that p lies at most `depth` behind and that wo looks at."""
    if height <= min(best, depth) and dot(outward, wo) > ZERO:
        return height, outward
    return best, normal


@device
def clip_face(clip, p, wo, best, normal):
    """Nearest face of clip planes and balls."""
    if clip is None:
        return best, normal
    for i in range(len(clip.planes)):
        n = clip.normals
        outward = (-n[i, 0], -n[i, 1], -n[i, 2])
        height = height_over(row4(clip.planes, i), p)
        best, normal = lower_face(best, normal, height, clip.depth, outward, wo)
    for i in range(len(clip.spheres)):
        q = ball_offset(clip.world_from_index, row4(clip.spheres, i), p)
        length = math.sqrt(dot(q, q))
        if length > ZERO:
            height = clip.spheres[i, 3] - length
            outward = scale(q, ONE / length)
            best, normal = lower_face(best, normal, height, clip.depth, outward, wo)
    return best, normal


@device
def hole_face(holes, p, wo, best, normal):
    """Nearest face of holes; outward of the matter is into the hole."""
    if holes is None:
        return best, normal
    for i in range(len(holes.planes) // 6):
        face, height = box_height(holes.planes, i, p)
        n = holes.normals
        outward = (n[face, 0], n[face, 1], n[face, 2])
        best, normal = lower_face(best, normal, -height, holes.depth, outward, wo)
    for i in range(len(holes.spheres)):
        q = ball_offset(holes.world_from_index, row4(holes.spheres, i), p)
        length = math.sqrt(dot(q, q))
        if length > ZERO:
            height = length - holes.spheres[i, 3]
            outward = scale(q, -ONE / length)
            best, normal = lower_face(best, normal, height, holes.depth, outward, wo)
    return best, normal


@device
def beyond(regions, axis, step, x, y, z):
    """Whether the region next to (x, y, z) along an axis exists and is cut off."""
    x += step if axis == 0 else i32(0)
    y += step if axis == 1 else i32(0)
    z += step if axis == 2 else i32(0)
    if min(x, min(y, z)) < 0 or max(x, max(y, z)) > 2:
        return False
    return not region_kept(regions, x, y, z)


@device
def region_face(regions, p, wo, best, normal):
    """Nearest face between a kept and a cut cropping region."""
    if regions is None:
        return best, normal
    lo, hi = regions.lower, regions.upper
    x, y, z = third(p[0], lo[0], hi[0]), third(p[1], lo[1], hi[1]), third(p[2], lo[2], hi[2])
    for axis in range(3):
        up = regions.normals[axis]
        for border in (lo[axis], hi[axis]):
            above = p[axis] > border
            step = i32(-1) if above else i32(1)
            height = abs(p[axis] - border) * regions.pitch[axis]
            outward = scale(up, f32(step))
            if height <= regions.depth and beyond(regions, axis, step, x, y, z):
                best, normal = lower_face(best, normal, height, regions.depth, outward, wo)
    return best, normal


@device
def cut_face(clip, holes, regions, p, wo):
    """Cut face just before index position p, seen from wo. Returns (True or False, normal).

    Just before: p is at most `depth`, half the smallest voxel spacing, behind it.
    """
    if clip is None:
        if holes is None:
            if regions is None:
                return False, NO_FACE
    best, normal = INFINITE, NO_FACE
    best, normal = clip_face(clip, p, wo, best, normal)
    best, normal = hole_face(holes, p, wo, best, normal)
    best, normal = region_face(regions, p, wo, best, normal)
    return best < INFINITE, normal
