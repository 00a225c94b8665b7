"""The medium that fills the layers, as kernels take it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..kernels.cone_fill import LANES
from ..pack import f32
from ..plan import Plan

# Transmittance below which the eye sees no more: what is left out of a picture
OPAQUE = 1e-5


@dataclass(frozen=True, eq=False)
class Filled:
    """One volume, with the map from the world around the first one's centre into its indices."""

    medium: packed.Medium
    transfer: packed.Transfer
    integrals: packed.Integrals
    index_from_world: NDArray[np.float64]
    index_of_centre: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Filling:
    """What fills the layers.

    Attributes
    ----------
    volumes : tuple of Filled
        Their extinctions add.
    bleeding : float, optional
        Share of the scattered light that goes on, by colour; None: light has no colour.
    opaque : float
        Transmittance below which the eye sees no more.
    skip : bool
        Whether empty space is passed over.
    """

    volumes: tuple[Filled, ...]
    bleeding: float | None = None
    opaque: float = OPAQUE
    skip: bool = True

    def lanes(self, number: int) -> packed.Lanes:
        """Room for looking a volume up, of one thread."""
        medium, transfer = self.volumes[number].medium, self.volumes[number].transfer
        more = (
            transfer.gradient_opacity, transfer.table_2d, medium.labels, medium.holes,
            medium.regions, self.bleeding,
        )  # fmt: skip
        plain = len(self.volumes) == 1 and all(part is None for part in more)
        return packed.Lanes(
            medium.values.reshape(-1), np.zeros(LANES, f32), np.zeros(3 * LANES, np.int32),
            np.zeros(3 * LANES, f32), np.zeros(8 * LANES, medium.values.dtype),
            np.zeros(LANES, f32), np.zeros(LANES, f32), np.zeros(LANES) if plain else None,
            np.zeros(LANES, f32),
        )  # fmt: skip

    @property
    def limited(self) -> bool:
        """Whether light meets less extinction than there is."""
        return any(bool(v.integrals.limited) for v in self.volumes)


def volumes_of(planned: Plan, most: float = math.inf) -> tuple[Filled, ...]:
    """All volumes of a plan.

    Parameters
    ----------
    planned : Plan
    most : float
        Largest extinction that light meets, 1/world unit.
    """
    scene = planned.packed
    camera = scene.camera
    first = (scene.medium, scene.transfer, camera.index_from_world, camera.index_of_centre)
    others = (
        (v.medium, v.transfer, v.index_from_world, v.index_of_centre) for v in scene.more or ()
    )
    parts = (first, *others)
    limited = any(float(transfer.sigma_t.max()) > most for _, transfer, _, _ in parts)
    return tuple(
        Filled(medium, transfer, integrals_of(transfer, most, limited), np.array(m), np.array(c))
        for medium, transfer, m, c in parts
    )


def integrals_of(
    transfer: packed.Transfer, most: float = math.inf, limited: bool = False
) -> packed.Integrals:
    """Running integrals of extinction and coloured extinction over the tables' entries."""
    whole = transfer.sigma_t.astype(np.float64)
    sigma_t = np.minimum(whole, most)
    colour = transfer.colour
    if len(colour) != len(whole):
        # Another table, or the volume, has the colour
        colour = np.zeros((len(whole), 3), f32)
    lit = sigma_t[:, None] * colour
    entries = int(transfer.entries)
    filled = np.flatnonzero(sigma_t.reshape(-1, entries).any(axis=0))
    clear = (filled[0] - 1 if len(filled) else entries) + 0.0
    return packed.Integrals(
        sigma_t.astype(f32), _running(sigma_t), transfer.sigma_t, _running(whole), _running(lit),
        colour, f32(clear), f32(entries - 1), transfer.lowest, transfer.per_scalar,
        f32(min(most, 1e30)), np.bool_(limited),
    )  # fmt: skip


def _running(y: NDArray) -> NDArray[np.float64]:
    out = np.zeros_like(y)
    np.cumsum((y[1:] + y[:-1]) / 2, axis=0, out=out[1:])
    return out
