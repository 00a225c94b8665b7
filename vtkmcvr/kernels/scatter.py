"""A scattering point of a path: what scatters there, by surface or by volume."""

import math
from typing import NamedTuple

import numpy as np

from ..packed import Gloss, Phase
from .brdf import brdf_value_and_pdf, brdf_weight_and_pdf, sample_brdf, surface_event
from .jit import device, glue
from .phase import phase_value, sample_phase
from .receivers import receiver_colour, receiver_point
from .transfer import colour, emitted, number_channel, of_label, rgb_channel
from .vec import BLACK, add, narrow, scale, transform, wide

f32 = np.float32
ZERO, INFINITE = f32(0.0), f32(math.inf)
SPOILT = (-INFINITE, -INFINITE, -INFINITE)


class Vertex(NamedTuple):
    """Scattering point of a path."""

    x: tuple  # position relative to the volume's centre
    p: tuple  # index position in the first volume
    wo: tuple  # unit direction back along the path
    on_surface: bool  # scatters by the BRDF instead of the phase function
    normal: tuple  # of a surface, on the side of wo
    albedo: tuple  # of the volume, diffuse colour of a surface
    emitted: tuple  # radiance that the collision adds
    gloss: Gloss | None
    phase: Phase | None


@device
def gloss_at(gloss, transfer, specular, exponent, scalar):
    """Coat at a scalar."""
    if specular is None:
        if exponent is None:
            return gloss
    return Gloss(
        rgb_channel(specular, transfer, scalar, gloss.specular),
        number_channel(exponent, transfer, scalar, gloss.exponent),
        gloss.ggx,
    )


@device
def phase_at(phase, transfer, shape, scalar):
    """Phase function at a scalar."""
    if shape is None:
        return phase
    return Phase(phase.kind, number_channel(shape, transfer, scalar, phase.shape))


@glue
def medium_vertex(medium, transfer, surface, gloss, phase, x, p, place, wo, scalar, sigma_t, rng):
    """Vertex of a collision in a medium, at its index position `place`. Returns (vertex, rng)."""
    transfer = of_label(medium.labels, transfer, place)
    albedo = colour(transfer.colour_grid, transfer.table_2d, medium, transfer, place, scalar)
    on_surface, normal, rng = surface_event(surface, medium, place, sigma_t, wo, rng)
    gloss = gloss_at(gloss, transfer, transfer.specular, transfer.exponent, scalar)
    phase = phase_at(phase, transfer, transfer.phase, scalar)
    glow = emitted(transfer.emission, transfer, scalar, albedo)
    # An extinction of inf marks a violated majorant, which has to spoil the sample
    glow = SPOILT if sigma_t == INFINITE else glow
    return Vertex(x, p, wo, on_surface, normal, albedo, glow, gloss, phase), rng


@device
def blank_vertex(gloss, phase, x, p, wo):
    """Vertex that reflects nothing, of the same type as the others."""
    return Vertex(x, p, wo, False, BLACK, BLACK, BLACK, gloss, phase)


@device
def faced(v, on_surface, normal):
    """Vertex v, of a surface or not."""
    return Vertex(v.x, v.p, v.wo, on_surface, normal, v.albedo, v.emitted, v.gloss, v.phase)


@device
def of_material(v, gloss, phase):
    """Vertex v, of another material."""
    return Vertex(v.x, v.p, v.wo, v.on_surface, v.normal, v.albedo, v.emitted, gloss, phase)


@device
def receiver_gloss(gloss, receivers, index):
    """Coat of a receiver."""
    if gloss is None:
        return gloss
    s = receivers.specular
    return Gloss((s[index, 0], s[index, 1], s[index, 2]), receivers.exponent[index], False)


@device
def receiver_vertex(receivers, mesh, gloss, phase, camera, index, triangle, x, wo):
    """Vertex on a receiver, at its point x."""
    if receivers is None:
        return blank_vertex(gloss, phase, x, x, wo)
    x, normal = receiver_point(receivers, mesh, index, triangle, x, wo)
    p = narrow(add(camera.index_of_centre, transform(camera.index_from_world, wide(x))))
    albedo = receiver_colour(receivers, index)
    gloss = receiver_gloss(gloss, receivers, index)
    return Vertex(x, p, wo, True, normal, albedo, BLACK, gloss, phase)


@glue
def scatter_value_and_pdf(v, wi):
    """Scattering function times cosine (surface) or phase function times albedo (volume).

    And the density of `sample_scatter`.
    """
    if v.on_surface:
        return brdf_value_and_pdf(v.gloss, v.albedo, v.normal, v.wo, wi)
    pdf = phase_value(v.phase, v.wo, wi)
    return scale(v.albedo, pdf), pdf


@glue
def sample_scatter(v, rng):
    """Direction drawn by the scattering function. Returns (wi, rng)."""
    if v.on_surface:
        return sample_brdf(v.gloss, v.normal, v.wo, rng)
    return sample_phase(v.phase, v.wo, rng)


@device
def phase_pdf(choice, phase, wo, wi):
    """Density of `sample_phase`; 0, and not evaluated, where no light sampling asks for it."""
    if choice is None:
        return ZERO
    return phase_value(phase, wo, wi)


@glue
def scatter_weight_and_pdf(choice, v, wi):
    """Scattering function over density of a direction that `sample_scatter` drew, and the density.

    A phase function is sampled exactly: the albedo, without rounding.
    """
    if v.on_surface:
        return brdf_weight_and_pdf(v.gloss, v.albedo, v.normal, v.wo, wi)
    return v.albedo, phase_pdf(choice, v.phase, v.wo, wi)
