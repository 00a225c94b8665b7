"""CUDA launcher of directional occlusion: one launch takes light through many blocks of layers.

Layers are lit front to back, and a launch for each would cost more than its work. Here all threads
of a launch go through the layers together: one that is done with a block's part waits for the
others at a barrier of the whole grid. The grid is as large as the device holds at a time, which
such a barrier asks for; each block of threads takes one tile of the raster after another.

A thread writes only pixels and rays of its own, and sums in a fixed order: bits do not depend on
the size of the grid. Importing it takes numba-cuda.
"""

import numpy as np
from numba import cuda
from numba.cuda.core import config

from .cone_cuda_beams import advance_beams, light_by_beams
from .cone_cuda_blurred import light_blurred
from .cone_cuda_eye import look_at_block
from .cone_cuda_fill import fill_block
from .cone_cuda_published import light_as_published
from .cone_layers import SEGMENT
from .cone_rays import DEPTH, TILE, block_at
from .cuda import OPTIONS, keep_on_disk

f32, i32 = np.float32, np.int32
# Threads of a block along columns and rows: a segment by a tile's rows
THREADS = (SEGMENT, TILE)
PIXELS = SEGMENT * TILE


@cuda.jit(**OPTIONS)
def sweep_layers(volumes, sweep, sheets, eye, shade, film, light, work, first, last):
    """Take light through blocks of layers, `first` to before `last`.

    `light` is a `packed.SweptLight`: the kernel is compiled for the way that is there. `work`
    counts pixels times layers: looked up, and seen; and blocks behind which a view ray goes on.
    While a block is lit, the next is filled.
    """
    grid = cuda.cg.this_grid()
    bits = cuda.shared.array(PIXELS, i32)
    seen = cuda.shared.array((DEPTH, TILE, SEGMENT), f32)
    image = sweep.edges[0], sweep.edges[1], sweep.edges[2], sweep.edges[3]
    looked_up, marked = 0, 0
    if first == 0 and last > 0:
        looked_up += fill_block(volumes, sweep, sheets, 0, bits)
        grid.sync()
    for number in range(first, last):
        if number > work[2]:
            # Behind the last view ray
            break
        advance_beams(light.beams, sheets, number - 1)
        marked += look_at_block(
            block_at(volumes[0].places, number), sweep, sheets, eye, film, image, number, seen,
            work,
        )  # fmt: skip
        grid.sync()
        light_by_beams(light.beams, volumes[0], sweep, sheets, shade, film, image, number)
        light_blurred(light.blurred, volumes[0], sweep, sheets, shade, film, image, number)
        light_as_published(light.published, volumes[0], sweep, sheets, shade, film, image, number)
        if number < work[2]:
            looked_up += fill_block(volumes, sweep, sheets, number + 1, bits)
        grid.sync()
    cuda.atomic.add(work, 0, looked_up)
    cuda.atomic.add(work, 1, marked)


@cuda.jit(**OPTIONS)
def set_all(array, value):
    """Make all of a flat array one value."""
    start = cuda.blockIdx.x * cuda.blockDim.x + cuda.threadIdx.x
    for i in range(start, array.size, cuda.gridDim.x * cuda.blockDim.x):
        array[i] = value


for kernel in (set_all, sweep_layers):
    keep_on_disk(kernel)


def most_blocks(kernel, arguments):
    """Blocks of threads that the device holds at a time; the simulator runs one."""
    if config.ENABLE_CUDASIM:
        return 1
    overload = kernel.compile(tuple(map(kernel.typeof_pyval, arguments)))
    return overload.max_cooperative_grid_blocks(THREADS)


def array_of(value, shape, queue):
    """Array of one value, made on the device."""
    if config.ENABLE_CUDASIM:
        return cuda.to_device(np.full(shape, value))
    array = cuda.device_array(shape, value.dtype, stream=queue)
    set_all[256, 256, queue](array.ravel(), value)
    return array
