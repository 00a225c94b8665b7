"""Light through a block of layers, pixel by pixel: for threads that work on all pixels at a time.

The CPU takes one beam after the other through all pixels (`cone_beams`), and sums what each leaves
at a pixel. Here a pixel asks all beams, so that sums need no order among threads, and nothing waits
from layer to layer: the optical depth that a ray has met before a block is kept, and what it meets
inside the block is summed again for each layer.
"""

import numpy as np

from ..packed import Beam, LayerBlock, Layers
from .cone_beams import direction_at, eye_secant, mean_transmitted, relieved, span_of, transmitted
from .cone_layers import SEGMENT
from .cone_single import light_through, missing_behind
from .jit import device

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Rows of a tile, which is a segment wide; layers of a block, a bit of a byte for each
TILE, DEPTH = 8, 8


@device
def part(arrays, which):
    """One of several arrays; None of none."""
    if arrays is None:
        return None
    return arrays[which]


@device
def layers_of(sheets, which):
    """Layers of one of the two blocks that are worked on."""
    return Layers(
        sheets.depth[which], sheets.whole[which], part(sheets.tinted, which),
        part(sheets.mixed, which), sheets.seen, sheets.front[which], sheets.back[which],
        sheets.relief,
    )  # fmt: skip


@device
def block_at(places, number):
    """Where a block's pixels lie in a volume, of a table of all blocks."""
    p = places[number]
    return LayerBlock(
        (p[0], p[1], p[2]), (p[3], p[4], p[5]), (p[6], p[7], p[8]), (p[9], p[10], p[11]),
        (p[12], p[13], p[14]), (p[15], p[16], p[17]), p[18], p[19],
    )  # fmt: skip


@device
def met_in(tinted, depth, channel, layer, row, column):
    """Optical depth of a pixel in a layer, for light of a colour where it has any."""
    if tinted is None:
        return depth[layer, row, column]
    return tinted[channel, layer, row, column]


@device
def kept(beams, beam, channel, block, row, column):
    """Optical depth that a ray has met before a block, by its pixel at the block's start.

    Rays are kept by number modulo the raster's size. One that was beyond the raster met nothing.
    """
    _, _, rows, columns = beams.buffers.shape
    if block == 0 or row < 0 or row >= rows or column < 0 or column >= columns:
        return ZERO
    j, i = row + beams.behind[beam, block, 2], column + beams.behind[beam, block, 3]
    if j >= rows:
        j -= rows
    if i >= columns:
        i -= columns
    return beams.buffers[beam, channel, j, i]


@device
def met_before(beams, layers, beam, channel, block, layer, row, column):
    """Optical depth that a ray has met before a layer of a block.

    The ray is that which goes through a pixel when the raster has not moved; rows and columns may
    lie beyond the raster.
    """
    _, rows, columns = layers.depth.shape
    total = kept(
        beams, beam, channel, block, row + beams.behind[beam, block, 0],
        column + beams.behind[beam, block, 1],
    )  # fmt: skip
    start = block * layers.depth.shape[0]
    for between in range(layer):
        a, b = beams.first[beam, start + between], beams.first[beam, start + between + 1]
        share = ONE / f32(b - a)
        for place in range(a, b):
            j, i = row + beams.places[place, 0], column + beams.places[place, 1]
            if 0 <= j < rows and 0 <= i < columns:
                total += share * met_in(layers.tinted, layers.depth, channel, between, j, i)
    return total


