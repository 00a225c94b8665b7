"""From light that reaches each layer to the picture."""

import math

import numpy as np

from .brdf import surface_opacity, surface_probability
from .cone_layers import SEGMENT, pixel_ray, secant
from .cone_transfer import stretch_albedo
from .cut_faces import cut_face
from .grid import INFINITE, gradient
from .jit import device, kernel
from .vec import add, at, dot, normalize, scale

f32, index = np.float32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
NO_NORMAL = (ZERO, ZERO, ZERO)
STEP = f32(1.0 / SEGMENT)


@device
def film_normal(shade, medium, p, toward_eye):
    """Unit normal on the viewer's side, and gradient magnitude; zero without `shade`.

    A cut face has the cut's normal, and the largest gradient.
    """
    if shade is None:
        return NO_NORMAL, ZERO
    on_face, face = cut_face(medium.clip, medium.holes, medium.regions, p, toward_eye)
    if on_face:
        return face, INFINITE
    g = gradient(medium.values, shade.surface.world_from_index_gradient, p)
    magnitude = math.sqrt(dot(g, g))
    if not magnitude > ZERO:
        return NO_NORMAL, ZERO
    return scale(g, (-ONE if dot(g, toward_eye) < ZERO else ONE) / magnitude), magnitude


@device
def way_to_eye(shade, perspective, column, row):
    """World direction from a pixel's medium to the eye."""
    if shade is None:
        return NO_NORMAL
    if perspective is None:
        return scale(shade.forward, -ONE)
    x = (column - perspective.eye_column) * perspective.slope
    y = (row - perspective.eye_row) * perspective.slope
    return normalize(
        scale(add(add(shade.forward, scale(shade.right, x)), scale(shade.down, y)), -ONE)
    )


@device
def shaded(shade, albedo, normal, magnitude, toward_eye, sigma_t):
    """Colour of the light scattered to the eye, per unit of light from the cone.

    The share P_brdf of Exposure Render's Eq. 1 is a surface, lit along the cone's axis: Lambert
    and Blinn's highlight. The rest is medium.
    """
    if shade is None:
        return albedo
    if not magnitude > ZERO:
        return albedo
    alpha = surface_opacity(shade.surface, sigma_t)
    P = shade.strength * surface_probability(shade.surface, alpha, magnitude)
    toward_light = toward_eye if shade.headlight else shade.toward_light
    lambert = max(dot(normal, toward_light), ZERO)
    half = normalize(add(toward_eye, toward_light))
    highlight = max(dot(normal, half), ZERO) ** shade.exponent if lambert > ZERO else ZERO
    body = ONE - P + P * lambert
    return (
        albedo[0] * body + P * shade.specular[0] * highlight,
        albedo[1] * body + P * shade.specular[1] * highlight,
        albedo[2] * body + P * shade.specular[2] * highlight,
    )  # fmt: skip


@device
def add_vector(sums, i, j, vector, share):
    """Keep a normal or an albedo where a film does."""
    if sums is None:
        return
    for c in range(3):
        sums[i, j, c] += share * vector[c]


@device
def albedo_there(mixed, medium, transfer, integrals, layers, layer, row, column, p):
    """Albedo of a pixel in a layer; where there are several volumes, that of the mixture."""
    if mixed is None:
        return stretch_albedo(
            transfer.colour_grid, transfer.table_2d, medium.labels, medium, transfer, integrals,
            layers.front[layer, row, column], layers.back[layer, row, column], p,
        )  # fmt: skip
    # Not by the inverse, which is infinite for a faint medium
    depth = layers.depth[layer, row, column]
    return (
        mixed[0, layer, row, column] / depth,
        mixed[1, layer, row, column] / depth,
        mixed[2, layer, row, column] / depth,
    )


@device
def sum_groups(light, weight, start, end):
    """Sum the groups of directions into the first one, always in the same order."""
    for g in range(1, light.shape[0]):
        for channel in range(light.shape[1]):
            for slot in range(start, end):
                light[0, channel, index(slot)] += light[g, channel, index(slot)]
        for segment in range(start // SEGMENT, end // SEGMENT):
            weight[0, index(segment), 0] += weight[g, index(segment), 0]
            weight[0, index(segment), 1] += weight[g, index(segment), 1]


@device
def all_light_at_most(scattered, a, T):
    """Light from a layer of optical depth a, not more than with all the light there is.

    Relief may take too much off. Below T a (1 - a / 2), which is less, nothing is to be done.
    """
    if scattered <= T * a * (ONE - HALF * a):
        return scattered
    return min(scattered, -math.expm1(-a) * T)


@device
def add_film(normals, albedos, i, j, normal, albedo, a, T):
    """What a film keeps of the first collision."""
    if normals is None:
        if albedos is None:
            return
    share = -math.expm1(-a) * T
    add_vector(normals, i, j, normal, share)
    add_vector(albedos, i, j, albedo, share)


@device
def compose(
    medium, transfer, integrals, block, perspective, shade, layers, film, image, layer, row, column,
    V, total,
):  # fmt: skip
    """Add the light of one pixel of a layer to the picture, where the eye sees any of it.

    `V` is the light that the layer sends to the eye per optical depth, `total` the sum of the
    weights in it.
    """
    T = layers.seen[layer, row, column]
    if not T > ZERO:
        return
    x, y = f32(column) + HALF, f32(row) + HALF
    a = layers.depth[layer, row, column] * secant(perspective, x, y)
    o, d = pixel_ray(block, x, y)
    p = at(o, d, block.thickness * (f32(layer) + HALF))
    albedo = albedo_there(layers.mixed, medium, transfer, integrals, layers, layer, row, column, p)
    toward_eye = way_to_eye(shade, perspective, x, y)
    normal, magnitude = film_normal(shade, medium, p, toward_eye)
    sigma_t = layers.whole[layer, row, column] / block.thickness
    colour = shaded(shade, albedo, normal, magnitude, toward_eye, sigma_t)
    # Without any direction in the cone there, nothing is known of the light
    scattered = T * a / total if total > ZERO else ZERO
    i, j = row - image[1], column - image[0]
    for c in range(3):
        film.radiance[i, j, c] += colour[c] * all_light_at_most(scattered * V[c], a, T)
    add_film(film.normal, film.albedo, i, j, normal, albedo, a, T)


@kernel
def compose_rows(
    medium, transfer, integrals, block, perspective, shade, layers, runs, light, weight, film,
    image, row_0, row_1,
):  # fmt: skip
    """Add a block's light to the picture, front to back.

    `light` [group of directions, colour or 1, slot] is the light that a layer sends to the eye per
    optical depth, `weight` [group, segment, 2] the sum of the weights of the directions in it, at
    both ends of segments.
    """
    channels = light.shape[1]
    for layer in range(layers.depth.shape[0]):
        for run in range(runs.first[layer], runs.first[layer + 1]):
            row, first, last = runs.listed[run, 0], runs.listed[run, 1], runs.listed[run, 2]
            if row_0 <= row < row_1:
                start = runs.slot[run]
                sum_groups(light, weight, start, start + last - first)
                for column in range(first, last):
                    slot = start + column - first
                    k = slot // SEGMENT
                    w = f32(slot % SEGMENT) * STEP
                    total = weight[0, k, 0] + (weight[0, k, 1] - weight[0, k, 0]) * w
                    V = (
                        light[0, 0, slot], light[0, min(1, channels - 1), slot],
                        light[0, min(2, channels - 1), slot],
                    )  # fmt: skip
                    compose(
                        medium, transfer, integrals, block, perspective, shade, layers, film,
                        image, layer, row, column, V, total,
                    )  # fmt: skip
