"""All live views of a render window, and what makes it render again when there is more to show."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from vtkmodules.util.misc import calldata_type
from vtkmodules.vtkCommonCore import VTK_INT, vtkCommand
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkRenderWindowInteractor

from .places import SPREAD
from .refiner import Refiner
from .settings import LiveSettings
from .view import LiveView

# Milliseconds between two looks at the refiner
TICK = 30
# Priority before other observers
FIRST = 1.0


class LiveWindow:
    """Live views of some renderers of a window.

    Parameters
    ----------
    window : vtkRenderWindow
    renderers : iterable of vtkRenderer
    settings : LiveSettings
    progressive : callable
        Whether pictures are refined from frame to frame, asked for each frame.
    """

    def __init__(
        self,
        window: vtkRenderWindow,
        renderers: Iterable[vtkRenderer],
        settings: LiveSettings,
        progressive: Callable[[], bool],
    ) -> None:
        self._window = window
        self._refiner = Refiner()
        self.views = [LiveView(r, settings, self._refiner, progressive) for r in renderers]
        self._tag = window.AddObserver(vtkCommand.EndEvent, lambda *_: self._refiner.go_on())
        self._timer: tuple[vtkRenderWindowInteractor, int, int] | None = None

    @property
    def waiting(self) -> bool:
        """Whether another frame would show more."""
        return any(view.waiting for view in self.views)

    def look_on(self) -> None:
        """Do what pictures in the making want done of VTK between two frames; for events."""
        for view in self.views:
            view.look_on()

    def check(self) -> None:
        """Raise what is wrong with any of the volumes."""
        for view in self.views:
            view.check()

    def change(self, settings: LiveSettings) -> None:
        """Take other settings from the next frame on."""
        for view in self.views:
            view.change(settings)

    def start_timer(self, interactor: vtkRenderWindowInteractor) -> None:
        """Render again, from the event loop, whenever there is more to show."""
        if self._timer is not None:
            return
        timer = interactor.CreateRepeatingTimer(TICK)

        @calldata_type(VTK_INT)
        def tick(_: Any, __: str, which: int) -> None:
            if which == timer:
                # Others take any timer for theirs: VTK's style of charts renders on each
                interactor.GetCommand(tag).AbortFlagOn()
                self._tick()

        tag = interactor.AddObserver(vtkCommand.TimerEvent, tick, FIRST)
        self._timer = interactor, tag, timer

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until all pictures are done, and draw them; False after `timeout` seconds."""
        self._window.Render()
        # Each frame looks at one place of the pixels at least, and the one after the last settles
        for _ in range(len(SPREAD) + 1):
            if not all(view.settled for view in self.views):
                self._window.Render()
        done = self._refiner.wait(timeout)
        self._window.Render()
        return done

    def close(self) -> None:
        """Leave all to VTK again; joins the thread."""
        if self._timer is not None:
            interactor, tag, timer = self._timer
            interactor.RemoveObserver(tag)
            interactor.DestroyTimer(timer)
            self._timer = None
        self._window.RemoveObserver(self._tag)
        self._refiner.close()
        for view in self.views:
            view.close()

    def _tick(self) -> None:
        self.look_on()
        if self.waiting:
            self._window.Render()
