"""Blur of a buffer by running sums: any width costs the same.

A window of width w covers the pixel, whole pixels to both sides and a part of one more; its
variance is close to (w^2 - 1) / 12. Nothing is there beyond the ends. A `part` of a buffer is first
row, end row, first column, end column: beyond it all is zero, and nothing is done.
"""

import numpy as np

from .jit import device

f32, i32, index = np.float32, np.int32, np.uintp
ZERO, HALF, ONE = f32(0.0), f32(0.5), f32(1.0)
# Rows taken together
TOGETHER = 4


@device
def window_of(width):
    """Whole pixels to either side of a window, the share of one more, and one over its width."""
    reach = i32((width - ONE) * HALF)
    return reach, (width - ONE) * HALF - f32(reach), ONE / width


@device
def value(ends, source, row, i):
    """A pixel of a row; `ends` (or None): it may lie beyond them."""
    if ends is not None:
        if i < 0 or i >= source.shape[1]:
            return ZERO
    return source[row, index(i)]


@device
def slide(ends, source, target, row, i, window, total):
    """Mean over the window at a pixel. Returns the sum that the next one starts with."""
    reach, rest, scale = window
    left, right = value(ends, source, row, i - reach - 1), value(ends, source, row, i + reach + 1)
    # One sum: each waits for the one before
    total += value(ends, source, row, i + reach) - left
    target[row, index(i)] = (total + rest * (left + right)) * scale
    return total


@device
def slide_rows(ends, source, target, rows, first, end, window, totals):
    """Mean at some pixels of four rows: while one waits, the others go on. Returns their sums."""
    a, b, c, d = rows
    s, t, u, v = totals
    for i in range(first, end):
        s = slide(ends, source, target, a, i, window, s)
        t = slide(ends, source, target, b, i, window, t)
        u = slide(ends, source, target, c, i, window, u)
        v = slide(ends, source, target, d, i, window, v)
    return s, t, u, v


@device
def sum_before(source, row, first, reach):
    """What the window of a row's first pixel holds but for its last one."""
    total = ZERO
    for i in range(max(first - reach, 0), min(first + reach, source.shape[1])):
        total += source[row, index(i)]
    return total


@device
def blur_rows(source, target, width, part):
    """Mean over a window of real width along rows. Returns the part that it reaches."""
    columns = source.shape[1]
    window = window_of(width)
    reach = window[0]
    first, end = max(part[2] - reach - 1, 0), min(part[3] + reach + 1, columns)
    inner = min(max(first, reach + 1), end)
    outer = max(min(end, columns - reach - 1), inner)
    for row in range(part[0], part[1], TOGETHER):
        # The last one again where fewer are left
        last = part[1] - 1
        rows = (
            index(row), index(min(row + 1, last)), index(min(row + 2, last)),
            index(min(row + 3, last)),
        )  # fmt: skip
        totals = (
            sum_before(source, rows[0], first, reach), sum_before(source, rows[1], first, reach),
            sum_before(source, rows[2], first, reach), sum_before(source, rows[3], first, reach),
        )  # fmt: skip
        totals = slide_rows(True, source, target, rows, first, inner, window, totals)
        totals = slide_rows(None, source, target, rows, inner, outer, window, totals)
        slide_rows(True, source, target, rows, outer, end, window, totals)
    return part[0], part[1], first, end


@device
def slide_down(above, leaving, coming, target, running, first, end, rest, scale):
    """Mean of some pixels of a row along columns, and their sums for the next row.

    `running` holds the sums of the windows' whole pixels; the row above them, the first and the
    one below them are given.
    """
    for c in range(first, end):
        i = index(c)
        total = running[i]
        target[i] = (total + rest * (above[i] + coming[i])) * scale
        running[i] = total + (coming[i] - leaving[i])


@device
def blur_columns(source, target, running, width, part):
    """The same along columns; `running` (2, columns) is room for sums, and a row of zeros."""
    rows = source.shape[0]
    reach, rest, scale = window_of(width)
    first, end = max(part[0] - reach - 1, 0), min(part[1] + reach + 1, rows)
    sums, nothing = running[0], running[1]
    for c in range(part[2], part[3]):
        sums[index(c)] = ZERO
    for row in range(max(first - reach, 0), min(first + reach + 1, rows)):
        for c in range(part[2], part[3]):
            sums[index(c)] += source[row, index(c)]
    for row in range(first, end):
        before, behind = row - reach - 1, row + reach + 1
        slide_down(
            source[before] if before >= 0 else nothing,
            source[before + 1] if before >= -1 else nothing,
            source[behind] if behind < rows else nothing, target[row], sums, part[2], part[3], rest,
            scale,
        )  # fmt: skip
    return first, end, part[2], part[3]
