"""Transmittance between a scattering point and a light, through all volumes and receivers."""

import numpy as np
from numba import literal_unroll

from .event import place_in, ray_interval
from .jit import device, glue
from .receivers import nearest_receiver
from .tracking import transmittance
from .vec import at, narrow, transform, wide

f32, f64 = np.float32, np.float64
ZERO, ONE = f32(0.0), f32(1.0)


@device
def blocked(receivers, mesh, shadows, x, wi, distance):
    """Whether a receiver stands in the way of light, within the reach of shadows."""
    if receivers is None:
        return False
    if shadows is None:
        return False
    index, _, _ = nearest_receiver(receivers, mesh, x, wi, ZERO, min(distance, shadows.reach), True)
    return index >= 0


@device
def shaded_interval(shadows, medium, o, d, distance):
    """Part of the ray that attenuates light: where it starts, and its length."""
    if shadows is None:
        return 0.0, ZERO
    enter, leave = ray_interval(medium, o, d)
    enter = max(enter, 0.0)
    return enter, f32(min(leave, f64(min(distance, shadows.reach))) - enter)


@glue
def through(shadows, marching, medium, transfer, ratio, o, d, distance, rng):
    """Transmittance of a medium along the ray (o, d), in index coordinates, over `distance`.

    Returns (T, rng).
    """
    enter, length = shaded_interval(shadows, medium, o, d, distance)
    T = ONE
    if length > ZERO:
        T, rng = transmittance(
            shadows, marching, medium, transfer, ratio, narrow(at(o, d, enter)), narrow(d),
            length, rng,
        )  # fmt: skip
    return T, rng


@device
def through_in(layer, shadows, marching, ratio, x, wi, distance, rng):
    """`through` another volume."""
    o, d = place_in(layer, wide(x), wi)
    return through(shadows, marching, layer.medium, layer.transfer, ratio, o, d, distance, rng)


@device
def through_more(more, shadows, marching, ratio, x, wi, distance, T, rng):
    """T times the transmittance of the other volumes. Returns (T, rng)."""
    if more is None:
        return T, rng
    if shadows is None:
        return T, rng
    for layer in literal_unroll(more):
        if T > ZERO:
            passed, rng = through_in(layer, shadows, marching, ratio, x, wi, distance, rng)
            T *= passed
    return T, rng


@glue
def visibility(scene, v, wi, distance, rng):
    """Transmittance of all that is between vertex v and a light. Returns (T, rng)."""
    if blocked(scene.receivers, scene.mesh, scene.shadows, v.x, wi, distance):
        return ZERO, rng
    T, rng = through(
        scene.shadows, scene.marching, scene.medium, scene.transfer, scene.ratio, wide(v.p),
        wide(transform(scene.medium.index_from_world, wi)), distance, rng,
    )  # fmt: skip
    return through_more(
        scene.more, scene.shadows, scene.marching, scene.ratio, v.x, wi, distance, T, rng
    )
