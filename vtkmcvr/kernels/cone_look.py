"""View rays of some rows through a block of layers, by the CPU."""

import numpy as np

from .backdrop import close_openings
from .cone_eye import FAINT, dim, raise_relief, see
from .cone_layers import SEGMENT
from .cone_runs import find_runs_of_row
from .jit import device, kernel

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)


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
def mark(seen, flags, tiers, layer, row, first, last):
    """Mark the segments of a stretch of which anything is seen: 1 where little, with `tiers`."""
    for segment in range(first // SEGMENT, last // SEGMENT):
        some, much = i32(0), i32(0)
        for i in range(SEGMENT):
            T = seen[layer, row, index(segment * SEGMENT + i)]
            some |= i32(T > ZERO)
            much |= i32(T >= FAINT)
        flags[layer, row, segment] = 2 if much != 0 or (some != 0 and not tiers) else some


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
            visible.count[layer, row] = 0
            visible.flags[layer, row, :] = 0
            if not image[1] <= row < image[3]:
                continue
            first, last = reach_of_rows(eye.reach, filled, layer, row, columns)
            raise_relief(layers.relief, eye.relief, layers.depth, layer, row, first, last)
            if filled.count[layer, row] == 0:
                continue
            for run in range(filled.count[layer, row]):
                first, last = filled.start[layer, row, run], filled.end[layer, row, run]
                see(
                    openings, perspective, layers, eye, film, image, before, block.thickness,
                    opaque, limited, layer, row, first, last,
                )  # fmt: skip
                mark(layers.seen, visible.flags, tiers, layer, row, first, last)
            find_runs_of_row(visible, columns, layer, row)
            for run in range(visible.count[layer, row]):
                dim(
                    openings, perspective, layers, eye, film, image, before, limited, layer, row,
                    visible.start[layer, row, run], visible.end[layer, row, run],
                )  # fmt: skip
    return all_dark(eye.light, image, opaque, row_0, row_1)


@kernel
def close_rows(openings, T, row_0, row_1):
    """End the view rays of some rows, which have gone through all layers; T is what is left."""
    for row in range(row_0, row_1):
        for column in range(T.shape[1]):
            close_openings(openings, row, column, T[row, column], ONE)
