"""Emission and absorption along camera rays, without noise.

Max, "Optical models for direct volume rendering", TVCG 1(2), 1995. A ray is cut into equal steps
between the two ends of the medium; extinction and colour of a step are pre-integrated, its opacity
is 1 - exp(-optical depth). Cuts, labels and several volumes follow the rules of light transport.
"""

import math

import numpy as np
from numba import literal_unroll

from .absorption_light import colour_of, normal_at, own_light, shaded
from .absorption_rays import (
    ENTRY,
    GONE,
    KNOWN,
    NEAR,
    all_empty_until,
    place_rays,
    whole_interval,
)
from .backdrop import along_axis, close_openings, open_share
from .camera import filtered_position, ray_through
from .cone_transfer import entry_at, stretch_extinction
from .jit import device, kernel
from .vec import BLACK, add, at, scale

f32, i64 = np.float32, np.int64
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
NOTHING = (ZERO, BLACK, BLACK, BLACK)
# Optical depth below which a series is more precise
THIN = f32(0.05)
# Optical depth of a step from which on it is looked at in several parts: colours hide each other,
# and a surface has its normal where it is
DENSE, PARTS = f32(0.3), i64(6)


@device
def stretch_in(volume, ray, t0, t1, toward_eye):
    """One volume between two distances: (optical depth, and times it colour, albedo, normal)."""
    a, b = max(t0, ray[NEAR]), min(t1, ray[GONE])
    if not a < b:
        return NOTHING
    medium, transfer, integrals = volume.medium, volume.transfer, volume.integrals
    o, d = (ray[0], ray[1], ray[2]), (ray[3], ray[4], ray[5])
    x = ray[ENTRY]
    if ray[KNOWN] != a:
        x = entry_at(medium, integrals, at(o, d, a))
    y = entry_at(medium, integrals, at(o, d, b))
    ray[KNOWN], ray[ENTRY] = b, y
    p = at(o, d, HALF * (a + b))
    # Where an end is no data, the middle decides
    if min(x, y) < ZERO:
        middle = entry_at(medium, integrals, p)
        if middle < ZERO:
            return NOTHING
        x, y = middle if x < ZERO else x, middle if y < ZERO else y
    _, sigma_t = stretch_extinction(
        transfer.gradient_opacity, transfer.table_2d, medium.labels, medium, transfer, integrals,
        x, y, p,
    )  # fmt: skip
    depth = sigma_t * (b - a)
    if not depth > ZERO:
        return NOTHING
    albedo = colour_of(transfer.colour_grid, transfer.table_2d, volume, x, y, p)
    normal = normal_at(volume.world_from_index_gradient, medium, p, toward_eye)
    light = add(
        shaded(volume.phong, albedo, normal, toward_eye),
        own_light(transfer.emission, volume, x, y, p, albedo),
    )
    return depth, scale(light, depth), scale(albedo, depth), scale(normal, depth)


@device
def stretch(volumes, rays, t0, t1, toward_eye):
    """All volumes between two distances: optical depths add, all else by its share of them."""
    depth, light, albedo, normal = NOTHING
    number = 0
    for volume in literal_unroll(volumes):
        a, b, c, e = stretch_in(volume, rays[number], t0, t1, toward_eye)
        depth, light, albedo, normal = depth + a, add(light, b), add(albedo, c), add(normal, e)
        number += 1
    return depth, light, albedo, normal


@device
def mean_place(depth):
    """Where the eye sees a stretch on average, as a share of its length."""
    if depth < THIN:
        return HALF - depth * f32(1 / 12)
    return ONE / depth - ONE / math.expm1(depth)


@device
def steps_of(march, length, fastest):
    """Number of equal steps on a way of `length` world units."""
    return i64(math.ceil(length * (march.per_voxel * fastest + march.per_length)))


@device
def accumulate_vector(plane, row, column, weight, value):
    """Add to a pixel of a plane of vectors, where there is one."""
    if plane is None:
        return
    for c in range(3):
        plane[row, column, c] += weight * value[c]


@device
def add_ray(volumes, rays, openings, march, film, row, column, origin, d):
    """Composite one ray front to back onto its pixel, as far as `openings` leave it open.

    Returns (steps on its way, those that it looked at).
    """
    weight = ONE / f32(march.rays * march.rays)
    enter, leave, fastest = whole_interval(volumes, origin, d)
    if not enter < leave:
        close_openings(openings, row, column, ONE, weight)
        return i64(0), i64(0)
    per_length = along_axis(openings, d)
    place_rays(volumes, rays, origin, d, enter)
    count = max(steps_of(march, leave - enter, fastest), i64(1))
    length = f32(leave - enter)
    step = length / f32(count)
    toward_eye = scale(d, -ONE)
    T, opacity, distance = ONE, ZERO, ZERO
    light, albedo, normal = BLACK, BLACK, BLACK
    quiet = True
    k, looked = i64(0), i64(0)
    part, parts = i64(0), i64(1)
    while k < count and T > march.opaque:
        width = step / f32(parts)
        t = f32(k) * step + f32(part) * width
        # Leap to the step in which the next volume may begin
        if quiet and march.skip:
            clear = min(all_empty_until(volumes, rays, t + HALF * step), length)
            ahead = i64(clear / step)
            if ahead > k:
                k = ahead
                continue
        depth, a, b, c = stretch(volumes, rays, t, t + width, toward_eye)
        looked += 1
        if depth > DENSE and parts < PARTS:
            parts = PARTS
            continue
        quiet = not depth > ZERO and parts < PARTS
        if depth > ZERO:
            share = open_share(
                openings, row, column, T, depth, per_length * (f32(enter) + t), per_length * width,
                weight,
            )  # fmt: skip
            if not share > ZERO:
                break
            seen = -share * T * math.expm1(-depth)
            share = seen / depth
            light, albedo = add(light, scale(a, share)), add(albedo, scale(b, share))
            normal = add(normal, scale(c, share))
            opacity += seen
            distance += seen * (t + mean_place(depth) * width)
            T *= math.exp(-depth)
        part += 1
        if part == parts:
            k, part, parts = k + 1, i64(0), i64(1)
    close_openings(openings, row, column, T, weight)
    accumulate_vector(film.radiance, row, column, weight, light)
    accumulate_vector(film.albedo, row, column, weight, albedo)
    accumulate_vector(film.normal, row, column, weight, normal)
    film.alpha[row, column] += weight * min(opacity, ONE)
    film.depth[row, column] += weight * (distance + f32(enter) * opacity)
    return count, looked


@kernel
def absorb_rows(volumes, camera, openings, march, rays, film, row_0, row_1):
    """Picture of some rows; `rays` (volumes, RAY_COLUMNS) float32 is room to work in.

    The n x n rays of a pixel go through even parts of its filter: one ray, through its centre.
    Returns (steps on all ways, those looked at).
    """
    n = march.rays
    steps, looked = i64(0), i64(0)
    for row in range(row_0, row_1):
        for column in range(film.alpha.shape[1]):
            for j in range(n):
                for i in range(n):
                    x = filtered_position(camera.filter, column, (f32(i) + HALF) / f32(n))
                    y = filtered_position(camera.filter, row, (f32(j) + HALF) / f32(n))
                    origin, d, _ = ray_through(camera, None, column, x, y, None)
                    a, b = add_ray(volumes, rays, openings, march, film, row, column, origin, d)
                    steps += a
                    looked += b
    return steps, looked
