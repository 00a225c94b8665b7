"""One buffer of light for all directions, filtered from layer to layer (fast and paper modes).

The buffer holds what is missing of the light, 1 - V, so that beyond the film all light is there.
"""

import math

import numpy as np

from .cone_beams import eye_secant, mean_transmitted, transmitted
from .cone_blur import blur_columns, blur_rows
from .jit import device, kernel

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE, TWO = f32(0.0), f32(0.5), f32(1.0), f32(2.0)


@device
def light_through(missing, oblique, depth, met):
    """What a layer sends to the eye of the light in a buffer, per optical depth.

    `depth` is the layer's for the eye, `met` for the cone's mean path; both are measured along the
    view axis, of which the pixel's own ray goes `oblique` times as far.
    """
    return (ONE - missing) * mean_transmitted(oblique * (depth + met))


@device
def missing_behind(missing, oblique, met):
    """What is missing of the light behind a layer; as `light_through`."""
    return ONE - (ONE - missing) * transmitted(oblique * met)


@device
def single_layer(
    perspective, kappa, missing, part, depth, tinted, filled, visible, layer, light
):
    """What the eye sees of the light in a layer, and the light behind it.

    Returns the part of the buffer in which anything is missing.
    """
    for run in range(visible.first[layer], visible.first[layer + 1]):
        row, start, end = visible.listed[run, 0], visible.listed[run, 1], visible.listed[run, 2]
        slot = visible.slot[run] - start
        for column in range(start, end):
            light[index(slot + column)] = light_through(
                missing[row, index(column)], eye_secant(perspective, row, column),
                depth[layer, row, index(column)], kappa * tinted[layer, row, index(column)],
            )  # fmt: skip
    for run in range(filled.first[layer], filled.first[layer + 1]):
        row, start, end = filled.listed[run, 0], filled.listed[run, 1], filled.listed[run, 2]
        for column in range(start, end):
            missing[row, index(column)] = missing_behind(
                missing[row, index(column)], eye_secant(perspective, row, column),
                kappa * tinted[layer, row, index(column)],
            )  # fmt: skip
        part = (
            min(part[0], row), max(part[1], row + 1), min(part[2], start), max(part[3], end)
        )  # fmt: skip
    return part


@kernel
def blurred_layers(
    perspective, kappa, missing, other, running, part, depth, tinted, filled, visible, widths, light
):
    """Take the light of one colour through a block of layers.

    `kappa` is the optical depth of the cone's mean path over that of its axis: it gives the exact
    value of a half-space (HC-83). `widths` are the windows of the blur behind each layer, pixels,
    along rows and then columns; 0: none. `part` (4,), first and end row and column between which
    anything is missing, is kept.
    """
    within = (part[0], part[1], part[2], part[3])
    for layer in range(depth.shape[0]):
        within = single_layer(
            perspective, kappa, missing, within, depth, tinted, filled, visible, layer, light
        )
        if widths[layer] > ZERO and within[0] < within[1]:
            within = blur_rows(missing, other, widths[layer], within)
            within = blur_columns(other, missing, running, widths[layer], within)
    part[0], part[1], part[2], part[3] = within


@device
def seen_light(missing, y, x):
    """V between pixels, bilinear; 1 beyond the film."""
    rows, columns = missing.shape
    j, i = i32(math.floor(y)), i32(math.floor(x))
    fy, fx = y - f32(j), x - f32(i)
    total = ZERO
    for b in range(2):
        for a in range(2):
            if 0 <= j + b < rows and 0 <= i + a < columns:
                weight = (fy if b else ONE - fy) * (fx if a else ONE - fx)
                total += weight * missing[j + b, i + a]
    return ONE - f32(total)


@device
def published_light(missing, depth):
    """What a layer sends to the eye as published, per optical depth: alpha = 1 - exp(-sigma_t d).

    d is the way through the layer along the pixel's own view ray, as in its alpha: not the layer's
    thickness, by which a picture's corners would send more light than they have alpha.
    """
    return (ONE - missing) * (-math.expm1(-depth) / depth if depth > f32(1e-6) else ONE)


@device
def published_shadow(missing, depth, points, secants, exact, row, column):
    """What is missing of the light behind a pixel of a layer of that optical depth.

    Algorithm 2 (`exact` distances) or 3, over a grid of samples: `points` (n, 2) are offsets in
    rows and columns, `secants` (n,) their distance over the layer's thickness.
    """
    n = len(secants)
    total = ZERO
    for k in range(n):
        V = seen_light(missing, f32(row) + points[k, 0], f32(column) + points[k, 1])
        total += V * math.exp(-depth * secants[k]) if exact else V
    total /= f32(n)
    return ONE - (total if exact else total * math.exp(-depth))


@kernel
def published_read(perspective, missing, depth, visible, layer, light):
    """Eye pass as published: the light at the fragment's own place; see `published_light`."""
    for run in range(visible.first[layer], visible.first[layer + 1]):
        row, start, end = visible.listed[run, 0], visible.listed[run, 1], visible.listed[run, 2]
        slot = visible.slot[run] - start
        for column in range(start, end):
            light[slot + column] = published_light(
                missing[row, column],
                depth[layer, row, column] * eye_secant(perspective, row, column),
            )


@kernel
def published_update(missing, target, depth, layer, points, secants, exact, row_0, row_1):
    """Occlusion pass as published, for some rows; see `published_shadow`."""
    for row in range(row_0, row_1):
        for column in range(missing.shape[1]):
            target[row, column] = published_shadow(
                missing, depth[layer, row, column], points, secants, exact, row, column
            )
