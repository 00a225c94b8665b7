"""Sums over the pixels of a film that say how wrong it still is.

What `vtkmcvr.accuracy.totals_of` sums over arrays of whole pictures, where the film is on a device.
"""

import math

from ..packed import BATCH
from .jit import exact

# Numbers in a `packed.FilmTotals`, and which of them is a minimum instead of a sum
FIELDS, LEAST = 9, 1


@exact
def variance_at(batches, film, row, column, c):
    """Variance of the mean radiance of a pixel, inf below two samples; see `film.error.variance`.

    Below two batches it is that of as many independent samples.
    """
    n = film.count[row, column]
    if n < 2:
        return math.inf
    if batches is not None:
        whole = n // BATCH
        if whole > 1:
            return batches.m2[row, column, c] * BATCH / (float(whole - 1) * n)
    return film.m2[row, column, c] / (float(n - 1) * n)


@exact
def clear_totals(totals, place):
    """Totals of no pixel."""
    for k in range(FIELDS):
        totals[k, place] = math.inf if k == LEAST else 0.0


@exact
def join_totals(totals, place, other):
    """Add the totals in one place to those in another."""
    for k in range(FIELDS):
        if k == LEAST:
            totals[k, place] = min(totals[k, place], totals[k, other])
        else:
            totals[k, place] += totals[k, other]


@exact
def add_pixel(film, totals, place, row, column):
    """Add a pixel to the totals in one place, in the order of a `packed.FilmTotals`."""
    n = float(film.count[row, column])
    totals[0, place] += n
    totals[LEAST, place] = min(totals[LEAST, place], n)
    noise = 0.0
    for c in range(3):
        m, v = film.mean[row, column, c], variance_at(film.batches, film, row, column, c)
        if m != 0.0:
            totals[2, place] += 1.0
        noise += v
        totals[6, place] += m * m
        totals[7, place] += m * m * v
        totals[8, place] += v * v
    if noise == math.inf:
        totals[3, place] += 1.0
    totals[4, place] += noise
    totals[5, place] += noise * noise
