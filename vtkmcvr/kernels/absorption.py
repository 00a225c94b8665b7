"""Emission and absorption along camera rays, without noise.

Max, "Optical models for direct volume rendering", TVCG 1(2), 1995. A ray is cut into equal steps
between the two ends of the medium; extinction and colour of a step are pre-integrated, its opacity
is 1 - exp(-optical depth). Cuts, labels and several volumes follow the rules of light transport.
"""

import math

import numpy as np
from numba import literal_unroll

from .backdrop import along_axis, close_openings, open_share
from .camera import filtered_position, ray_through
from .cone_transfer import NARROW, entry_at, first_entry, integral_at, stretch_extinction
from .event import place_in, ray_interval
from .grid import FAR, INFINITE, gradient, trilinear
from .jit import device, kernel
from .tracking import first_cell
from .transfer import colour, of_label
from .vec import BLACK, add, at, dot, largest, scale

f32, f64, i32, i64, index = np.float32, np.float64, np.int32, np.int64, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
NOTHING = (ZERO, BLACK, BLACK, BLACK)
# Columns of a volume's row of the table of rays: start and direction in index coordinates, where
# it comes and goes, where its scalar is known, and its table position there
NEAR, GONE, KNOWN, ENTRY = 6, 7, 8, 9
RAY_COLUMNS = 10
# Optical depth below which a series is more precise
THIN = f32(0.05)
# Optical depth of a step from which on it is looked at in several parts: colours hide each other,
# and a surface has its normal where it is
DENSE, PARTS = f32(0.3), i64(6)
# Share of all that a table integrates to below which a difference of two integrals is noise
LEAST_SHARE = 1e-9


@device
def interval_in(volume, origin, d):
    """Interval of a ray in a volume, and its fastest motion along an index axis."""
    o, step = place_in(volume, origin, d)
    enter, leave = ray_interval(volume.medium, o, step)
    return max(enter, 0.0), leave, largest((abs(step[0]), abs(step[1]), abs(step[2])))


@device
def whole_interval(volumes, origin, d):
    """Interval in which a ray meets any of the volumes, and its fastest motion in these."""
    enter, leave, fastest = FAR, -FAR, 0.0
    for volume in literal_unroll(volumes):
        a, b, speed = interval_in(volume, origin, d)
        if a < b:
            enter, leave, fastest = min(enter, a), max(leave, b), max(fastest, speed)
    return enter, leave, fastest


@device
def place_ray(volume, ray, origin, d, enter):
    """Write the row of a volume: the ray in its index coordinates from distance `enter` on."""
    near, gone, _ = interval_in(volume, origin, d)
    o, step = place_in(volume, origin, d)
    p = at(o, step, enter)
    for c in range(3):
        ray[c] = f32(p[c])
        ray[c + 3] = f32(step[c])
    # Beyond any volume where it is missed
    ray[NEAR] = f32(min(near - enter, f64(INFINITE)))
    ray[GONE] = f32(max(gone - enter, -f64(INFINITE)))
    ray[KNOWN] = -ONE


@device
def place_rays(volumes, rays, origin, d, enter):
    """Write the rows of all volumes."""
    number = 0
    for volume in literal_unroll(volumes):
        place_ray(volume, rays[number], origin, d, enter)
        number += 1


@device
def end_of_cube(o, d, cell, around, size):
    """Distance at which a ray leaves a cell and those around it, along one axis."""
    if d > ZERO:
        return (f32(cell + 1) + around) * size / d - o / d
    if d < ZERO:
        return (f32(cell) - around) * size / d - o / d
    return INFINITE


@device
def empty_until(medium, ray, t):
    """Distance up to which a ray at t meets nothing of a medium for sure; t where it may."""
    if t < ray[NEAR]:
        return ray[NEAR]
    if t >= ray[GONE]:
        return INFINITE
    nz, ny, nx = medium.majorant.shape
    per_cell, size = medium.cells_per_index, medium.cell_size
    x = first_cell(ray[0] + ray[3] * t, per_cell, nx)
    y = first_cell(ray[1] + ray[4] * t, per_cell, ny)
    z = first_cell(ray[2] + ray[5] * t, per_cell, nz)
    bound = medium.majorant[index(z), index(y), index(x)]
    if bound > ZERO:
        return t
    a = end_of_cube(ray[0], ray[3], x, -bound, size)
    b = end_of_cube(ray[1], ray[4], y, -bound, size)
    c = end_of_cube(ray[2], ray[5], z, -bound, size)
    return max(t, min(a, min(b, c)))


