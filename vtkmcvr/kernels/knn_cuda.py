"""CUDA launcher of noise reduction: one thread a pixel. Importing it takes numba-cuda."""

from numba import cuda

from .cuda import OPTIONS, keep_on_disk
from .knn import knn_pixel


@cuda.jit(**OPTIONS)
def knn_pixels(guide, values, share, tolerance, out):
    """Move all pixels; see `knn_pixel`."""
    column, row = cuda.grid(2)
    if row < values.shape[0] and column < values.shape[1]:
        knn_pixel(guide, values, share, tolerance, out, row, column)


keep_on_disk(knn_pixels)
