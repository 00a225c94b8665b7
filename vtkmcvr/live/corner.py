"""A line of text in the lower left corner of a renderer."""

from __future__ import annotations

from vtkmodules.vtkRenderingCore import vtkRenderer, vtkTextActor

SIZE, MARGIN = 14, 8


class CornerText:
    """Text over everything else."""

    def __init__(self) -> None:
        self._actor = vtkTextActor()
        self._actor.SetPosition(MARGIN, MARGIN)
        self._actor.PickableOff()
        self._actor.VisibilityOff()
        look = self._actor.GetTextProperty()
        look.SetFontSize(SIZE)
        look.SetColor(1.0, 1.0, 1.0)
        look.ShadowOn()

    def attach(self, renderer: vtkRenderer) -> None:
        """Stand in this renderer."""
        renderer.AddViewProp(self._actor)

    def detach(self, renderer: vtkRenderer) -> None:
        """Stand there no more."""
        renderer.RemoveViewProp(self._actor)

    def say(self, words: str) -> None:
        """Show these words, or nothing."""
        self._actor.SetInput(words)
        self._actor.SetVisibility(bool(words))
