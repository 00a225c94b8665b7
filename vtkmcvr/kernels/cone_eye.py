"""View rays through a block of layers: where the eye sees anything, opacity and depth.

Layers may hold two optical depths: the medium as it is, which gives opacity and distance, and as
light meets it, which is limited to what slices resolve and weighs the light that the eye sees.
"""

import math

import numpy as np

from .backdrop import close_openings, open_share
from .cone_layers import SEGMENT, secant
from .cone_runs import find_runs
from .jit import device, kernel

f32, index = np.float32, np.uintp
ZERO, HALF, ONE, FOUR = f32(0.0), f32(0.5), f32(1.0), f32(4.0)
# Share of the neighbours. Rounding to whole pixels displaces a ray of light by a variance of 1/6
# pixel squared, half of which would be the share; but in its own column it has no such error yet:
# half of that is what pictures of opaque volumes by Monte Carlo ask for
SPREAD = f32(1.0 / 24.0)
# Most that a relief takes off
MOST_RELIEF = f32(0.4)
FAINT = f32(0.03)


@device
def raise_relief(relief, eye_relief, depth, layer, row, first, last):
    """What light's steps from pixel to pixel add, in the middle of a layer.

    Rays of light go by whole pixels. On the mean that is a medium smoothed over a pixel, so that an
    oblique surface begins a little too soon for them, and shades itself. This sums the difference
    of the smoothed medium's optical depth to that which the view ray has met since it was last in
    the clear; light is relieved of it.
    """
    if relief is None:
        return
    last_column = depth.shape[2] - 1
    start, end = max(first, 1), min(last, last_column)
    if first < min(start, last):
        raise_pixels(relief, eye_relief, depth, layer, row, 0, 1, 0, 1)
    raise_pixels(relief, eye_relief, depth, layer, row, start, end, -1, 1)
    if last > max(end, first):
        raise_pixels(relief, eye_relief, depth, layer, row, last_column, last, -1, 0)


@device
def raise_pixels(relief, eye_relief, depth, layer, row, first, last, to_left, to_right):
    """The same for columns whose neighbours are these numbers away: code for vectors."""
    up, here, down = index(max(row - 1, 0)), index(row), index(min(row + 1, depth.shape[1] - 1))
    for column in range(first, last):
        i = index(column)
        around = (
            depth[layer, up, i] + depth[layer, down, i]
            + depth[layer, here, index(column + to_left)]
            + depth[layer, here, index(column + to_right)]
        )  # fmt: skip
        own = depth[layer, here, i]
        step = SPREAD * (around - FOUR * own)
        before = eye_relief[here, i]
        relief[layer, here, i] = min(max(before + HALF * step, ZERO), MOST_RELIEF)
        eye_relief[here, i] = before + step if around + own > ZERO else ZERO


@device
def reach_of_rows(reach, filled, layer, row, columns):
    """Columns around all that a row and its neighbours hold, or a relief held before."""
    first, last = columns, 0
    for r in range(max(row - 1, 0), min(row + 2, filled.count.shape[1])):
        n = filled.count[layer, r]
        if n > 0:
            first = min(first, filled.start[layer, r, 0] - 1)
            last = max(last, filled.end[layer, r, n - 1] + 1)
    first, last = max(first, 0), min(last, columns)
    before, after = reach[row, 0], reach[row, 1]
    reach[row, 0], reach[row, 1] = first, last
    return min(first, before), max(last, after)


@device
def look(
    perspective, layers, eye, openings, film, image, before, thickness, opaque, limited, layer, row,
    first, last,
):  # fmt: skip
    """View rays of a stretch through a layer. Returns the largest transmittance to it."""
    brightest = ZERO
    i = row - image[1]
    for column in range(first, last):
        T = eye.light[row, column]
        a = layers.depth[layer, row, column]
        seen = ZERO
        if a > ZERO and T > opaque and image[0] <= column < image[2]:
            oblique = secant(perspective, f32(column) + HALF, f32(row) + HALF)
            lost = T * math.expm1(-a * oblique)
            eye.light[row, column] = T + lost
            j = column - image[0]
            W = eye.whole[row, column] if limited else T
            left = open_share(
                openings, i, j, W, layers.whole[layer, row, column] * oblique,
                before - HALF * thickness, thickness, ONE,
            )  # fmt: skip
            seen = T * left
            film.share[i, j] -= lost * left
            if limited:
                lost = W * math.expm1(-layers.whole[layer, row, column] * oblique)
                eye.whole[row, column] = W + lost
            lost *= left
            film.alpha[i, j] -= lost
            film.depth[i, j] -= lost * before * oblique
        layers.seen[layer, row, column] = seen
        brightest = max(brightest, seen)
    return brightest


@device
def all_dark(light, image, opaque, row_0, row_1):
    """Whether no view ray of some rows sees any more."""
    for row in range(max(row_0, image[1]), min(row_1, image[3])):
        for column in range(max(image[0], 0), min(image[2], light.shape[1])):
            if light[row, column] > opaque:
                return False
    return True


@kernel
def look_rows(
    perspective, block, layers, filled, visible, eye, openings, film, image, opaque, limited, tiers,
    row_0, row_1,
):  # fmt: skip
    """View rays of some rows through all layers.

    `image` is (first column, first row, end column, end row) of what the eye sees; the layers may
    reach beyond it. Rays whose transmittance is below `opaque` see no more. `tiers`: whether
    stretches that count less than `FAINT` are marked as such. Returns whether no ray goes on.
    """
    columns = layers.depth.shape[2]
    for layer in range(layers.depth.shape[0]):
        before = block.before + block.thickness * (f32(layer) + HALF)
        for row in range(row_0, row_1):
            for segment in range(visible.flags.shape[2]):
                visible.flags[layer, row, segment] = 0
            if not image[1] <= row < image[3]:
                continue
            first, last = reach_of_rows(eye.reach, filled, layer, row, columns)
            raise_relief(layers.relief, eye.relief, layers.depth, layer, row, first, last)
            for segment in range(visible.flags.shape[2]):
                if filled.flags[layer, row, segment] == 0:
                    continue
                brightest = look(
                    perspective, layers, eye, openings, film, image, before, block.thickness,
                    opaque, limited, layer, row, segment * SEGMENT, (segment + 1) * SEGMENT,
                )  # fmt: skip
                if brightest > ZERO:
                    visible.flags[layer, row, segment] = 1 if tiers and brightest < FAINT else 2
    find_runs(visible, columns, row_0, row_1)
    return all_dark(eye.light, image, opaque, row_0, row_1)


@kernel
def close_rows(openings, T, row_0, row_1):
    """End the view rays of some rows, which have gone through all layers; T is what is left."""
    for row in range(row_0, row_1):
        for column in range(T.shape[1]):
            close_openings(openings, row, column, T[row, column], ONE)
