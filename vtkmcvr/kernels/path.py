"""Radiance along a camera ray: single or multiple scattering, hybrid surface/volume.

Single scattering is that of Exposure Render (2012); multiple scattering is path tracing with
next-event estimation at every vertex (pbrt, "Volumetric path tracing").
"""

import numpy as np

from .brdf import NO_NORMAL, first_normal
from .direct import light_by_light, light_by_scatter, light_met
from .environment import ambient_radiance, environment_radiance
from .event import nearest_approach, next_event
from .jit import device, glue
from .lights import area_light_radiance, light_seen
from .rng import uniform
from .scatter import sample_scatter, scatter_weight_and_pdf
from .vec import BLACK, add, largest, mul, narrow, scale, transform, wide

f32 = np.float32
ZERO, ONE = f32(0.0), f32(1.0)
WHITE = (ONE, ONE, ONE)


@device
def roulette(throughput, least, rng):
    """Russian roulette on a throughput below `least`. Returns (throughput, 0 where ended; rng)."""
    most = largest(throughput)
    if most >= least:
        return throughput, rng
    rng, u = uniform(rng)
    if u * least >= most:
        return BLACK, rng
    return scale(throughput, least / most), rng


@glue
def scatter_on(scattering, scene, v, throughput, rng):
    """Direction in which a path goes on from v. Returns (wi, throughput, density of wi, rng).

    The throughput is 0 where Russian roulette ends the path.
    """
    wi, rng = sample_scatter(v, rng)
    weight, pdf = scatter_weight_and_pdf(scene.choice, v, wi)
    throughput, rng = roulette(mul(throughput, weight), scattering.roulette, rng)
    return wi, throughput, pdf, rng


@device
def scattered_light(scattering, scene, v, rng):
    """Light that one event at v, or up to `scattering.most`, send back. Returns (L, rng).

    With many, a ray drawn by the scattering function serves twice: it meets a light, weighted by
    MIS, or collides and goes on.
    """
    if scattering is None:
        by_light, rng = light_by_light(scene.choice, scene, v, rng)
        by_scatter, rng = light_by_scatter(
            scene.ambient, scene.environment, scene.area_lights, scene, v, rng
        )
        return add(v.emitted, add(by_light, by_scatter)), rng
    L, throughput = BLACK, WHITE
    for _ in range(scattering.most):
        # Emission, and direct light by a light
        direct, rng = light_by_light(scene.choice, scene, v, rng)
        L = add(L, mul(throughput, add(v.emitted, direct)))
        # Next direction
        wi, throughput, pdf, rng = scatter_on(scattering, scene, v, throughput, rng)
        if largest(throughput) <= ZERO:
            break
        # A light, or the next collision or receiver
        met, distance = light_met(scene, scene.choice, v, wi, pdf)
        d = transform(scene.medium.index_from_world, wi)
        t, v, rng = next_event(scene, wide(v.x), wi, wide(v.p), wide(d), 0.0, distance, rng)
        if t < 0.0:
            L = add(L, mul(throughput, met))
            break
    return L, rng


@glue
def background(scene, origin, d, index, distance):
    """What a camera ray sees behind the volume: a visible area light, environment, or nothing."""
    if index >= 0:
        return area_light_radiance(scene.area_lights, index, narrow(origin), d, distance)
    if not scene.environment_visible:
        return BLACK
    return add(ambient_radiance(scene.ambient, d), environment_radiance(scene.environment, d))


@device
def in_index(camera, origin, d):
    """Ray in index coordinates, float64."""
    o_index = add(camera.index_of_centre, transform(camera.index_from_world, origin))
    return o_index, transform(camera.index_from_world, wide(d))


@glue
def missed(scene, origin, d, end, index, distance):
    """What a camera ray brings that meets no medium and no receiver, as `radiance` returns it."""
    L = BLACK
    if not end < distance:
        L = background(scene, origin, d, index, distance)
    return L, False, 0.0, BLACK, NO_NORMAL


@glue
def radiance(scene, origin, d, end, rng):
    """One camera path. Returns (L, whether it met something, at which distance, albedo, normal).

    At distance `end` it meets what is not of this scene, and ends.

    `origin` is float64; the ray is computed in float64 until it enters the volume, so that a camera
    far away or a volume far from the world's origin costs no precision (HC-08).
    """
    o_index, d_index = in_index(scene.camera, origin, d)
    index, distance = light_seen(scene.all_lights, scene.area_lights, narrow(origin), d)
    shift = nearest_approach(scene.receivers, origin, d)
    t, v, rng = next_event(scene, origin, d, o_index, d_index, shift, min(distance, end), rng)
    if t < 0.0:
        return missed(scene, origin, d, end, index, distance)
    L, rng = scattered_light(scene.scattering, scene, v, rng)
    normal = first_normal(scene.normal_map, scene.medium, v)
    return L, True, t, v.albedo, normal
