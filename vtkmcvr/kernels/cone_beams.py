"""Light that travels in one direction: attenuated layer by layer, then read where the eye looks.

A beam is all light of one direction. Its buffer holds the optical depth that each of its rays has
met so far, on the film's raster where the rays meet the plane at which depth counts from. From
layer to layer the raster moves sideways as a whole, by the same amount for all its rays (in a
perspective view these are the rays that meet in one point of the eye's plane, straight lines too),
so that nothing is resampled on the way: no blur grows with the number of layers (HC-80).
"""

import math

import numpy as np

from ..packed import Beam
from .cone_layers import SEGMENT
from .jit import device, kernel

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE, TWO = f32(0.0), f32(0.5), f32(1.0), f32(2.0)
SIXTH, TWENTY_FOURTH = f32(1.0 / 6.0), f32(1.0 / 24.0)
STEP = f32(1.0 / SEGMENT)
# (1 - e^-x) / x as a quotient of polynomials: 1 - x/2 + x^2/6 at 0, 1/x at infinity, relative error
# 6e-4 in between
P1, P2, P3 = f32(0.28106047), f32(0.06866372), f32(0.01305129)
Q1, Q2 = f32(0.78106047), f32(0.29252)


@device
def transmitted(depth):
    """e^-depth for depth >= 0, absolute error 4e-6: a Taylor polynomial, squared six times.

    Without branches and integers, so that compilers turn it into vector code.
    """
    y = max(-depth, f32(-64.0)) * f32(1.0 / 64.0)
    p = ONE + y * (ONE + y * (HALF + y * SIXTH))
    p *= p
    p *= p
    p *= p
    p *= p
    p *= p
    return p * p


@device
def opacity(depth):
    """1 - e^-depth for depth >= 0, relative error 1e-6: as `transmitted`, by what is missing.

    Squaring 1 - x makes it 1 - x (2 - x).
    """
    y = min(depth, f32(64.0)) * f32(1.0 / 64.0)
    x = y * (ONE - y * (HALF - y * (SIXTH - y * TWENTY_FOURTH)))
    x *= TWO - x
    x *= TWO - x
    x *= TWO - x
    x *= TWO - x
    x *= TWO - x
    return x * (TWO - x)


@device
def mean_transmitted(x):
    """(1 - e^-x) / x: mean transmittance over a layer of optical depth x."""
    over = ONE + x * (P1 + x * (P2 + x * P3))
    return over / (ONE + x * (Q1 + x * (Q2 + x * (P2 + x * P3))))


@device
def copied(buffer, rows, columns):
    """Move the content of a buffer by whole rows and columns; what comes in is clear."""
    height, width = buffer.shape
    for j in range(height):
        target = j if rows <= 0 else height - 1 - j
        source = target - rows
        if source < 0 or source >= height:
            for i in range(width):
                buffer[target, i] = ZERO
        elif columns <= 0:
            for i in range(width + columns):
                buffer[target, i] = buffer[source, i - columns]
            for i in range(max(width + columns, 0), width):
                buffer[target, i] = ZERO
        else:
            for i in range(width - 1, columns - 1, -1):
                buffer[target, i] = buffer[source, i - columns]
            for i in range(min(columns, width)):
                buffer[target, i] = ZERO


@device
def held(buffer, origin, y, x, rows, columns):
    """Make the buffer hold the rays that meet the film when the raster has moved by (y, x).

    Ray j of the raster is kept at index j - origin and meets film row j + y. Moves the content
    when the film would stick out.
    """
    height, width = buffer.shape
    room_y, room_x = height - rows, width - columns
    top, left = -y - origin[0], -x - origin[1]
    move_y, move_x = 0, 0
    if top < 0:
        move_y = room_y - top
    elif top > room_y:
        move_y = -top
    if left < 0:
        move_x = room_x - left
    elif left > room_x:
        move_x = -left
    if move_x != 0 or move_y != 0:
        copied(buffer, move_y, move_x)
        origin[0] -= move_y
        origin[1] -= move_x


