"""Radiance along a camera ray: single scattering, hybrid surface/volume (Exposure Render, 2012)."""

import numpy as np

from .brdf import brdf_pdf, brdf_value, sample_brdf, surface_event
from .environment import ambient_radiance, environment_pdf, environment_radiance
from .grid import box_interval
from .jit import device, glue
from .lights import (
    light_chance,
    nearest_rectangle,
    rectangle_pdf,
    rectangle_radiance,
    sample_light,
)
from .phase import phase_value, sample_phase
from .tracking import sample_collision, transmittance
from .transfer import colour
from .vec import BLACK, add, at, largest, mul, narrow, scale, transform

f32 = np.float32
ZERO, ONE = f32(0.0), f32(1.0)


@device
def power_heuristic(p, q):
    """MIS weight of a sample drawn with density p where q could have drawn it too (Veach 1997).

    Written so that nothing overflows: 1 / (1 + (q/p)^2); 0 for p = 0 (HC-33).
    """
    if p <= ZERO:
        return ZERO
    ratio = q / p
    return ONE / (ONE + ratio * ratio)


@glue
def scatter_value(scene, on_surface, normal, albedo, wo, wi):
    """Scattering function times cosine (surface) or phase function times albedo (volume)."""
    if on_surface:
        return brdf_value(scene.gloss, albedo, normal, wo, wi)
    return scale(albedo, phase_value(scene.phase, scene.cone, wo, wi))


@glue
def scatter_pdf(scene, on_surface, normal, wo, wi):
    """Density of `sample_scatter`."""
    if on_surface:
        return brdf_pdf(scene.gloss, normal, wo, wi)
    return phase_value(scene.phase, scene.cone, wo, wi)


@glue
def sample_scatter(scene, on_surface, normal, wo, rng):
    """Direction drawn by the scattering function."""
    if on_surface:
        return sample_brdf(scene.gloss, normal, wo, rng)
    return sample_phase(scene.phase, scene.cone, wo, rng)


@glue
def visibility(scene, p, wi, distance, rng):
    """Transmittance from index position p along wi over `distance`. Returns (T, rng)."""
    medium = scene.medium
    d = transform(medium.index_from_world, wi)
    _, leave = box_interval(p, d, medium.active_lo, medium.active_hi)
    return transmittance(
        medium, scene.transfer, scene.shadows, scene.ratio, p, d, min(leave, distance), rng
    )


@device
def light_by_light(choice, scene, x, p, on_surface, normal, albedo, wo, rng):
    """Direct light, direction drawn by a light. Returns (L, rng)."""
    if choice is None:
        return BLACK, rng
    if not choice.by_light:
        return BLACK, rng
    light, rng = sample_light(
        choice, scene.rectangles, scene.delta_lights, scene.environment, x, on_surface, normal, rng
    )
    if largest(light.radiance) <= ZERO:
        return BLACK, rng
    f = mul(scatter_value(scene, on_surface, normal, albedo, wo, light.wi), light.radiance)
    if largest(f) <= ZERO:
        return BLACK, rng
    blocker, blocked_at = nearest_rectangle(scene.rectangles, x, light.wi, False)
    if blocker != light.rectangle and blocked_at < light.distance:
        return BLACK, rng
    T, rng = visibility(scene, p, light.wi, light.distance, rng)
    if choice.by_scatter and light.pdf > ZERO:
        other = scatter_pdf(scene, on_surface, normal, wo, light.wi)
        T *= power_heuristic(light.pdf, other)
    return scale(f, T), rng


@glue
def light_met(scene, choice, x, on_surface, normal, wi, pdf):
    """Weighted radiance that a ray along wi, of density pdf, would meet; and the distance."""
    index, distance = nearest_rectangle(scene.rectangles, x, wi, False)
    if index >= 0:
        L = rectangle_radiance(scene.rectangles, index, wi)
        chance = light_chance(choice, index, x, on_surface, normal)
        other = rectangle_pdf(scene.rectangles, chance, index, wi, distance)
        return weighted(choice, L, pdf, other), distance
    L = environment_radiance(scene.environment, wi)
    other = map_pdf(choice, scene.environment, x, on_surface, normal, wi)
    return add(ambient_radiance(scene.ambient), weighted(choice, L, pdf, other)), distance


