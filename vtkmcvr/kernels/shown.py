"""A pixel of a film as bytes for a screen: film filter, tone curve, encoding.

In float32 what `vtkmcvr.film.filter` and `vtkmcvr.pictures.display` do with arrays of whole
pictures, where the film is on a device; bytes differ by one level at most.
"""

import math

import numpy as np

from .jit import device

f32 = np.float32
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
MOST = f32(3.0e38)
WHITE = f32(255.0)
# IEC 61966-2-1
SLOPE, LINEAR_END = f32(12.92), f32(0.0031308)
STRETCH, OFFSET, POWER = f32(1.055), f32(0.055), f32(1.0 / 2.4)


@device
def coverage_at(cover, film, row, column):
    """Opacity of the volume; less what veils cover."""
    if cover is None:
        return f32(film.hits[row, column]) / f32(max(film.count[row, column], 1))
    return f32(cover[row, column])


@device
def film_at(film, row, column):
    """Light of a pixel and its coverage: (red, green, blue, coverage)."""
    return (
        f32(film.mean[row, column, 0]), f32(film.mean[row, column, 1]),
        f32(film.mean[row, column, 2]), coverage_at(film.cover, film, row, column),
    )  # fmt: skip


@device
def filtered_at(window, film, row, column):
    """Mean of light and coverage over a square window, cut at the border (HC-59).

    `window` (n,): weights of a row and of a column of it; None: the pixel alone.
    """
    if window is None:
        return film_at(film, row, column)
    rows, columns = film.count.shape
    reach = len(window) // 2
    red, green, blue, coverage, total = ZERO, ZERO, ZERO, ZERO, ZERO
    for y in range(max(row - reach, 0), min(row + reach + 1, rows)):
        for x in range(max(column - reach, 0), min(column + reach + 1, columns)):
            weight = window[y - row + reach] * window[x - column + reach]
            there = film_at(film, y, x)
            red += weight * there[0]
            green += weight * there[1]
            blue += weight * there[2]
            coverage += weight * there[3]
            total += weight
    return red / total, green / total, blue / total, coverage / total


@device
def straight(light, coverage):
    """Light over the coverage that it is weighed by; 0 where nothing is covered."""
    if coverage <= ZERO:
        return ZERO
    return min(max(light / coverage, ZERO), MOST)


@device
def display_light(screen, light):
    """Light under the tone curve, [0, 1]; see `tone_map` and `cut_off`."""
    if screen.film_like:
        return -math.expm1(-light * screen.scale)
    return min(light * screen.scale, ONE)


@device
def before_background(background, colour, coverage, c):
    """Display light of a colour, mixed with what is behind the picture."""
    if background is None:
        return colour
    return colour * coverage + (ONE - coverage) * background[c]


@device
def alpha_on(background, coverage):
    """Opacity of the picture; 1 on a background."""
    if background is None:
        return coverage
    return ONE


@device
def encoded(power, light):
    """Light as displays take it: sRGB, or a plain `power` where that is above zero."""
    if power > ZERO:
        return light**power
    if light <= LINEAR_END:
        return light * SLOPE
    return STRETCH * light**POWER - OFFSET


@device
def as_byte(value):
    """The byte nearest to a value in [0, 1]."""
    return np.uint8(math.floor(min(max(value, ZERO), ONE) * WHITE + HALF))


@device
def show_pixel(screen, film, pixels, row, column):
    """Write a pixel of the display picture, (H, W, 4) with straight alpha; see `to_rgba8`."""
    seen = filtered_at(screen.window, film, row, column)
    coverage = min(max(seen[3], ZERO), ONE)
    for c in range(3):
        colour = display_light(screen, straight(seen[c], coverage))
        colour = before_background(screen.background, colour, coverage, c)
        pixels[row, column, c] = as_byte(encoded(screen.power, colour))
    pixels[row, column, 3] = as_byte(alpha_on(screen.background, coverage))
