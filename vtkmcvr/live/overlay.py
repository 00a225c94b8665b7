"""Pictures of the volumes over what a renderer has drawn itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer

from .quad import Quad
from .shown import Shown


class Overlay:
    """The last of the opaque props: edges in place of the window's, then the blended picture.

    The blended one comes last, because it has OpenGL blend again.
    """

    def __init__(self) -> None:
        self._edges, self._picture = Quad(blended=False), Quad(blended=True)

    @property
    def actors(self) -> tuple[vtkActor, vtkActor]:
        """Props that draw it, in their order."""
        return self._edges.actor, self._picture.actor

    def show(self, shown: Shown, smooth: bool) -> None:
        """Show a picture; where it has fewer pixels than the window, smooth or as they are."""
        self._picture.show(shown.pixels, smooth)
        self._edges.actor.VisibilityOff()
        if shown.edges is not None:
            self._show_edges(shown.edges)

    def _show_edges(self, pixels: NDArray[np.uint8]) -> None:
        """Show the part of a picture that has any."""
        there = pixels[..., 3] > 0
        rows, columns = np.flatnonzero(there.any(axis=1)), np.flatnonzero(there.any(axis=0))
        if not rows.size:
            return
        top, bottom, left, right = rows[0], rows[-1] + 1, columns[0], columns[-1] + 1
        height, width = there.shape
        part = left / width, 1 - bottom / height, right / width, 1 - top / height
        self._edges.show(pixels[top:bottom, left:right], part=part)

    def hide(self) -> None:
        """Show nothing."""
        for actor in self.actors:
            actor.VisibilityOff()

    def attach(self, renderer: vtkRenderer) -> None:
        """Draw in this renderer."""
        for quad in (self._edges, self._picture):
            quad.attach(renderer)

    def detach(self, renderer: vtkRenderer) -> None:
        """Draw no more."""
        for quad in (self._edges, self._picture):
            quad.detach(renderer)

    def come_last(self, renderer: vtkRenderer) -> None:
        """Stay the last props, whatever has been added since."""
        props = renderer.GetViewProps()
        count = props.GetNumberOfItems()
        if all(props.GetItemAsObject(count - 2 + i) is a for i, a in enumerate(self.actors)):
            return
        for actor in self.actors:
            renderer.RemoveViewProp(actor)
            renderer.AddViewProp(actor)
