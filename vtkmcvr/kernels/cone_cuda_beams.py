"""Light in beams through a block of layers on a CUDA device. Importing it takes numba-cuda."""

from numba import cuda

from .cone_compose import compose
from .cone_cuda_eye import sees
from .cone_layers import SEGMENT
from .cone_rays import TILE, advance_ray, block_at, layers_of, light_of_beams


@cuda.jit(device=True)
def advance_beams(beams, sheets, number):
    """Take all rays of all beams through a block, before which there may be none."""
    if beams is None:
        return
    if number < 0:
        return
    _, rows, columns = sheets.seen.shape
    which = number % 2
    layers, occupied = layers_of(sheets, which), sheets.occupied[which]
    segments = columns // SEGMENT
    tiles = -(-rows // TILE) * segments
    for task in range(cuda.blockIdx.x, len(beams.order) * tiles, cuda.gridDim.x):
        beam, tile = task // tiles, task % tiles
        row = tile // segments * TILE + cuda.threadIdx.y
        column = tile % segments * SEGMENT + cuda.threadIdx.x
        if row < rows:
            advance_ray(beams, layers, occupied, beam, number, row, column)


@cuda.jit(device=True)
def light_by_beams(beams, volume, sweep, sheets, shade, film, image, number):
    """Add to the picture what the eye sees of the beams in a block."""
    if beams is None:
        return
    depth, rows, columns = sheets.seen.shape
    layers = layers_of(sheets, number % 2)
    block = block_at(volume.places, number)
    segments = columns // SEGMENT
    for tile in range(cuda.blockIdx.x, -(-rows // TILE) * segments, cuda.gridDim.x):
        row = tile // segments * TILE + cuda.threadIdx.y
        column = tile % segments * SEGMENT + cuda.threadIdx.x
        for layer in range(depth):
            if sees(sweep, sheets, number, layer, row, column):
                V, total = light_of_beams(
                    sweep.perspective, beams, layers, sheets.visible, number, layer, row, column
                )
                compose(
                    volume.medium, volume.transfer, volume.integrals, block, sweep.perspective,
                    shade, layers, film, image, layer, row, column, V, total,
                )  # fmt: skip
