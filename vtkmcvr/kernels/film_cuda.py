"""CUDA launcher of what a film on a device is asked for. Importing it takes numba-cuda."""

from numba import cuda, float64

from .cuda import BLOCK, OPTIONS, keep_on_disk
from .film_totals import FIELDS, add_pixel, clear_totals, join_totals
from .shown import show_pixel

# Always as many, so that sums have one order: blocks, and threads of a block (a power of two)
BLOCKS, THREADS = 64, 128


@cuda.jit(**OPTIONS)
def show_pixels(film, screen, pixels):
    """Write all pixels of the display picture; see `show_pixel`."""
    column, row = cuda.grid(2)
    if row < film.count.shape[0] and column < film.count.shape[1]:
        show_pixel(screen, film, pixels, row, column)


@cuda.jit(**OPTIONS)
def total_pixels(film, totals, every, which):
    """Totals of each block's pixels, (BLOCKS, FIELDS).

    Of the rows, in bands as high as a block of samples, every so manieth counts.
    """
    sums = cuda.shared.array((FIELDS, THREADS), float64)
    thread = cuda.threadIdx.x
    rows, columns = film.count.shape
    clear_totals(sums, thread)
    for pixel in range(cuda.blockIdx.x * THREADS + thread, rows * columns, BLOCKS * THREADS):
        row = pixel // columns
        if row // BLOCK[1] % every == which:
            add_pixel(film, sums, thread, row, pixel % columns)
    cuda.syncthreads()
    half = THREADS // 2
    while half > 0:
        if thread < half:
            join_totals(sums, thread, thread + half)
        cuda.syncthreads()
        half //= 2
    if thread < FIELDS:
        totals[cuda.blockIdx.x, thread] = sums[thread, 0]


for kernel in (show_pixels, total_pixels):
    keep_on_disk(kernel)
