"""Light that travels in one direction: attenuated layer by layer, then read where the eye looks.

A beam is all light of one direction. Its buffer holds the optical depth that each of its rays has
met so far, on the film's raster where the rays meet the plane at which depth counts from. From
layer to layer the raster moves sideways as a whole, by the same amount for all its rays (in a
perspective view these are the rays that meet in one point of the eye's plane, straight lines too),
so that nothing is resampled on the way: no blur grows with the number of layers (HC-80).
"""

import numpy as np

from ..packed import Beam
from .cone_beams import direction_by, mean_transmitted, relieved, span_of, transmitted
from .cone_buffer import held, held_throughout, ring_row
from .cone_layers import SEGMENT
from .jit import device, kernel

f32, i32, i64, index = np.float32, np.int32, np.int64, np.uintp
ZERO, ONE = f32(0.0), f32(1.0)


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
        j, column = ring_row(buffer, origin, row - y), index(start)
        first = index(start - x - origin[1])
        for i in range(count):
            buffer[j, first + index(i)] += share * depth[layer, row, column + index(i)]


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
        j = ring_row(buffer, origin, row - y)
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
                    buffer, layers, tinted, light, layer, row, j, first, first - x - origin[1],
                    slot + first, last - first, s0 + ds * along, ds, w, dw, e0 + de * along, de,
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
    row, column, ray, slot = index(row), index(column), index(ray), index(slot)
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
def rows_of_band(band, bands, rows, moved):
    """Rows of a layer, [first, end), that the rays of a band cross; together all rows."""
    first = 0 if band == 0 else min(max(rows * band // bands + moved, 0), rows)
    end = rows if band == bands - 1 else min(max(rows * (band + 1) // bands + moved, 0), rows)
    return first, end


@device
def trace_beam(
    perspective, slants, cone, beam, bright, buffer, origin, places, first, zooms, layers, tinted,
    filled, visible, light, weight, band, bands,
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
    perspective, slants, cone, beams, members, bright, buffers, origins, places, first, start,
    zooms, layers, tinted, filled, visible, light, weight, spare, bands,
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