@device
def cone_weight(cone, lx, ly, x, y):
    """Whether a direction lies in the cone, with a soft edge, per solid angle; and its secant."""
    square = ONE + lx * lx + ly * ly
    inverse = ONE / math.sqrt(square)
    if cone.around_view:
        upright = ONE / math.sqrt(ONE + x * x + y * y)
        cosine = (ONE - lx * x - ly * y) * inverse * upright
    else:
        cosine = (lx * cone.axis[0] + ly * cone.axis[1] + cone.axis[2]) * inverse
    share = min(max((cosine - cone.cosine) * cone.per_cosine + HALF, ZERO), ONE)
    return share * inverse * inverse * inverse, square * inverse


@device
def direction_at(perspective, cone, beam, zoom, row, column):
    """Length of a beam's path per depth, as seen at a pixel, and its weight there."""
    if perspective is None:
        square = beam.sideways_x * beam.sideways_x + beam.sideways_y * beam.sideways_y
        return math.sqrt(ONE + square), beam.weight
    x = (f32(column) + HALF - perspective.eye_column) * perspective.slope
    y = (f32(row) + HALF - perspective.eye_row) * perspective.slope
    lx, ly = beam.sideways_x * zoom - x, beam.sideways_y * zoom - y
    share, secant = cone_weight(cone, lx, ly, x, y)
    return secant, share * beam.weight


@device
def eye_secant(perspective, row, column):
    """Length of the view ray per depth."""
    if perspective is None:
        return ONE
    x = (f32(column) + HALF - perspective.eye_column) * perspective.slope
    y = (f32(row) + HALF - perspective.eye_row) * perspective.slope
    return math.sqrt(ONE + x * x + y * y)


@device
def attenuate(buffer, origin, depth, runs, layer, y, x, share, rows):
    """Add `share` of a layer's optical depth to the rays that cross some rows of it."""
    shift = -x - origin[1]
    for run in range(runs.before[layer, rows[0]], runs.before[layer, rows[1]]):
        row = runs.listed[run, 0]
        j = index(row - y - origin[0])
        for column in range(runs.listed[run, 1], runs.listed[run, 2]):
            buffer[j, index(column + shift)] += share * depth[layer, row, index(column)]


@device
def relieved(relief, layer, row, column, depth):
    """Optical depth less what the raster's steps added to it, which may be in the layer itself."""
    if relief is None:
        return depth
    return depth - relief[layer, row, column]


