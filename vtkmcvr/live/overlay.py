"""Pictures of the volumes over what a renderer has drawn itself."""

from __future__ import annotations

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
        if shown.edges is None:
            self._edges.actor.VisibilityOff()
        else:
            self._edges.show(shown.edges)

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
