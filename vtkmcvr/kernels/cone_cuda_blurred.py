"""Light in one buffer, blurred between layers, on a CUDA device. Importing it takes numba-cuda."""

import numpy as np
from numba import cuda

from .cone_compose import compose
from .cone_cuda_eye import sees
from .cone_layers import SEGMENT
from .cone_rays import TILE, block_at, blurred_light, blurred_shadow, layers_of, window_mean

f32, i32 = np.float32, np.int32
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Pixels around a tile that shared memory has room for, and that room: a tile is wider than high
HALO = 32
ROOM = SEGMENT * (TILE + 2 * HALO)


@cuda.jit(device=True)
def light_blurred(blurred, volume, sweep, sheets, shade, film, image, number):
    """Take the light through a block, layer by layer; add to the picture what the eye sees."""
    if blurred is None:
        return
    grid = cuda.cg.this_grid()
    room = cuda.shared.array(ROOM, f32)
    depth = sheets.seen.shape[0]
    for layer in range(min(depth, sweep.layers - number * depth)):
        light_by_buffer(blurred, volume, sweep, sheets, shade, film, image, number, layer)
        width = blurred.widths[number * depth + layer]
        if width > ZERO:
            grid.sync()
            blur_along(blurred.missing, blurred.other, 0, 1, width, room)
            grid.sync()
            blur_along(blurred.other, blurred.missing, 1, 0, width, room)
            grid.sync()


@cuda.jit(device=True)
def light_by_buffer(blurred, volume, sweep, sheets, shade, film, image, number, layer):
    """What the eye sees of the light in one buffer in a layer, and the light behind it."""
    _, rows, columns = sheets.seen.shape
    which = number % 2
    layers = layers_of(sheets, which)
    block = block_at(volume.places, number)
    segments = columns // SEGMENT
    for tile in range(cuda.blockIdx.x, -(-rows // TILE) * segments, cuda.gridDim.x):
        row = tile // segments * TILE + cuda.threadIdx.y
        segment = tile % segments
        column = segment * SEGMENT + cuda.threadIdx.x
        if sees(sweep, sheets, number, layer, row, column):
            V = blurred_light(
                sweep.perspective, blurred.kappa, blurred.missing, layers, layer, row, column
            )
            compose(
                volume.medium, volume.transfer, volume.integrals, block, sweep.perspective, shade,
                layers, film, image, layer, row, column, V, ONE,
            )  # fmt: skip
        if row < rows and sheets.filled[which, layer, row, segment] > 0:
            blurred_shadow(
                sweep.perspective, blurred.kappa, blurred.missing, layers, layer, row, column
            )


@cuda.jit(device=True)
def blur_along(source, target, down, across, width, room):
    """Mean over a window of every pixel, along columns (0, 1) or rows (1, 0).

    By way of shared memory, `room`, unless the window reaches further than that has room for.
    """
    colours, rows, columns = source.shape
    segments = columns // SEGMENT
    reach = i32((width - ONE) * HALF)
    for tile in range(cuda.blockIdx.x, -(-rows // TILE) * segments, cuda.gridDim.x):
        top, left = tile // segments * TILE, tile % segments * SEGMENT
        row, column = top + cuda.threadIdx.y, left + cuda.threadIdx.x
        for c in range(colours):
            if reach < HALO:
                copy_tile(source[c], top, left, (reach + 1) * down, (reach + 1) * across, room)
                mean = mean_in_copy(room, down, across, width)
            else:
                mean = window_mean(source[c], row, column, down, across, width)
            if row < rows:
                target[c, row, column] = mean


@cuda.jit(device=True)
def copy_tile(values, top, left, above, beside, room):
    """Copy a tile, rows above and below and columns beside it; 0 beyond the ends."""
    rows, columns = values.shape
    wide = SEGMENT + 2 * beside
    # Others may still read what is there
    cuda.syncthreads()
    first = cuda.threadIdx.y * SEGMENT + cuda.threadIdx.x
    for place in range(first, (TILE + 2 * above) * wide, TILE * SEGMENT):
        row, column = top - above + place // wide, left - beside + place % wide
        inside = 0 <= row < rows and 0 <= column < columns
        room[place] = values[row, column] if inside else ZERO
    cuda.syncthreads()


@cuda.jit(device=True)
def mean_in_copy(room, down, across, width):
    """`window_mean` of this thread's pixel: the same sum, so the same bits."""
    reach = i32((width - ONE) * HALF)
    rest = (width - ONE) * HALF - f32(reach)
    wide = SEGMENT + 2 * (reach + 1) * across
    row, column = cuda.threadIdx.y + (reach + 1) * down, cuda.threadIdx.x + (reach + 1) * across
    total = ZERO
    for k in range(-reach - 1, reach + 2):
        value = room[(row + k * down) * wide + column + k * across]
        total += value * (rest if abs(k) > reach else ONE)
    return total / width
