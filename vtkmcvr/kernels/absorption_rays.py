"""Where a camera ray meets volumes that emit and absorb, and where it meets nothing."""

import numpy as np
from numba import literal_unroll

from .event import place_in, ray_interval
from .grid import FAR, INFINITE
from .jit import device
from .tracking import first_cell
from .vec import at, largest

f32, f64, index = np.float32, np.float64, np.uintp
ZERO, ONE = f32(0.0), f32(1.0)
# Columns of a volume's row of the table of rays: start and direction in index coordinates, where
# it comes and goes, where its scalar is known, and its table position there
NEAR, GONE, KNOWN, ENTRY = 6, 7, 8, 9
RAY_COLUMNS = 10


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
