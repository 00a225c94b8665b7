"""Radiance along a camera ray: single or multiple scattering, hybrid surface/volume.

Single scattering is that of Exposure Render (2012); multiple scattering is path tracing with
next-event estimation at every vertex (pbrt, "Volumetric path tracing").
"""

import numpy as np

from .brdf import NO_NORMAL, first_normal
from .direct import light_by_light, light_by_scatter, light_met
from .environment import ambient_radiance, environment_radiance
from .grid import box_interval
from .jit import device, glue
from .lights import area_light_radiance, light_seen
from .rng import uniform
from .scatter import sample_scatter, scatter_weight, vertex_at
from .tracking import sample_collision
from .vec import BLACK, add, at, largest, mul, narrow, scale, transform, wide

f32, f64 = np.float32, np.float64
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
    medium = scene.medium
    L, throughput = BLACK, WHITE
    for _ in range(scattering.most):
        # Emission, and direct light by a light
        direct, rng = light_by_light(scene.choice, scene, v, rng)
        L = add(L, mul(throughput, add(v.emitted, direct)))
        # Next direction
        wi, rng = sample_scatter(v, rng)
        throughput, rng = roulette(mul(throughput, scatter_weight(v, wi)), scattering.roulette, rng)
        if largest(throughput) <= ZERO:
            break
        # A light, or the next collision
        met, distance = light_met(scene, scene.choice, v, wi)
        d = transform(medium.index_from_world, wi)
        _, leave = box_interval(wide(v.p), wide(d), medium.active_lo, medium.active_hi)
        length = min(f32(leave), distance)
        t, scalar, sigma_t, rng = sample_collision(
            scene.marching, medium, scene.transfer, v.p, d, length, rng
        )
        if t < ZERO:
            L = add(L, mul(throughput, met))
            break
        v, rng = vertex_at(
            scene, at(v.x, wi, t), at(v.p, d, t), scale(wi, -ONE), scalar, sigma_t, rng
        )
    return L, rng


@glue
def background(scene, origin, d, index, distance):
    """What a camera ray sees behind the volume: a visible area light, environment, or nothing."""
    if index >= 0:
        return area_light_radiance(scene.area_lights, index, narrow(origin), d, distance)
    if not scene.environment_visible:
        return BLACK
    return add(ambient_radiance(scene.ambient, d), environment_radiance(scene.environment, d))


@glue
def radiance(scene, origin, d, rng):
    """One camera path. Returns (L, 1 or 0 for a collision in the volume, distance, albedo, normal).

    `origin` is float64; the ray is computed in float64 until it enters the volume, so that a camera
    far away or a volume far from the world's origin costs no precision (HC-08).
    """
    camera, medium = scene.camera, scene.medium
    o_index = add(camera.index_of_centre, transform(camera.index_from_world, origin))
    d_wide = wide(d)
    d_index = transform(camera.index_from_world, d_wide)
    enter, leave = box_interval(o_index, d_index, medium.active_lo, medium.active_hi)
    enter = max(enter, 0.0)
    index, distance = light_seen(scene.light_tree, scene.area_lights, narrow(origin), d)
    length = f32(min(leave, f64(distance)) - enter)
    if not length > ZERO:
        return background(scene, origin, d, index, distance), False, 0.0, BLACK, NO_NORMAL
    entry = narrow(at(o_index, d_index, enter))
    d_index = narrow(d_index)
    t, scalar, sigma_t, rng = sample_collision(
        scene.marching, medium, scene.transfer, entry, d_index, length, rng
    )
    if t < ZERO:
        return background(scene, origin, d, index, distance), False, 0.0, BLACK, NO_NORMAL
    x = narrow(at(origin, d_wide, enter + f64(t)))
    v, rng = vertex_at(scene, x, at(entry, d_index, t), scale(d, -ONE), scalar, sigma_t, rng)
    L, rng = scattered_light(scene.scattering, scene, v, rng)
    normal = first_normal(scene.normal_map, medium, v)
    return L, True, enter + f64(t), v.albedo, normal