@device
def meets_nothing(beams, occupied, beam, block, row, column):
    """Whether all tiles that a ray goes through in a block are empty."""
    y0, x0 = row + beams.behind[beam, block, 0], column + beams.behind[beam, block, 1]
    y1, x1 = row + beams.behind[beam, block + 1, 0], column + beams.behind[beam, block + 1, 1]
    tile_rows, segments = occupied.shape
    first, last = max(min(y0, y1) // TILE, 0), min(max(y0, y1) // TILE, tile_rows - 1)
    left, right = max(min(x0, x1) // SEGMENT, 0), min(max(x0, x1) // SEGMENT, segments - 1)
    for tile in range(first, last + 1):
        for segment in range(left, right + 1):
            if occupied[tile, segment] > 0:
                return False
    return True


@device
def advance_ray(beams, layers, occupied, beam, block, row, column):
    """Take the ray that leaves a block through a pixel through the block: keep what it has met."""
    _, _, rows, columns = beams.buffers.shape
    row -= beams.behind[beam, block + 1, 0]
    column -= beams.behind[beam, block + 1, 1]
    y, x = row + beams.behind[beam, block, 0], column + beams.behind[beam, block, 1]
    new = block == 0 or y < 0 or y >= rows or x < 0 or x >= columns
    empty = meets_nothing(beams, occupied, beam, block, row, column)
    if empty and not new:
        return
    j = (row + beams.behind[beam, block + 1, 0]) + beams.behind[beam, block + 1, 2]
    i = (column + beams.behind[beam, block + 1, 1]) + beams.behind[beam, block + 1, 3]
    if j >= rows:
        j -= rows
    if i >= columns:
        i -= columns
    for channel in range(beams.buffers.shape[1]):
        met = ZERO
        if not empty:
            met = met_before(
                beams, layers, beam, channel, block, layers.depth.shape[0], row, column
            )
        beams.buffers[beam, channel, j, i] = met


@device
def span_start(visible, perspective, layer, row, column):
    """First column of the span over which directions go evenly; it starts with what is seen."""
    segment = column // SEGMENT
    span = span_of(perspective)
    if span <= SEGMENT:
        return segment * SEGMENT
    start = segment
    while start > 0 and visible[layer, row, start - 1] > 0:
        start -= 1
    away = (segment - start) * SEGMENT
    return start * SEGMENT + away // span * span


@device
def direction_over(perspective, cone, beam, zoom, row, begin, column):
    """Path length and weight of a direction at a pixel, evenly between the ends of its span."""
    span = span_of(perspective)
    s0, w0 = direction_at(perspective, cone, beam, zoom, row, begin)
    s1, w1 = direction_at(perspective, cone, beam, zoom, row, begin + span)
    if max(w0, w1) <= ZERO:
        return s0, ZERO
    along = f32(column - begin) / f32(span)
    return s0 + (s1 - s0) * along, w0 + (w1 - w0) * along


@device
def secant_over(perspective, row, begin, column):
    """Length of the pixel's own ray per depth, evenly between the ends of a span."""
    span = span_of(perspective)
    e0, e1 = eye_secant(perspective, row, begin), eye_secant(perspective, row, begin + span)
    return e0 + (e1 - e0) * (f32(column - begin) / f32(span))


@device
def beam_light(beams, layers, beam, channel, block, layer, y, x, row, column, oblique, secant):
    """What a layer sends to the eye of a beam's light, per optical depth and unit of light."""
    met = met_before(beams, layers, beam, channel, block, layer, row - y, column - x)
    T = transmitted(secant * relieved(layers.relief, layer, row, column, met))
    path = (
        layers.depth[layer, row, column] * oblique
        + met_in(layers.tinted, layers.depth, channel, layer, row, column) * secant
    )
    return min(T * mean_transmitted(path), ONE)


@device
def light_of_beams(perspective, beams, layers, visible, block, layer, row, column):
    """Light of all beams that a pixel of a layer sends to the eye: (red, green, blue), weight."""
    number = block * layers.depth.shape[0] + layer
    begin = span_start(visible, perspective, layer, row, column)
    oblique = secant_over(perspective, row, begin, column)
    faint = visible[layer, row, column // SEGMENT] == 1
    coloured = beams.buffers.shape[1] > 1
    red, green, blue, total = ZERO, ZERO, ZERO, ZERO
    for place in range(beams.few if faint else len(beams.order)):
        k = beams.order[place]
        beam = Beam(beams.table[k, 0], beams.table[k, 1], beams.table[k, 2])
        secant, weight = direction_over(
            perspective, beams.cone, beam, beams.zooms[number], row, begin, column
        )
        total += weight
        if weight > ZERO:
            y, x = beams.middle[k, number, 0], beams.middle[k, number, 1]
            red += weight * beam_light(
                beams, layers, k, 0, block, layer, y, x, row, column, oblique, secant
            )
            if coloured:
                green += weight * beam_light(
                    beams, layers, k, 1, block, layer, y, x, row, column, oblique, secant
                )
                blue += weight * beam_light(
                    beams, layers, k, 2, block, layer, y, x, row, column, oblique, secant
                )
    if not coloured:
        green, blue = red, red
    return (red, green, blue), total


@device
def blurred_light(perspective, kappa, missing, layers, layer, row, column):
    """What a layer sends to the eye of the light in one buffer per colour, per optical depth."""
    oblique = eye_secant(perspective, row, column)
    depth = layers.depth[layer, row, column]
    met = kappa * met_in(layers.tinted, layers.depth, 0, layer, row, column)
    red = light_through(missing[0, row, column], oblique, depth, met)
    if missing.shape[0] == 1:
        return red, red, red
    met = kappa * met_in(layers.tinted, layers.depth, 1, layer, row, column)
    green = light_through(missing[1, row, column], oblique, depth, met)
    met = kappa * met_in(layers.tinted, layers.depth, 2, layer, row, column)
    blue = light_through(missing[2, row, column], oblique, depth, met)
    return red, green, blue


@device
def blurred_shadow(perspective, kappa, missing, layers, layer, row, column):
    """Take the light in one buffer per colour through a pixel of a layer."""
    oblique = eye_secant(perspective, row, column)
    for channel in range(missing.shape[0]):
        missing[channel, row, column] = missing_behind(
            missing[channel, row, column], oblique,
            kappa * met_in(layers.tinted, layers.depth, channel, layer, row, column),
        )  # fmt: skip


@device
def window_mean(values, row, column, down, across, width):
    """Mean over a window of real width, along columns (0, 1) or rows (1, 0); 0 beyond the ends."""
    rows, columns = values.shape
    reach = i32((width - ONE) * HALF)
    rest = (width - ONE) * HALF - f32(reach)
    total = ZERO
    for k in range(-reach - 1, reach + 2):
        j, i = row + k * down, column + k * across
        if 0 <= j < rows and 0 <= i < columns:
            total += values[j, i] * (rest if abs(k) > reach else ONE)
    return total / width
