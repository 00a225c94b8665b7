"""K-nearest-neighbours noise reduction over a window of 7x7 pixels."""

import math

import numpy as np

from .jit import device, entry_point

f32 = np.float32
RADIUS = 3
AREA = f32((2 * RADIUS + 1) ** 2)


@device
def knn_pixel(guide, values, share, tolerance, out, row, column):
    """Move a pixel by its `share` toward the weighted mean of its window.

    The weight of a neighbour is exp(-(|guide difference|^2 / tolerance + distance^2 / 49)), by the
    pixel's own `tolerance`. The mean is taken of differences from the pixel itself, so that equal
    values stay the same bits. The window is cut at the border: a pixel counts once (HC-60).
    """
    rows, columns, channels = values.shape
    for c in range(channels):
        out[row, column, c] = f32(0.0)
    total = f32(0.0)
    for y in range(max(row - RADIUS, 0), min(row + RADIUS + 1, rows)):
        for x in range(max(column - RADIUS, 0), min(column + RADIUS + 1, columns)):
            apart = f32(0.0)
            for c in range(guide.shape[2]):
                difference = guide[y, x, c] - guide[row, column, c]
                apart += difference * difference
            away = f32((y - row) * (y - row) + (x - column) * (x - column))
            weight = math.exp(-(apart / tolerance[row, column] + away / AREA))
            total += weight
            for c in range(channels):
                out[row, column, c] += weight * (values[y, x, c] - values[row, column, c])
    part = share[row, column] / total
    for c in range(channels):
        out[row, column, c] = values[row, column, c] + part * out[row, column, c]


@entry_point
def knn_filter(guide, values, share, tolerance, out):
    """Move all pixels; see `knn_pixel`."""
    for row in range(values.shape[0]):
        for column in range(values.shape[1]):
            knn_pixel(guide, values, share, tolerance, out, row, column)