@device
def map_pdf(choice, environment, x, on_surface, normal, wi):
    """Density with which light sampling draws wi from the environment map, selection included."""
    if choice is None or environment is None:
        return ZERO
    chance = light_chance(choice, choice.environment, x, on_surface, normal)
    return chance * environment_pdf(environment, wi)


@device
def weighted(choice, L, pdf, other):
    """L with its MIS weight: 1 without light sampling, 0 without scatter sampling."""
    if choice is None:
        return L
    if not choice.by_scatter:
        return BLACK
    if not choice.by_light:
        return L
    return scale(L, power_heuristic(pdf, other))


@device
def light_by_scatter(
    ambient, environment, rectangles, scene, x, p, on_surface, normal, albedo, wo, rng
):
    """Direct light, direction drawn by the scattering function. Returns (L, rng).

    Where every light is a delta light no such ray exists (no draw, no lookup).
    """
    if ambient is None:
        if environment is None:
            if rectangles is None:
                return BLACK, rng
    wi, rng = sample_scatter(scene, on_surface, normal, wo, rng)
    pdf = scatter_pdf(scene, on_surface, normal, wo, wi)
    if not pdf > ZERO:
        return BLACK, rng
    L, distance = light_met(scene, scene.choice, x, on_surface, normal, wi, pdf)
    f = mul(scale(scatter_value(scene, on_surface, normal, albedo, wo, wi), ONE / pdf), L)
    if largest(f) <= ZERO:
        return BLACK, rng
    T, rng = visibility(scene, p, wi, distance, rng)
    return scale(f, T), rng


@glue
def background(scene, d, index):
    """What a camera ray sees behind the volume: a visible rectangle, environment, or nothing."""
    if index >= 0:
        return rectangle_radiance(scene.rectangles, index, d)
    if not scene.environment_visible:
        return BLACK
    return add(ambient_radiance(scene.ambient), environment_radiance(scene.environment, d))


@glue
def radiance(scene, origin, d, rng):
    """One camera path. Returns (L, 1 or 0 for a collision in the volume, its distance).

    `origin` is float64; the ray is computed in float64 until it enters the volume, so that a camera
    far away or a volume far from the world's origin costs no precision (HC-08).
    """
    camera, medium = scene.camera, scene.medium
    o_index = add(camera.index_of_centre, transform(camera.index_from_world, origin))
    d_index = transform(camera.index_from_world, d)
    enter, leave = box_interval(o_index, d_index, medium.active_lo, medium.active_hi)
    enter = max(enter, 0.0)
    index, distance = nearest_rectangle(scene.rectangles, narrow(origin), d, True)
    length = f32(min(leave, distance) - enter)
    if not length > ZERO:
        return background(scene, d, index), False, 0.0
    entry = narrow(at(o_index, d_index, enter))
    d_index = narrow(d_index)
    t, scalar, rng = sample_collision(medium, scene.transfer, entry, d_index, length, rng)
    if t < ZERO:
        return background(scene, d, index), False, 0.0

    # Direct light at the collision
    p = at(entry, d_index, t)
    x = narrow(at(origin, d, enter + t))
    wo = scale(d, -ONE)
    albedo = colour(scene.transfer, scalar)
    on_surface, normal, rng = surface_event(
        scene.surface, medium, scene.transfer, p, scalar, wo, rng
    )
    by_light, rng = light_by_light(scene.choice, scene, x, p, on_surface, normal, albedo, wo, rng)
    by_scatter, rng = light_by_scatter(
        scene.ambient,
        scene.environment,
        scene.rectangles,
        scene,
        x,
        p,
        on_surface,
        normal,
        albedo,
        wo,
        rng,
    )
    return add(by_light, by_scatter), True, enter + t