@device
def all_empty_until(volumes, rays, t):
    """Distance up to which a ray at t meets none of the volumes for sure."""
    nearest = INFINITE
    number = 0
    for volume in literal_unroll(volumes):
        nearest = min(nearest, empty_until(volume.medium, rays[number], t))
        number += 1
    return nearest


@device
def normal_at(world_from_index_gradient, medium, p, toward_eye):
    """Unit normal toward the eye; 0 where there is no gradient."""
    if world_from_index_gradient is None:
        return BLACK
    g = gradient(medium.values, world_from_index_gradient, p)
    square = dot(g, g)
    if not square > ZERO:
        return BLACK
    side = -ONE if dot(g, toward_eye) < ZERO else ONE
    return scale(g, side / math.sqrt(square))


@device
def shaded(phong, colour, normal, toward_eye):
    """Colour under a lamp at the eye, both sides lit, cut off at 1: as VTK's GPU ray caster has it.

    The lamp's reflection meets the eye at twice the angle of the normal: r.v = 2 (n.v)^2 - 1.
    """
    if phong is None:
        return colour
    facing = min(dot(normal, toward_eye), ONE)
    matt = phong.ambient + phong.diffuse * facing
    # Without a gradient, ambient light only
    mirrored = f32(2.0) * facing * facing - ONE
    glint = phong.specular * mirrored**phong.power if mirrored > ZERO else ZERO
    return (
        min(colour[0] * matt + glint, ONE),
        min(colour[1] * matt + glint, ONE),
        min(colour[2] * matt + glint, ONE),
    )


@device
def entry_colour(table, first, last, x):
    """Colour at table position x of a row."""
    i = min(i32(x), i32(last) - i32(1))
    f = x - f32(i)
    a, b = index(first + i), index(first + i + i32(1))
    return (
        table[a, 0] + (table[b, 0] - table[a, 0]) * f,
        table[a, 1] + (table[b, 1] - table[a, 1]) * f,
        table[a, 2] + (table[b, 2] - table[a, 2]) * f,
    )


@device
def light_integral(integrals, first, last, x, c):
    """Integral of extinction times colour, linear between entries, up to position x of a row."""
    i = min(i32(x), i32(last) - i32(1))
    f = x - f32(i)
    j = index(first + i)
    k = index(first + i + i32(1))
    a = integrals.sigma_t[j] * integrals.colour[j, c]
    slope = integrals.sigma_t[k] * integrals.colour[k, c] - a
    return integrals.light[j, c] + f * (a + HALF * f * slope)


@device
def mean_colour(integrals, first, x, y):
    """Colour between table positions x and y of a row, weighted by extinction."""
    last = integrals.last
    if abs(y - x) >= NARROW:
        low, high = min(x, y), max(x, y)
        sigma_t, depth = integrals.sigma_t, integrals.depth
        total = integral_at(sigma_t, depth, first, last, high)
        total -= integral_at(sigma_t, depth, first, last, low)
        if total > LEAST_SHARE * depth[index(first + i32(last))]:
            scale_by = 1.0 / total
            return (
                f32((light_integral(integrals, first, last, high, 0)
                - light_integral(integrals, first, last, low, 0)) * scale_by),
                f32((light_integral(integrals, first, last, high, 1)
                - light_integral(integrals, first, last, low, 1)) * scale_by),
                f32((light_integral(integrals, first, last, high, 2)
                - light_integral(integrals, first, last, low, 2)) * scale_by),
            )  # fmt: skip
    return entry_colour(integrals.colour, first, last, HALF * (x + y))


@device
def colour_of(colour_grid, table_2d, volume, x, y, p):
    """Colour of a stretch with middle p: pre-integrated where it depends on the scalar alone."""
    medium, transfer = volume.medium, volume.transfer
    if colour_grid is None:
        if table_2d is None:
            return mean_colour(volume.integrals, first_entry(medium.labels, transfer, p), x, y)
    row = of_label(medium.labels, transfer, p)
    return colour(colour_grid, table_2d, medium, row, p, trilinear(medium.values, p))


@device
def own_light(emission, volume, x, y, p, albedo):
    """Radiance of the medium's own, of the middle between two table positions: (1 - albedo) L_e."""
    if emission is None:
        return BLACK
    first = first_entry(volume.medium.labels, volume.transfer, p)
    own = entry_colour(emission, first, volume.integrals.last, HALF * (x + y))
    return (
        (ONE - albedo[0]) * own[0],
        (ONE - albedo[1]) * own[1],
        (ONE - albedo[2]) * own[2],
    )


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
