"""Layers of a block on a CUDA device: what volumes hold at each pixel. It takes numba-cuda."""

import numpy as np
from numba import cuda
from numba.cuda.core import config

from .cone_layers import BRICK, SEGMENT, brick_is_empty, fill_pixel
from .cone_rays import TILE, block_at, layers_of

f32 = np.float32
ZERO = f32(0.0)
# The simulator does not know it, and needs it as little
unrolled = tuple if config.ENABLE_CUDASIM else cuda.literal_unroll


@cuda.jit(device=True)
def fill_in(volume, sweep, layers, number, row, column, more):
    """Layers of one pixel of a block in one volume.

    Returns a bit for each that is filled, and whether any was looked up.
    """
    count, rows, _ = layers.depth.shape
    block = block_at(volume.places, number)
    left, top = column - column % BRICK, row - row % TILE
    if sweep.skip and brick_is_empty(
        volume.medium, block, f32(left), f32(top), f32(BRICK), f32(min(top + TILE, rows) - top),
        block.thickness * f32(count),
    ):  # fmt: skip
        return 0, 0
    filled = fill_pixel(
        volume.medium, volume.transfer, volume.integrals, block, sweep.bleeding, layers, row,
        column, more,
    )  # fmt: skip
    return filled, 1


@cuda.jit(device=True)
def clear_pixel(sheets, which, layer, row, column):
    """Make what an earlier block left at a pixel empty: neighbours and rays look at it."""
    sheets.depth[which, layer, row, column] = ZERO
    sheets.whole[which, layer, row, column] = ZERO
    clear_colours(sheets.tinted, which, layer, row, column)
    clear_colours(sheets.mixed, which, layer, row, column)


@cuda.jit(device=True)
def clear_colours(planes, which, layer, row, column):
    """Make a pixel empty for three colours, where there are any."""
    if planes is None:
        return
    for c in range(3):
        planes[which, c, layer, row, column] = ZERO


@cuda.jit(device=True)
def fill_volumes(volumes, sweep, sheets, which, number, row, column):
    """Layers of one pixel in all volumes.

    Returns a bit for each that is filled, and in how many volumes any was looked up.
    """
    segment = column // SEGMENT
    for layer in range(sheets.depth.shape[1]):
        if sheets.filled[which, layer, row, segment] > 0:
            clear_pixel(sheets, which, layer, row, column)
    layers = layers_of(sheets, which)
    filled, looked_up = 0, 0
    more = False
    for volume in unrolled(volumes):
        here, looked = fill_in(volume, sweep, layers, number, row, column, more)
        filled |= here
        looked_up += looked
        more = True
    return filled, looked_up


@cuda.jit(device=True)
def fill_block(volumes, sweep, sheets, number, bits):
    """All layers of a block; beyond the last block nothing.

    Returns how many pixels times layers this thread has looked up.
    """
    depth, rows, columns = sheets.seen.shape
    looked_up = 0
    if number * depth >= sweep.layers:
        return looked_up
    which = number % 2
    segments = columns // SEGMENT
    i, k = cuda.threadIdx.x, cuda.threadIdx.y
    for tile in range(cuda.blockIdx.x, -(-rows // TILE) * segments, cuda.gridDim.x):
        row, segment = tile // segments * TILE + k, tile % segments
        filled = 0
        if row < rows:
            filled, looked = fill_volumes(
                volumes, sweep, sheets, which, number, row, segment * SEGMENT + i
            )
            looked_up += looked
        bits[k * SEGMENT + i] = filled
        occupied = cuda.syncthreads_or(filled)
        if i < depth and row < rows:
            dense = 0
            for other in range(SEGMENT):
                dense |= bits[k * SEGMENT + other]
            sheets.filled[which, i, row, segment] = 2 * ((dense >> i) & 1)
        if i == 0 and k == 0:
            sheets.occupied[which, tile // segments, segment] = 1 if occupied else 0
        cuda.syncthreads()
    return looked_up * min(depth, sweep.layers - number * depth)
