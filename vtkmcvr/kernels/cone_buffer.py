"""Where the rays of a beam are kept: rows in a ring, columns in line.

A ray has the row and column at which it meets the raster when that has not moved; when it has moved
by (y, x), the ray meets row + y and column + x. `origin` (3,) is the first row and column of the
rays that a buffer holds, and the place of that row in the ring.
"""

import numpy as np

from .jit import device

f32, index = np.float32, np.uintp
ZERO = f32(0.0)


@device
def ring_row(buffer, origin, ray):
    """Row of a buffer that holds a row of rays."""
    j = ray - origin[0] + origin[2]
    return index(j - buffer.shape[0] if j >= buffer.shape[0] else j)


@device
def turn(buffer, origin, rows):
    """Hold rays of some rows more behind the last, or before the first; they are clear."""
    height, width = buffer.shape
    start = origin[2] if rows > 0 else origin[2] + rows
    for number in range(min(abs(rows), height)):
        j = index((start + number) % height)
        for i in range(width):
            buffer[j, index(i)] = ZERO
    origin[0] += rows
    origin[2] = (origin[2] + rows) % height


@device
def shift(buffer, origin, columns):
    """Move the rays of a buffer by whole columns; what comes in is clear."""
    height, width = buffer.shape
    for j in range(height):
        if columns <= 0:
            for i in range(width + columns):
                buffer[j, i] = buffer[j, i - columns]
            for i in range(max(width + columns, 0), width):
                buffer[j, i] = ZERO
        else:
            for i in range(width - 1, columns - 1, -1):
                buffer[j, i] = buffer[j, i - columns]
            for i in range(min(columns, width)):
                buffer[j, i] = ZERO
    origin[1] -= columns


@device
def held(buffer, origin, y, x, rows, columns):
    """Make the buffer hold the rays that meet the film when the raster has moved by (y, x).

    Columns are moved as far as there is room where the film would stick out.
    """
    height, width = buffer.shape
    top, left = -y - origin[0], -x - origin[1]
    if top < 0:
        turn(buffer, origin, top)
    elif top + rows > height:
        turn(buffer, origin, top + rows - height)
    if left < 0:
        shift(buffer, origin, width - columns - left)
    elif left + columns > width:
        shift(buffer, origin, -left)


@device
def held_throughout(buffer, origin, places, rows, columns):
    """Make the buffer hold all rays that meet the film at any of some places; False: no room."""
    top, left, bottom, right = places[0, 0], places[0, 1], places[0, 0], places[0, 1]
    for n in range(len(places)):
        top, bottom = min(top, places[n, 0]), max(bottom, places[n, 0])
        left, right = min(left, places[n, 1]), max(right, places[n, 1])
    tall, wide = rows + bottom - top, columns + right - left
    if tall > buffer.shape[0] or wide > buffer.shape[1]:
        return False
    held(buffer, origin, bottom, right, tall, wide)
    return True
