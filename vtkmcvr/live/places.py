"""Places of a pixel at which what stands around the volumes is looked at, one after another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..backdrop import Backdrop, Veils
from .film_place import Place

CENTRE = (0.5, 0.5)
# The usual places of eight samples of a pixel (Direct3D 11, 3.4.4.1)
SPREAD = tuple(
    (0.5 + x / 16, 0.5 + y / 16)
    for x, y in ((1, -3), (-1, 3), (5, 1), (-3, -5), (-5, 5), (-7, -1), (3, 7), (7, -7))
)


class Places:
    """Backdrop of all places in SPREAD, in the making.

    Parameters
    ----------
    place : Place
        Of the film in the window.
    """

    def __init__(self, place: Place) -> None:
        shape = len(SPREAD), place.height, place.width
        self._depth = np.empty(shape, np.float32)
        self._colour = np.empty((*shape, 4), np.uint8)
        self._veils: list[Veils] = []
        self._count = 0

    @property
    def next(self) -> tuple[float, float] | None:
        """Position in the pixel that comes next; None: there are no more."""
        return SPREAD[self._count] if self._count < len(SPREAD) else None

    def add(self, seen: Backdrop) -> None:
        """Take what is seen at the next place."""
        self._depth[self._count], self._colour[self._count] = seen.depth[0], seen.colour[0]
        if seen.veils is not None:
            self._veils.append(seen.veils)
        self._count += 1

    def together(self) -> Backdrop:
        """Backdrop with all places."""
        return Backdrop(self._depth, self._colour, np.array(SPREAD), Veils.joined(self._veils))


def edges_of(backdrop: Backdrop) -> NDArray[np.bool_]:
    """Pixels, (H, W), in which depth jumps from place to place, and their neighbours."""
    nearest, farthest = backdrop.depth.min(axis=0), backdrop.depth.max(axis=0)
    with np.errstate(invalid="ignore"):
        jump = ~(farthest <= 1.01 * nearest) & np.isfinite(nearest)
    grown = jump.copy()
    grown[1:] |= jump[:-1]
    grown[:-1] |= jump[1:]
    grown[:, 1:] |= grown[:, :-1].copy()
    grown[:, :-1] |= grown[:, 1:].copy()
    return grown
