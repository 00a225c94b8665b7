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

from .cone_compose import compose
from .cone_eye import FAINT, look, raise_relief
from .cone_layers import BRICK, SEGMENT, brick_is_empty, fill_pixel
from .cone_rays import (
    DEPTH,
    TILE,
    advance_ray,
    block_at,
    blurred_light,
    blurred_shadow,
    layers_of,
    light_of_beams,
    published_light,
    published_shadow,
    window_mean,
)
from .cuda import OPTIONS, keep_on_disk

f32, i32 = np.float32, np.int32
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Threads of a block along columns and rows: a segment by a tile's rows
THREADS = (SEGMENT, TILE)
PIXELS = SEGMENT * TILE
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


@cuda.jit(device=True)
def advance_beams(beams, sheets, number):
    """Take all rays of all beams through a block."""
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
def light_by_beams(volume, sweep, sheets, shade, film, image, beams, number):
    """Add to the picture what the eye sees of the beams in a block."""
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


@cuda.jit(device=True)
def edges_of(sweep):
    """(first column, first row, end column, end row) of what the eye sees."""
    return sweep.edges[0], sweep.edges[1], sweep.edges[2], sweep.edges[3]


@cuda.jit(**OPTIONS)
def sweep_beams(volumes, sweep, sheets, eye, shade, film, beams, work, first, last):
    """Take light in beams through blocks `first` to before `last`.

    `work` counts pixels times layers: looked up, and seen; and blocks behind which a view ray goes
    on.
    """
    grid = cuda.cg.this_grid()
    bits = cuda.shared.array(PIXELS, i32)
    seen = cuda.shared.array((DEPTH, TILE, SEGMENT), f32)
    image = edges_of(sweep)
    looked_up, marked = 0, 0
    if first == 0 and last > 0:
        looked_up += fill_block(volumes, sweep, sheets, 0, bits)
        grid.sync()
    for number in range(first, last):
        if number > work[2]:
            # Behind the last view ray
            break
        if number > 0:
            advance_beams(beams, sheets, number - 1)
        marked += look_at_block(
            block_at(volumes[0].places, number), sweep, sheets, eye, film, image, number, seen,
            work,
        )  # fmt: skip
        grid.sync()
        light_by_beams(volumes[0], sweep, sheets, shade, film, image, beams, number)
        if number < work[2]:
            looked_up += fill_block(volumes, sweep, sheets, number + 1, bits)
        grid.sync()
    cuda.atomic.add(work, 0, looked_up)
    cuda.atomic.add(work, 1, marked)


@cuda.jit(device=True)
def light_by_buffer(volume, sweep, sheets, shade, film, image, blur, number, layer):
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
                sweep.perspective, blur.kappa, blur.missing, layers, layer, row, column
            )
            compose(
                volume.medium, volume.transfer, volume.integrals, block, sweep.perspective, shade,
                layers, film, image, layer, row, column, V, ONE,
            )  # fmt: skip
        if row < rows and sheets.filled[which, layer, row, segment] > 0:
            blurred_shadow(sweep.perspective, blur.kappa, blur.missing, layers, layer, row, column)


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


@cuda.jit(**OPTIONS)
def sweep_blurred(volumes, sweep, sheets, eye, shade, film, blur, work, first, last):
    """Take light in one buffer, blurred between layers, through some blocks."""
    grid = cuda.cg.this_grid()
    bits = cuda.shared.array(PIXELS, i32)
    seen = cuda.shared.array((DEPTH, TILE, SEGMENT), f32)
    image = edges_of(sweep)
    depth = sheets.seen.shape[0]
    looked_up, marked = 0, 0
    if first == 0 and last > 0:
        looked_up += fill_block(volumes, sweep, sheets, 0, bits)
        grid.sync()
    for number in range(first, last):
        if number > work[2]:
            # Behind the last view ray
            break
        marked += look_at_block(
            block_at(volumes[0].places, number), sweep, sheets, eye, film, image, number, seen,
            work,
        )  # fmt: skip
        grid.sync()
        for layer in range(min(depth, sweep.layers - number * depth)):
            light_by_buffer(volumes[0], sweep, sheets, shade, film, image, blur, number, layer)
            width = blur.widths[number * depth + layer]
            if width > ZERO:
                grid.sync()
                blur_along(blur.missing, blur.other, 0, 1, width)
                grid.sync()
                blur_along(blur.other, blur.missing, 1, 0, width)
                grid.sync()
        if number < work[2]:
            looked_up += fill_block(volumes, sweep, sheets, number + 1, bits)
        grid.sync()
    cuda.atomic.add(work, 0, looked_up)
    cuda.atomic.add(work, 1, marked)


@cuda.jit(device=True)
def light_as_published(volume, sweep, sheets, shade, film, image, table, number, layer):
    """What the eye sees of a layer, and what is missing of the light behind it, as published."""
    depth, rows, columns = sheets.seen.shape
    layers = layers_of(sheets, number % 2)
    block = block_at(volume.places, number)
    k = number * depth + layer
    before, behind = table.missing[k % 2], table.missing[(k + 1) % 2]
    segments = columns // SEGMENT
    for tile in range(cuda.blockIdx.x, -(-rows // TILE) * segments, cuda.gridDim.x):
        row = tile // segments * TILE + cuda.threadIdx.y
        column = tile % segments * SEGMENT + cuda.threadIdx.x
        if sees(sweep, sheets, number, layer, row, column):
            V = published_light(sweep.perspective, before, layers, layer, row, column)
            compose(
                volume.medium, volume.transfer, volume.integrals, block, sweep.perspective, shade,
                layers, film, image, layer, row, column, (V, V, V), ONE,
            )  # fmt: skip
        if row < rows:
            behind[row, column] = published_shadow(
                before, layers, layer, table.points[k], table.secants, table.exact, row, column
            )


@cuda.jit(**OPTIONS)
def sweep_published(volumes, sweep, sheets, eye, shade, film, table, work, first, last):
    """Take light through some blocks by the occlusion buffer of the paper."""
    grid = cuda.cg.this_grid()
    bits = cuda.shared.array(PIXELS, i32)
    seen = cuda.shared.array((DEPTH, TILE, SEGMENT), f32)
    image = edges_of(sweep)
    depth = sheets.seen.shape[0]
    looked_up, marked = 0, 0
    if first == 0 and last > 0:
        looked_up += fill_block(volumes, sweep, sheets, 0, bits)
        grid.sync()
    for number in range(first, last):
        if number > work[2]:
            # Behind the last view ray
            break
        marked += look_at_block(
            block_at(volumes[0].places, number), sweep, sheets, eye, film, image, number, seen,
            work,
        )  # fmt: skip
        grid.sync()
        for layer in range(min(depth, sweep.layers - number * depth)):
            light_as_published(volumes[0], sweep, sheets, shade, film, image, table, number, layer)
            grid.sync()
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


for kernel in (set_all, sweep_beams, sweep_blurred, sweep_published):
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
