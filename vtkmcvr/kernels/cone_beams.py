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

f32, i32, i64, index = np.float32, np.int32, np.int64, np.uintp
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
def eye_secant(perspective, row, column):
    """Length of the view ray per depth."""
    if perspective is None:
        return ONE
    x = (f32(column) + HALF - perspective.eye_column) * perspective.slope
    y = (f32(row) + HALF - perspective.eye_row) * perspective.slope
    return math.sqrt(ONE + x * x + y * y)


@device
def cone_weight(cone, lx, ly, x, y, upright):
    """Whether a direction lies in the cone, with a soft edge, per solid angle; and its secant.

    `upright` is the cosine of the view ray, which goes by (x, y) per depth.
    """
    square = ONE + lx * lx + ly * ly
    inverse = ONE / math.sqrt(square)
    if cone.around_view:
        cosine = (ONE - lx * x - ly * y) * inverse * upright
    else:
        cosine = (lx * cone.axis[0] + ly * cone.axis[1] + cone.axis[2]) * inverse
    share = min(max((cosine - cone.cosine) * cone.per_cosine + HALF, ZERO), ONE)
    return share * inverse * inverse * inverse, square * inverse


@device
def direction_by(perspective, cone, beam, zoom, row, column, upright):
    """Length of a beam's path per depth, as seen at a pixel, and its weight there.

    `upright` is the cosine of the pixel's view ray.
    """
    if perspective is None:
        square = beam.sideways_x * beam.sideways_x + beam.sideways_y * beam.sideways_y
        return math.sqrt(ONE + square), beam.weight
    x = (f32(column) + HALF - perspective.eye_column) * perspective.slope
    y = (f32(row) + HALF - perspective.eye_row) * perspective.slope
    lx, ly = beam.sideways_x * zoom - x, beam.sideways_y * zoom - y
    share, secant = cone_weight(cone, lx, ly, x, y, upright)
    return secant, share * beam.weight


@device
def direction_at(perspective, cone, beam, zoom, row, column):
    """The same where nothing is known of the view ray."""
    upright = ONE / eye_secant(perspective, row, column)
    return direction_by(perspective, cone, beam, zoom, row, column, upright)


@device
def run_of(runs, run):
    """Row of a run, its first column, and how many it has."""
    start = i64(runs.listed[run, 1])
    return i64(runs.listed[run, 0]), start, i64(runs.listed[run, 2]) - start


@device
def attenuate(buffer, origin, depth, runs, layer, y, x, share, rows):
    """Add `share` of a layer's optical depth to the rays that cross some rows of it."""
    for run in range(runs.before[layer, rows[0]], runs.before[layer, rows[1]]):
        row, start, count = run_of(runs, run)
        j, first, column = index(row - y - origin[0]), index(start - x - origin[1]), index(start)
        for i in range(count):
            buffer[j, first + index(i)] += share * depth[layer, row, column + index(i)]


@device
def relieved(relief, layer, row, column, depth):
    """Optical depth less what the raster's steps added to it, which may be in the layer itself."""
    if relief is None:
        return depth
    return depth - relief[layer, row, column]


@device
def gather(
    perspective, slants, cone, beam, zoom, bright, buffer, origin, layers, tinted, runs, layer, y,
    x, rows, light, weight,
):  # fmt: skip
    """Read the beam wherever the eye sees anything in some rows of a layer.

    `bright`: not where it sees little.

    Weight and path length of the direction go evenly over a span of columns; `slants` has the view
    rays' between segments.
    """
    span = span_of(perspective)
    per_column = ONE / f32(span)
    for run in range(runs.before[layer, rows[0]], runs.before[layer, rows[1]]):
        row, start, count = run_of(runs, run)
        end = start + count
        slot = runs.slot[run] - start
        for begin in range(start, end, span):
            stop = min(begin + span, end)
            first = lit_from(bright, runs.flags, layer, row, begin, stop)
            if first == stop:
                continue
            e0, u0 = slant_at(slants, row, begin)
            e1, u1 = slant_at(slants, row, begin + span)
            s0, w0 = direction_by(perspective, cone, beam, zoom, row, begin, u0)
            s1, w1 = direction_by(perspective, cone, beam, zoom, row, begin + span, u1)
            if max(w0, w1) <= ZERO:
                continue
            ds, dw, de = (s1 - s0) * per_column, (w1 - w0) * per_column, (e1 - e0) * per_column
            while first < stop:
                last = lit_to(bright, runs.flags, layer, row, first, stop)
                along = f32(first - begin)
                w = w0 + dw * along
                weigh(weight, (slot + first) // SEGMENT, (slot + last) // SEGMENT, w, dw)
                read(
                    buffer, layers, tinted, light, layer, row, row - y - origin[0], first,
                    first - x - origin[1], slot + first, last - first, s0 + ds * along, ds, w, dw,
                    e0 + de * along, de,
                )  # fmt: skip
                first = lit_from(bright, runs.flags, layer, row, last, stop)


@device
def read(
    buffer, layers, tinted, light, layer, row, ray_row, column, ray, slot, count, s, ds, w, dw, e,
    de,
):  # fmt: skip
    """Read the beam at some columns of a row: vector code.

    Path length s of the direction, its weight w and path length e of the view ray grow by ds, dw
    and de per column.
    """
    row, ray_row = index(row), index(ray_row)
    column, ray, slot = index(column), index(ray), index(slot)
    for n in range(count):
        i, f = index(n), f32(i32(n))
        sec = s + ds * f
        T = transmitted(
            sec * relieved(layers.relief, layer, row, column + i, buffer[ray_row, ray + i])
        )
        path = (
            layers.depth[layer, row, column + i] * (e + de * f)
            + tinted[layer, row, column + i] * sec
        )
        light[slot + i] += (w + dw * f) * min(T * mean_transmitted(path), ONE)


@device
def weigh(weight, first, end, w, dw):
    """Add a direction's weight at both ends of segments."""
    for segment in range(first, end):
        k = index(segment)
        weight[k, 0] += w
        w += dw * f32(SEGMENT)
        weight[k, 1] += w


@device
def lit_from(bright, flags, layer, row, first, end):
    """Where a stretch begins that a beam lights; `bright`: not where the eye sees little."""
    if bright:
        while first < end and flags[layer, row, first // SEGMENT] == 1:
            first += SEGMENT
    return first


@device
def lit_to(bright, flags, layer, row, first, end):
    """Where such a stretch ends."""
    if not bright:
        return end
    while first < end and flags[layer, row, first // SEGMENT] != 1:
        first += SEGMENT
    return first


@device
def slant_at(slants, row, column):
    """Secant and cosine of the view ray at the left edge of a segment; see `Raster.slants`."""
    if slants is None:
        return ONE, ONE
    k = index(column // SEGMENT)
    return slants[row, k, 0], slants[row, k, 1]


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
    perspective, slants, cone, beam, bright, buffer, origin, places, first, zooms, layers, tinted, filled,
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
            perspective, slants, cone, beam, zooms[layer], bright, buffer, origin, layers, tinted,
            visible, layer, y, x, rows_of_band(band, bands, rows, y - home), light, weight,
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
    perspective, slants, cone, beams, members, bright, buffers, origins, places, first, start, zooms,
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
                        perspective, slants, cone, beam, bright, buffer, origin, places, own, zooms,
                        layers, tinted[channel], filled, visible, light[channel],
                        weight if channel == 0 else spare, band, bands if fits else 1,
                    )  # fmt: skip
