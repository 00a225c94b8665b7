"""What makes a plotter render again when there is more to show."""

from __future__ import annotations

import asyncio
import weakref
from collections.abc import Callable
from typing import Any, cast

import pyvista as pv
from vtkmodules.vtkCommonCore import vtkCommand

from ..live import LiveWindow
from ..live.window import TICK


class Driver:
    """Drives a live window by the plotter's own event loop, or by that of asyncio in a server.

    Which of them there is shows only once the plotter renders.

    Parameters
    ----------
    plotter : pyvista.Plotter
    live : LiveWindow
    progressive : callable
        Whether pictures are refined from frame to frame.
    """

    def __init__(
        self, plotter: pv.Plotter, live: LiveWindow, progressive: Callable[[], bool]
    ) -> None:
        self._plotter, self._live, self._progressive = weakref.ref(plotter), live, progressive
        self._window = cast(Any, plotter.render_window)
        self._tag = self._window.AddObserver(vtkCommand.EndEvent, self._begin)
        self._task: asyncio.Task[None] | None = None

    def close(self) -> None:
        """Drive no more."""
        self._window.RemoveObserver(self._tag)
        if self._task is not None:
            self._task.cancel()
            self._task = None

    def _begin(self, *_: Any) -> None:
        plotter = self._plotter()
        if plotter is None or not self._progressive():
            return
        if not plotter.off_screen:
            if plotter.iren is not None and plotter.iren.initialized:
                self._live.start_timer(plotter.iren.interactor)
        elif self._task is None:
            try:
                self._task = asyncio.get_running_loop().create_task(self._run())
            except RuntimeError:
                # No loop: the caller renders as often as it likes
                return

    async def _run(self) -> None:
        while True:
            await asyncio.sleep(TICK / 1000)
            plotter = self._plotter()
            if plotter is None:
                return
            self._live.look_on()
            if self._live.waiting:
                # Unlike the window's own Render, this tells the pages that are served
                plotter.render()
