"""From light that reaches each layer to the picture."""

import math

import numpy as np

from .brdf import surface_opacity, surface_probability
from .cone_layers import pixel_ray, secant
from .cone_transfer import stretch_albedo
from .grid import gradient
from .jit import device, kernel
from .vec import add, at, dot, normalize, scale

f32 = np.float32
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
NO_NORMAL = (ZERO, ZERO, ZERO)


@device
def film_normal(shade, medium, p, toward_eye):
    """Unit normal on the viewer's side, and gradient magnitude; zero without `shade`."""
    if shade is None:
        return NO_NORMAL, ZERO
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
def add_normal(sums, i, j, normal, share):
    """Keep the normal where a film does."""
    if sums is None:
        return
    for c in range(3):
        sums[i, j, c] += share * normal[c]


@device
def sum_of(groups, channel, slot):
    """Sum over the groups of directions, always in the same order."""
    total = ZERO
    for g in range(groups.shape[0]):
        total += groups[g, channel, slot]
    return total


@kernel
def compose_rows(
    medium, transfer, integrals, block, perspective, shade, layers, runs, light, weight, film,
    image, row_0, row_1,
):  # fmt: skip
    """Add a block's light to the picture, front to back.

    `light` [group of directions, colour or 1, slot] is the light that a layer sends to the eye per
    optical depth, `weight` [group, 1, slot] the sum of the weights of the directions in it.
    """
    channels = light.shape[1]
    for row in range(row_0, row_1):
        y = f32(row) + HALF
        for layer in range(layers.depth.shape[0]):
            middle = block.thickness * (f32(layer) + HALF)
            for run in range(runs.count[layer, row]):
                first = runs.start[layer, row, run]
                for column in range(first, runs.end[layer, row, run]):
                    T = layers.seen[layer, row, column]
                    if not T > ZERO:
                        continue
                    x = f32(column) + HALF
                    oblique = secant(perspective, x, y)
                    a = layers.depth[layer, row, column] * oblique
                    b, c = layers.front[layer, row, column], layers.back[layer, row, column]
                    o, d = pixel_ray(block, x, y)
                    p = at(o, d, middle)
                    albedo = stretch_albedo(
                        transfer.colour_grid, transfer.table_2d, medium, transfer, integrals, b, c,
                        p,
                    )  # fmt: skip
                    toward_eye = way_to_eye(shade, perspective, x, y)
                    normal, magnitude = film_normal(shade, medium, p, toward_eye)
                    sigma_t = layers.depth[layer, row, column] / block.thickness
                    colour = shaded(shade, albedo, normal, magnitude, toward_eye, sigma_t)
                    slot = runs.slot[layer, row, run] + column - first
                    scattered = T * a / sum_of(weight, 0, slot)
                    i, j = row - image[1], column - image[0]
                    for c in range(3):
                        V = sum_of(light, min(c, channels - 1), slot)
                        film.radiance[i, j, c] += scattered * colour[c] * V
                    share = -math.expm1(-a) * T
                    film.alpha[i, j] += share
                    film.depth[i, j] += share * (block.before + middle) * oblique
                    add_normal(film.normal, i, j, normal, share)
