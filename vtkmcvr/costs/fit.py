"""The power of N with which an error falls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..accuracy import Z95


class Power(NamedTuple):
    """Error = factor N^exponent.

    Attributes
    ----------
    exponent, factor : float
    spread : float
        95 % half width of the exponent.
    """

    exponent: float
    factor: float
    spread: float


def fit_power(samples: Sequence[float], errors: Sequence[float], spreads: Sequence[float]) -> Power:
    """Weighted least squares of log error over log N.

    Parameters
    ----------
    samples : sequence
        At least two different numbers, > 0.
    errors : sequence
        Independent of each other, > 0.
    spreads : sequence
        95 % half widths of the errors, > 0.
    """
    x, y = np.log(np.asarray(samples, float)), np.log(np.asarray(errors, float))
    weight = (Z95 * np.asarray(errors, float) / np.asarray(spreads, float)) ** 2
    middle = np.average(x, weights=weight)
    square = float((weight * (x - middle) ** 2).sum())
    exponent = float((weight * (x - middle) * y).sum()) / square
    factor = float(np.exp(np.average(y, weights=weight) - exponent * middle))
    return Power(exponent, factor, Z95 / square**0.5)
