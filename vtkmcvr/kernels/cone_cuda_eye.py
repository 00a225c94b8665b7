"""View rays through a block of layers on a CUDA device. It takes numba-cuda."""

import numpy as np
from numba import cuda

from .cone_eye import FAINT, look, raise_relief
from .cone_layers import SEGMENT
from .cone_rays import TILE, layers_of

f32, i32 = np.float32, np.int32
ZERO, HALF = f32(0.0), f32(0.5)


@cuda.jit(device=True)
def near_medium(occupied, row, column, rows, columns):
    """Whether a pixel or a neighbour of it is in a tile that holds anything."""
    top, bottom = max(row - 1, 0) // TILE, min(row + 1, rows - 1) // TILE
    left, right = max(column - 1, 0) // SEGMENT, min(column + 1, columns - 1) // SEGMENT
    return (
        occupied[top, left] > 0 or occupied[top, right] > 0
        or occupied[bottom, left] > 0 or occupied[bottom, right] > 0
    )  # fmt: skip


@cuda.jit(device=True)
def look_through(sweep, sheets, eye, film, image, number, before, thickness, row, column, seen):
    """View ray of one pixel through a block; `seen` gets its light at each layer."""
    depth, rows, columns = sheets.seen.shape
    which = number % 2
    layers = layers_of(sheets, which)
    i, k = cuda.threadIdx.x, cuda.threadIdx.y
    inside = image[0] <= column < image[2] and image[1] <= row < image[3]
    if not inside or not (
        near_medium(sheets.occupied[which], row, column, rows, columns)
        or eye.relief[row, column] != ZERO
    ):
        return
    for layer in range(min(depth, sweep.layers - number * depth)):
        raise_relief(layers.relief, eye.relief, layers.depth, layer, row, column, column + 1)
        if sheets.filled[which, layer, row, column // SEGMENT] > 0:
            seen[layer, k, i] = look(
                sweep.perspective, layers, eye, None, film, image,
                before + thickness * (f32(layer) + HALF), thickness, sweep.opaque, sweep.limited,
                layer, row, column, column + 1,
            )  # fmt: skip


@cuda.jit(device=True)
def goes_on(sweep, eye, image, row, column):
    """Whether a view ray sees any more, as 0 or 1: barriers take no booleans."""
    if image[0] <= column < image[2] and image[1] <= row < image[3]:
        return i32(1) if eye.light[row, column] > sweep.opaque else i32(0)
    return i32(0)


@cuda.jit(device=True)
def look_at_block(place, sweep, sheets, eye, film, image, number, seen, work):
    """View rays of all pixels through a block, and which segments they see anything of.

    Returns how many pixels of such segments this thread has marked; `work` gets the block's number
    from 1 where a view ray goes on behind it.
    """
    marked = 0
    depth, rows, columns = sheets.seen.shape
    segments = columns // SEGMENT
    i, k = cuda.threadIdx.x, cuda.threadIdx.y
    for tile in range(cuda.blockIdx.x, -(-rows // TILE) * segments, cuda.gridDim.x):
        row, segment = tile // segments * TILE + k, tile % segments
        for layer in range(depth):
            seen[layer, k, i] = ZERO
        bright = i32(0)
        if row < rows:
            look_through(
                sweep, sheets, eye, film, image, number, place.before, place.thickness, row,
                segment * SEGMENT + i, seen,
            )  # fmt: skip
            bright = goes_on(sweep, eye, image, row, segment * SEGMENT + i)
        if cuda.syncthreads_or(bright) != 0 and i == 0 and k == 0:
            cuda.atomic.max(work, 2, number + 1)
        if i < depth and row < rows:
            brightest = ZERO
            for other in range(SEGMENT):
                brightest = max(brightest, seen[i, k, other])
            mark = 0
            if brightest > ZERO:
                mark = 1 if sweep.tiers and brightest < FAINT else 2
                marked += SEGMENT
            sheets.visible[i, row, segment] = mark
        cuda.syncthreads()
    return marked


@cuda.jit(device=True)
def sees(sweep, sheets, number, layer, row, column):
    """Whether the eye sees anything of a pixel of a layer."""
    if row >= sheets.seen.shape[1] or number * sheets.seen.shape[0] + layer >= sweep.layers:
        return False
    if sheets.visible[layer, row, column // SEGMENT] == 0:
        return False
    return sheets.seen[layer, row, column] > ZERO
