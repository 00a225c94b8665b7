"""Direct light at a scattering point, drawn by a light and by the scattering function, with MIS."""

from typing import NamedTuple

import numpy as np

from .environment import ambient_radiance, environment_pdf, environment_radiance
from .jit import device, glue
from .light_tree import light_chance
from .lights import area_light_radiance, blocked, light_pdf, nearest_light, sample_light
from .scatter import sample_scatter, scatter_value_and_pdf, scatter_weight_and_pdf
from .vec import BLACK, add, largest, mul, scale
from .visibility import visibility

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


class Drawn(NamedTuple):
    """Light that a vertex would send back if nothing were in the way."""

    f: tuple  # radiance, weighted by MIS; 0 where there is none
    wi: tuple  # toward the light
    distance: np.float32


NOTHING_DRAWN = Drawn(BLACK, BLACK, ZERO)


@device
def draw_by_light(choice, scene, v, rng):
    """Direction drawn by a light, and what comes from there. Returns (Drawn, rng)."""
    if choice is None:
        return NOTHING_DRAWN, rng
    if not choice.by_light:
        return NOTHING_DRAWN, rng
    light, rng = sample_light(
        choice, scene.all_lights, scene.area_lights, scene.delta_lights, scene.environment,
        v.x, v.on_surface, v.normal, rng,
    )  # fmt: skip
    if largest(light.radiance) <= ZERO:
        return NOTHING_DRAWN, rng
    value, pdf = scatter_value_and_pdf(v, light.wi)
    f = mul(value, light.radiance)
    if largest(f) <= ZERO:
        return NOTHING_DRAWN, rng
    if blocked(scene.all_lights, scene.area_lights, v.x, light):
        return NOTHING_DRAWN, rng
    # Delta lights have no density: nothing else draws their directions
    if choice.by_scatter and light.pdf > ZERO:
        f = scale(f, power_heuristic(light.pdf, pdf))
    return Drawn(f, light.wi, light.distance), rng


@device
def light_by_light(choice, scene, v, rng):
    """Direct light at vertex v, direction drawn by a light. Returns (L, rng)."""
    if choice is None:
        return BLACK, rng
    drawn, rng = draw_by_light(choice, scene, v, rng)
    if largest(drawn.f) <= ZERO:
        return BLACK, rng
    T, rng = visibility(scene, v, drawn.wi, drawn.distance, rng)
    return scale(drawn.f, T), rng


@glue
def light_met(scene, choice, v, wi, pdf):
    """Weighted radiance that a ray along wi, drawn at v with density pdf, meets; the distance."""
    all_lights, lights = scene.all_lights, scene.area_lights
    index, distance = nearest_light(all_lights, lights, v.x, wi, False)
    if index >= 0:
        L = area_light_radiance(lights, index, v.x, wi, distance)
        other = light_pdf(all_lights, lights, index, v.x, v.on_surface, v.normal, wi, distance)
        return weighted(choice, L, pdf, other), distance
    L = map_met(scene.environment, choice, all_lights, v, wi, pdf)
    return add(ambient_radiance(scene.ambient, wi), L), distance


@device
def map_met(environment, choice, all_lights, v, wi, pdf):
    """Weighted radiance of the environment map along wi, drawn at v with density pdf."""
    if environment is None:
        return BLACK
    L = environment_radiance(environment, wi)
    return weighted(choice, L, pdf, map_pdf(choice, all_lights, environment, v, wi))


@device
def map_pdf(choice, all_lights, environment, v, wi):
    """Density with which light sampling draws wi from the environment map, selection included."""
    if choice is None:
        return ZERO
    chance = light_chance(all_lights, choice.environment, v.x, v.on_surface, v.normal)
    return chance * environment_pdf(environment, wi)


@device
def weighted(choice, L, pdf, other):
    """L with its MIS weight, drawn with density pdf where lights draw with density `other`.

    1 without light sampling, 0 without scatter sampling.
    """
    if choice is None:
        return L
    if not choice.by_scatter:
        return BLACK
    if not choice.by_light:
        return L
    return scale(L, power_heuristic(pdf, other))


@device
def needs_scatter(ambient, choice):
    """Whether rays drawn by the scattering function can bring light, if any light can be met."""
    if ambient is not None:
        return True
    if choice is None:
        return False
    return choice.by_scatter


@device
def draw_by_scatter(ambient, environment, area_lights, scene, v, rng):
    """Direction drawn by the scattering function, and what comes from there. Returns (Drawn, rng).

    Where every light is a delta light no such ray exists (no draw, no lookup).
    """
    if ambient is None:
        if environment is None:
            if area_lights is None:
                return NOTHING_DRAWN, rng
    if not needs_scatter(ambient, scene.choice):
        return NOTHING_DRAWN, rng
    wi, rng = sample_scatter(v, rng)
    f, pdf = scatter_weight_and_pdf(scene.choice, v, wi)
    if largest(f) <= ZERO:
        return NOTHING_DRAWN, rng
    L, distance = light_met(scene, scene.choice, v, wi, pdf)
    return Drawn(mul(f, L), wi, distance), rng


@device
def light_by_scatter(ambient, environment, area_lights, scene, v, rng):
    """Direct light at vertex v, direction drawn by the scattering function. Returns (L, rng)."""
    if ambient is None:
        if environment is None:
            if area_lights is None:
                return BLACK, rng
    drawn, rng = draw_by_scatter(ambient, environment, area_lights, scene, v, rng)
    if largest(drawn.f) <= ZERO:
        return BLACK, rng
    T, rng = visibility(scene, v, drawn.wi, drawn.distance, rng)
    return scale(drawn.f, T), rng
