"""Light in one buffer, blurred between layers, on a CUDA device. Importing it takes numba-cuda."""

import numpy as np
from numba import cuda

from .cone_compose import compose
from .cone_cuda_eye import sees
from .cone_layers import SEGMENT
from .cone_rays import TILE, block_at, blurred_light, blurred_shadow, layers_of, window_mean

f32 = np.float32
ZERO, ONE = f32(0.0), f32(1.0)


@cuda.jit(device=True)
def light_blurred(blurred, volume, sweep, sheets, shade, film, image, number):
    """Take the light through a block, layer by layer; add to the picture what the eye sees."""
    if blurred is None:
        return
    grid = cuda.cg.this_grid()
    depth = sheets.seen.shape[0]
    for layer in range(min(depth, sweep.layers - number * depth)):
        light_by_buffer(blurred, volume, sweep, sheets, shade, film, image, number, layer)
        width = blurred.widths[number * depth + layer]
        if width > ZERO:
            grid.sync()
            blur_along(blurred.missing, blurred.other, 0, 1, width)
            grid.sync()
            blur_along(blurred.other, blurred.missing, 1, 0, width)
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
def blur_along(source, target, down, across, width):
    """Mean over a window of every pixel, along columns or rows."""
    colours, rows, columns = source.shape
    segments = columns // SEGMENT
    for tile in range(cuda.blockIdx.x, -(-rows // TILE) * segments, cuda.gridDim.x):
        row = tile // segments * TILE + cuda.threadIdx.y
        column = tile % segments * SEGMENT + cuda.threadIdx.x
        if row < rows:
            for c in range(colours):
                target[c, row, column] = window_mean(source[c], row, column, down, across, width)
