"""The occlusion buffer of the paper on a CUDA device, layer by layer. It takes numba-cuda."""

import numpy as np
from numba import cuda

from .cone_beams import eye_secant
from .cone_compose import compose
from .cone_cuda_eye import sees
from .cone_layers import SEGMENT
from .cone_rays import TILE, block_at, layers_of
from .cone_single import published_light, published_shadow

f32 = np.float32
ONE = f32(1.0)


@cuda.jit(device=True)
def light_as_published(published, volume, sweep, sheets, shade, film, image, number):
    """Take the light through a block, layer by layer; add to the picture what the eye sees."""
    if published is None:
        return
    grid = cuda.cg.this_grid()
    depth = sheets.seen.shape[0]
    for layer in range(min(depth, sweep.layers - number * depth)):
        light_of_layer(published, volume, sweep, sheets, shade, film, image, number, layer)
        grid.sync()


@cuda.jit(device=True)
def light_of_layer(published, volume, sweep, sheets, shade, film, image, number, layer):
    """What the eye sees of a layer, and what is missing of the light behind it."""
    depth, rows, columns = sheets.seen.shape
    layers = layers_of(sheets, number % 2)
    block = block_at(volume.places, number)
    k = number * depth + layer
    before, behind = published.missing[k % 2], published.missing[(k + 1) % 2]
    segments = columns // SEGMENT
    for tile in range(cuda.blockIdx.x, -(-rows // TILE) * segments, cuda.gridDim.x):
        row = tile // segments * TILE + cuda.threadIdx.y
        column = tile % segments * SEGMENT + cuda.threadIdx.x
        if sees(sweep, sheets, number, layer, row, column):
            a = layers.depth[layer, row, column] * eye_secant(sweep.perspective, row, column)
            V = published_light(before[row, column], a)
            compose(
                volume.medium, volume.transfer, volume.integrals, block, sweep.perspective, shade,
                layers, film, image, layer, row, column, (V, V, V), ONE,
            )  # fmt: skip
        if row < rows:
            behind[row, column] = published_shadow(
                before, layers.depth[layer, row, column], published.points[k], published.secants,
                published.exact, row, column,
            )  # fmt: skip
