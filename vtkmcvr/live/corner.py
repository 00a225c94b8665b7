"""A line of text in the lower left corner of a renderer."""

from __future__ import annotations

from vtkmodules.vtkRenderingCore import vtkRenderer, vtkTextActor

SIZE, MARGIN = 14, 8
# Sum of red, green and blue
BRIGHT = 1.5


class CornerText:
    """Text over everything else."""

    def __init__(self) -> None:
        self._behind: vtkRenderer | None = None
        self._actor = vtkTextActor()
        self._actor.SetPosition(MARGIN, MARGIN)
        self._actor.PickableOff()
        self._actor.VisibilityOff()
        look = self._actor.GetTextProperty()
        look.SetFontSize(SIZE)

    def attach(self, renderer: vtkRenderer) -> None:
        """Stand in this renderer."""
        self._behind = renderer
        renderer.AddViewProp(self._actor)

    def detach(self, renderer: vtkRenderer) -> None:
        """Stand there no more."""
        renderer.RemoveViewProp(self._actor)

    def say(self, words: str) -> None:
        """Show these words, or nothing."""
        self._actor.SetInput(words)
        self._actor.GetTextProperty().SetColor(_legible(self._behind))
        self._actor.SetVisibility(bool(words))


def _legible(renderer: vtkRenderer | None) -> tuple[float, float, float]:
    """Black on a bright background, else white."""
    bright = renderer is not None and sum(renderer.GetBackground()) > BRIGHT
    return (0.0, 0.0, 0.0) if bright else (1.0, 1.0, 1.0)
