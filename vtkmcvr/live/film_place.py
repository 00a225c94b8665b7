"""Which pixels of the window a renderer draws in this very pass, also when it draws in tiles."""

from __future__ import annotations

import math
from typing import NamedTuple

from vtkmodules.vtkRenderingCore import vtkRenderer


class Place(NamedTuple):
    """Pixels of the frame buffer that a renderer draws, from the lower left corner."""

    x: int
    y: int
    width: int
    height: int

    @property
    def empty(self) -> bool:
        """Whether there is no pixel to draw."""
        return self.width < 1 or self.height < 1


def place_of(renderer: vtkRenderer) -> Place:
    """Place of a renderer, as vtkViewport::GetTiledSizeAndOrigin has it."""
    window = renderer.GetRenderWindow()
    viewport, tile = renderer.GetViewport(), window.GetTileViewport()
    ends = []
    for axis in (0, 1):
        # GetSize counts the pixels of all tiles
        size, tiles = window.GetSize()[axis], window.GetTileScale()[axis]
        low = _pixel(viewport[axis] - tile[axis], size)
        length = _pixel(viewport[axis + 2] - tile[axis], size) - low
        if low < 0:
            length, low = length + low, 0
        most = _pixel(min(tile[axis + 2], 1.0) - tile[axis], size) if tiles > 1 else size
        ends.append((low, max(0, min(length, most - low))))
    (x, width), (y, height) = ends
    return Place(x, y, width, height)


def _pixel(share: float, size: int) -> int:
    return math.floor(share * size + 0.5)
