"""Stretches of a layer's rows that hold anything: runs of segments."""

import numpy as np

from .cone_layers import SEGMENT
from .jit import device, kernel

ZERO = np.float32(0.0)


@device
def clear_planes(planes, layer, row, first, last):
    """Make the pixels of a row empty for three colours, where there are any."""
    if planes is None:
        return
    for c in range(3):
        for column in range(first, last):
            planes[c, layer, row, column] = ZERO


@device
def find_runs_of_row(runs, columns, layer, row):
    """Stretches of flagged segments in a row of a layer."""
    n = 0
    before = False
    for segment in range(runs.flags.shape[2]):
        now = runs.flags[layer, row, segment] > 0
        if now:
            if not before:
                runs.start[layer, row, n] = segment * SEGMENT
                n += 1
            runs.end[layer, row, n - 1] = min((segment + 1) * SEGMENT, columns)
        before = now
    runs.count[layer, row] = n


@device
def find_runs(runs, columns, row_0, row_1):
    """Stretches of flagged segments in some rows of every layer."""
    for layer in range(runs.flags.shape[0]):
        for row in range(row_0, row_1):
            find_runs_of_row(runs, columns, layer, row)


@kernel
def clear_rows(layers, filled, row_0, row_1):
    """Make what an earlier block left in some rows empty: neighbours look at it."""
    for layer in range(layers.depth.shape[0]):
        for row in range(row_0, row_1):
            for run in range(filled.count[layer, row]):
                first, last = filled.start[layer, row, run], filled.end[layer, row, run]
                for column in range(first, last):
                    layers.depth[layer, row, column] = ZERO
                    layers.whole[layer, row, column] = ZERO
                clear_planes(layers.tinted, layer, row, first, last)
                clear_planes(layers.mixed, layer, row, first, last)
            for segment in range(filled.flags.shape[2]):
                filled.flags[layer, row, segment] = 0


@kernel
def list_runs(runs):
    """List all runs and give each its place in compact arrays. Returns their length."""
    total, n = 0, 0
    for layer in range(runs.count.shape[0]):
        runs.first[layer] = n
        for row in range(runs.count.shape[1]):
            runs.before[layer, row] = n
            for i in range(runs.count[layer, row]):
                start, end = runs.start[layer, row, i], runs.end[layer, row, i]
                runs.listed[n, 0], runs.listed[n, 1], runs.listed[n, 2] = row, start, end
                runs.slot[n] = total
                total += end - start
                n += 1
        runs.before[layer, runs.count.shape[1]] = n
    runs.first[runs.count.shape[0]] = n
    return total
