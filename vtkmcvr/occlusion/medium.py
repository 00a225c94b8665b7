"""The medium that fills the layers, as kernels take it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..pack import f32

# Transmittance below which the eye sees no more: what is left out of a picture
OPAQUE = 1e-5


@dataclass(frozen=True, eq=False)
class Filling:
    """What fills the layers.

    Attributes
    ----------
    medium : packed.Medium
    transfer : packed.Transfer
    integrals : packed.Integrals
    bleeding : float, optional
        Share of the scattered light that goes on, by colour; None: light has no colour.
    opaque : float
        Transmittance below which the eye sees no more.
    skip : bool
        Whether empty space is passed over.
    """

    medium: packed.Medium
    transfer: packed.Transfer
    integrals: packed.Integrals
    bleeding: float | None = None
    opaque: float = OPAQUE
    skip: bool = True


def integrals_of(transfer: packed.Transfer) -> packed.Integrals:
    """Running integrals of extinction and coloured extinction over the tables' entries."""
    sigma_t = transfer.sigma_t.astype(np.float64)
    lit = sigma_t[:, None] * transfer.colour
    filled = np.flatnonzero(sigma_t)
    clear = (filled[0] - 1 if len(filled) else len(sigma_t)) + 0.0
    return packed.Integrals(
        transfer.sigma_t, _running(sigma_t), _running(lit), transfer.colour, f32(clear),
        transfer.lowest, transfer.per_scalar,
    )  # fmt: skip


def _running(y: NDArray) -> NDArray[np.float64]:
    out = np.zeros_like(y)
    np.cumsum((y[1:] + y[:-1]) / 2, axis=0, out=out[1:])
    return out
