"""What VTK draws around the volumes of a renderer, looked at bit by bit."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkRenderingCore import vtkRenderer

from ..backdrop import Backdrop
from .around import Around
from .depths import DepthPass, colours_below
from .film_place import Place
from .places import CENTRE, Places, edges_of
from .shown import Edges


class Surroundings:
    """Backdrop of one view, in the making: one place of every pixel after another.

    Parameters
    ----------
    renderer : vtkRenderer
    """

    def __init__(self, renderer: vtkRenderer) -> None:
        self._renderer, self._depths = renderer, DepthPass()
        self._place = Place(0, 0, 0, 0)
        self._places: Places | None = None
        self._below: NDArray[np.uint8] | None = None

    def begin(self, place: Place, props: Around) -> None:
        """Take a new view, in the renderer's StartEvent."""
        self._place = place
        self._places = Places(place) if props.backdrop else None
        self._below = colours_below(self._renderer, place) if props.backdrop else None

    def centre(self, props: Around) -> Backdrop | None:
        """Backdrop at the centres of the pixels, for a preview; None: there is nothing around."""
        return self._at(CENTRE, props) if props.backdrop else None

    def look_on(self, props: Around, seconds: float) -> bool:
        """Look at the next places, one at least, for so long; False: there were none left."""
        places = self._places
        if places is None or places.next is None:
            return False
        begin, longest = time.perf_counter(), 0.0
        while places.next and time.perf_counter() - begin + longest <= seconds:
            start = time.perf_counter()
            places.add(self._at(places.next, props))
            longest = max(longest, time.perf_counter() - start)
        return True

    def together(self) -> Backdrop | None:
        """Backdrop of all places, once there are none left."""
        places, self._places = self._places, None
        return None if places is None else places.together()

    def edges(self, backdrop: Backdrop | None) -> Edges | None:
        """Pixels of a backdrop in which a mesh ends, and the background there."""
        if backdrop is None:
            return None
        below = self._below
        if below is None:
            below = self._depths.background(self._renderer, self._place)
        return Edges(edges_of(backdrop), below[..., :3])

    def _at(self, offset: tuple[float, float], props: Around) -> Backdrop:
        return self._depths.read(
            self._renderer, self._place, props.drawn, offset, props.veils, self._below
        )