@device
def gather(
    perspective, cone, beam, zoom, bright, buffer, origin, layers, tinted, runs, layer, y, x, rows,
    light, weight,
):  # fmt: skip
    """Read the beam wherever the eye sees anything in some rows of a layer.

    `bright`: not where it sees little.

    Weight and path length of the direction go evenly over a span of columns.
    """
    depth, relief = layers.depth, layers.relief
    shift = -x - origin[1]
    span = span_of(perspective)
    per_column = ONE / f32(span)
    for run in range(runs.before[layer, rows[0]], runs.before[layer, rows[1]]):
        row, start, end = runs.listed[run, 0], runs.listed[run, 1], runs.listed[run, 2]
        j = index(row - y - origin[0])
        slot = runs.slot[run] - start
        for begin in range(start, end, span):
            s0, w0 = direction_at(perspective, cone, beam, zoom, row, begin)
            s1, w1 = direction_at(perspective, cone, beam, zoom, row, begin + span)
            e0 = eye_secant(perspective, row, begin)
            e1 = eye_secant(perspective, row, begin + span)
            if max(w0, w1) <= ZERO:
                continue
            ds, dw, de = (s1 - s0) * per_column, (w1 - w0) * per_column, (e1 - e0) * per_column
            for first in range(begin, min(begin + span, end), SEGMENT):
                if bright and runs.flags[layer, row, first // SEGMENT] == 1:
                    continue
                along = f32(first - begin)
                s, w, e = s0 + ds * along, w0 + dw * along, e0 + de * along
                segment = index((slot + first) // SEGMENT)
                weight[segment, 0] += w
                weight[segment, 1] += w + dw * f32(SEGMENT)
                for i in range(SEGMENT):
                    column = index(first + i)
                    f = f32(i)
                    sec = s + ds * f
                    T = transmitted(
                        sec
                        * relieved(relief, layer, row, column, buffer[j, index(first + i + shift)])
                    )
                    path = (
                        depth[layer, row, column] * (e + de * f) + tinted[layer, row, column] * sec
                    )
                    light[index(slot + first + i)] += (w + dw * f) * min(
                        T * mean_transmitted(path), ONE
                    )


@device
def span_of(perspective):
    """Columns over which directions go evenly."""
    if perspective is None:
        return 4096
    return perspective.span


@device
def held_throughout(buffer, origin, places, rows, columns):
    """Make the buffer hold all rays that meet the film at any of some places; False: no room."""
    top, left, bottom, right = places[0, 0], places[0, 1], places[0, 0], places[0, 1]
    for n in range(len(places)):
        top, bottom = min(top, places[n, 0]), max(bottom, places[n, 0])
        left, right = min(left, places[n, 1]), max(right, places[n, 1])
    tall, wide = rows + bottom - top, columns + right - left
    if tall > buffer.shape[0] or wide > buffer.shape[1]:
        return False
    held(buffer, origin, bottom, right, tall, wide)
    return True


@device
def rows_of_band(band, bands, rows, moved):
    """Rows of a layer, [first, end), that the rays of a band cross; together all rows."""
    first = 0 if band == 0 else min(max(rows * band // bands + moved, 0), rows)
    end = rows if band == bands - 1 else min(max(rows * (band + 1) // bands + moved, 0), rows)
    return first, end


@device
def trace_beam(
    perspective, cone, beam, bright, buffer, origin, places, first, zooms, layers, tinted, filled,
    visible, light, weight, band, bands,
):  # fmt: skip
    """Take the rays of a band of one beam through a block of layers."""
    count, rows, columns = layers.depth.shape
    home = places[first[0], 0]
    for layer in range(count):
        a, b = first[layer], first[layer + 1]
        y, x = places[(a + b) // 2, 0], places[(a + b) // 2, 1]
        if bands == 1:
            held(buffer, origin, y, x, rows, columns)
        gather(
            perspective, cone, beam, zooms[layer], bright, buffer, origin, layers, tinted, visible,
            layer, y, x, rows_of_band(band, bands, rows, y - home), light, weight,
        )  # fmt: skip
        for place in range(a, b):
            y, x = places[place, 0], places[place, 1]
            if bands == 1:
                held(buffer, origin, y, x, rows, columns)
            attenuate(
                buffer, origin, tinted, filled, layer, y, x, ONE / f32(b - a),
                rows_of_band(band, bands, rows, y - home),
            )  # fmt: skip


@kernel
def trace_beams(
    perspective, cone, beams, members, bright, buffers, origins, places, first, start, zooms,
    layers, tinted, filled, visible, light, weight, spare, bands,
):  # fmt: skip
    """Take some beams through a block of layers: what the eye sees of them, and their shadows.

    `tinted` is the layers' optical depth for light of one or three colours, [colour, ...].
    `beams` (n, 3) are sideways measures and weights, `members` the numbers of those to take;
    `buffers` and `origins` are [beam, colour, ...]. `places` (m, 2): by how many rows and columns a
    beam's raster has moved, for each layer in each of the parts in which it is crossed;
    `first` (n, layers + 1): where a layer's places start, `start` being the block's first layer.
    `bright`: the beams are left out where the eye sees little. `weight` (segments, 2) is summed at
    both ends of a segment; the weights of the second and third colour are the same, and go to
    `spare`. Rays are taken in `bands` of rows, so that all beams find a band's layers in the cache.
    """
    count, rows, columns = layers.depth.shape
    for band in range(bands):
        for k in members:
            beam = Beam(beams[k, 0], beams[k, 1], beams[k, 2])
            own = first[k, start : start + count + 1]
            for channel in range(buffers.shape[1]):
                buffer, origin = buffers[k, channel], origins[k, channel]
                # Rays must not be moved between the bands
                fits = held_throughout(buffer, origin, places[own[0] : own[count]], rows, columns)
                if fits or band == 0:
                    trace_beam(
                        perspective, cone, beam, bright, buffer, origin, places, own, zooms,
                        layers, tinted[channel], filled, visible, light[channel],
                        weight if channel == 0 else spare, band, bands if fits else 1,
                    )  # fmt: skip
