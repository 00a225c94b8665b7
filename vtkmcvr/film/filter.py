"""Filter of the whole film, as Exposure Render has it (Kroes, Post, Botha 2012, PLOS ONE 7(7)).

The default of this library is another one: each sample is placed by the pixel filter, so that
pixels stay independent and their variance is the picture's (HC-58).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.floating]

# 5 pixels, standard deviation 1.5
GAUSSIAN = tuple(math.exp(-0.5 * (offset / 1.5) ** 2) for offset in range(-2, 3))


def gaussian_5x5(image: ArrayLike) -> Floats:
    """Filter a film by a 5x5 Gaussian of standard deviation 1.5 pixels.

    The paper filters each estimate before it averages them. Both steps are linear, so the average
    filtered once is the same picture. The weights are normalised inside the window, which holds
    90 % of the Gaussian along an axis, and again where the film's border cuts it (HC-59).

    Parameters
    ----------
    image : array_like
        (H, W) or (H, W, C).

    Returns
    -------
    numpy.ndarray
        Of the same shape; float32 stays float32, anything else becomes float64.
    """
    return window_mean(image, GAUSSIAN)


def window_mean(image: ArrayLike, weights: Sequence[float]) -> Floats:
    """Weighted mean over a square window, cut at the border.

    Parameters
    ----------
    image : array_like
        (H, W) or (H, W, C).
    weights : sequence of float
        Of a row and of a column of the window, an odd number of them.

    Returns
    -------
    numpy.ndarray
        Of the same shape; float32 stays float32, anything else becomes float64.
    """
    array = np.asarray(image)
    plane = array if array.dtype == np.float32 else array.astype(np.float64)
    for axis in (0, 1):
        plane = _line_mean(plane, weights, axis)
    return plane


def _line_mean(plane: Floats, weights: Sequence[float], axis: int) -> Floats:
    lines = np.moveaxis(plane, axis, 0)
    length = len(lines)
    total = np.zeros_like(lines)
    sums = np.zeros((length, *[1] * (lines.ndim - 1)), lines.dtype)
    for offset, weight in enumerate(weights, -(len(weights) // 2)):
        first, last = max(-offset, 0), min(length, length - offset)
        if first < last:
            total[first:last] += weight * lines[first + offset : last + offset]
            sums[first:last] += weight
    return np.moveaxis(total / sums, 0, axis)
