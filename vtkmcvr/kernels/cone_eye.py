"""View rays through a block of layers: where the eye sees anything, opacity and depth.

Layers may hold two optical depths: the medium as it is, which gives opacity and distance, and as
light meets it, which is limited to what slices resolve and weighs the light that the eye sees.
"""

import numpy as np

from .backdrop import open_share
from .cone_beams import opacity
from .cone_layers import secant
from .jit import device

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
def see(openings, perspective, layers, eye, film, image, before, thickness, opaque, limited, layer,
    row, first, last,
):  # fmt: skip
    """What view rays of a stretch see of a layer: the transmittance to it, or 0."""
    if openings is not None:
        see_before(
            openings, perspective, layers, eye, film, image, before, thickness, opaque, limited,
            layer, row, first, last,
        )  # fmt: skip
        return
    start, end = max(first, image[0]), min(last, image[2])
    for column in range(first, last):
        layers.seen[layer, row, index(column)] = ZERO
    for column in range(start, end):
        i = index(column)
        T = eye.light[row, i]
        on = layers.depth[layer, row, i] > ZERO and T > opaque
        layers.seen[layer, row, i] = T if on else ZERO


@device
def dim(openings, perspective, layers, eye, film, image, before, limited, layer, row, first, last):
    """Take view rays of a stretch through a layer that they see, and keep its opacity.

    In loops of few arrays each, which become vector code.
    """
    if openings is not None:
        # Done with seeing
        return
    start, end = max(first, image[0]), min(last, image[2])
    to_film = index(image[0])
    i = index(row - image[1])
    seen, depth, whole = layers.seen, layers.depth, layers.whole
    for column in range(start, end):
        k = index(column)
        oblique = secant(perspective, f32(column) + HALF, f32(row) + HALF)
        W = eye.whole[row, k] if limited else seen[layer, row, k]
        lost = W * opacity(whole[layer, row, k] * oblique) if seen[layer, row, k] > ZERO else ZERO
        film.alpha[i, k - to_film] += lost
        film.depth[i, k - to_film] += lost * before * oblique
        if limited:
            eye.whole[row, k] = W - lost
    for column in range(start, end):
        k = index(column)
        oblique = secant(perspective, f32(column) + HALF, f32(row) + HALF)
        lost = seen[layer, row, k] * opacity(depth[layer, row, k] * oblique)
        film.share[i, k - to_film] += lost
        eye.light[row, k] -= lost


@device
def see_before(
    openings, perspective, layers, eye, film, image, before, thickness, opaque, limited, layer, row,
    first, last,
):  # fmt: skip
    """The same before a backdrop, and dimmed at once."""
    i = row - image[1]
    for column in range(first, last):
        T = eye.light[row, column]
        a = layers.depth[layer, row, column]
        seen = ZERO
        if a > ZERO and T > opaque and image[0] <= column < image[2]:
            oblique = secant(perspective, f32(column) + HALF, f32(row) + HALF)
            lost = T * opacity(a * oblique)
            eye.light[row, column] = T - lost
            j = column - image[0]
            W = eye.whole[row, column] if limited else T
            left = open_share(
                openings, i, j, W, layers.whole[layer, row, column] * oblique,
                before - HALF * thickness, thickness, ONE,
            )  # fmt: skip
            seen = T * left
            film.share[i, j] += lost * left
            if limited:
                lost = W * opacity(layers.whole[layer, row, column] * oblique)
                eye.whole[row, column] = W - lost
            lost *= left
            film.alpha[i, j] += lost
            film.depth[i, j] += lost * before * oblique
        layers.seen[layer, row, column] = seen


@device
def look(
    perspective, layers, eye, openings, film, image, before, thickness, opaque, limited, layer, row,
    first, last,
):  # fmt: skip
    """View rays of a stretch through a layer. Returns the largest transmittance to it."""
    see(
        openings, perspective, layers, eye, film, image, before, thickness, opaque, limited, layer,
        row, first, last,
    )  # fmt: skip
    dim(
        openings, perspective, layers, eye, film, image, before, limited, layer, row, first, last
    )
    brightest = ZERO
    for column in range(first, last):
        brightest = max(brightest, layers.seen[layer, row, column])
    return brightest
