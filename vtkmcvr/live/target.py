"""A frame buffer beside that of the window, to draw into and read back at any time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonCore import VTK_FLOAT, VTK_UNSIGNED_CHAR
from vtkmodules.vtkRenderingCore import vtkRenderer
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLFramebufferObject

from .film_place import Place

DEPTH_BITS = 24

Pixels = tuple[NDArray[np.float32], NDArray[np.uint8]]


class Target:
    """Depth and colours of the size of a window, one sample a pixel."""

    def __init__(self) -> None:
        self._buffer: Any = None
        self._size: tuple[int, ...] = ()

    def draw(self, renderer: vtkRenderer, place: Place) -> Pixels:
        """Draw a renderer, and read what is at `place`.

        Returns
        -------
        depth : numpy.ndarray
            float32 (H, W), 0 to 1, row 0 on top; 1 where nothing was drawn.
        colour : numpy.ndarray
            uint8 (H, W, 4), row 0 on top.
        """
        window: Any = renderer.GetRenderWindow()
        window.MakeCurrent()
        state = window.GetState()
        state.PushFramebufferBindings()
        try:
            buffer = self._fitted(window)
            buffer.Bind()
            buffer.ActivateDrawBuffer(0)
            buffer.ActivateReadBuffer(0)
            renderer.Render()
            x, y, width, height = place
            extent = (x, x + width - 1, y, y + height - 1)
            depth = _downloaded(buffer.DownloadDepth(extent, VTK_FLOAT), VTK_FLOAT, (height, width))
            colour = _downloaded(
                buffer.DownloadColor4(extent, VTK_UNSIGNED_CHAR), VTK_UNSIGNED_CHAR,
                (height, width, 4),
            )  # fmt: skip
        finally:
            state.PopFramebufferBindings()
        return depth, colour

    def _fitted(self, window: Any) -> Any:
        """Buffer of the window's size, which may be left bound."""
        size = tuple(window.GetSize())
        if not self._fits(window, size):
            self._buffer, self._size = vtkOpenGLFramebufferObject(), size
            self._buffer.SetContext(window)
            if not self._buffer.PopulateFramebuffer(
                *size, True, 1, VTK_UNSIGNED_CHAR, True, DEPTH_BITS, 0
            ):
                raise RuntimeError(f"the graphics driver makes no frame buffer of {size} pixels")
        return self._buffer

    def _fits(self, window: Any, size: tuple[int, ...]) -> bool:
        buffer = self._buffer
        # A window that was closed has taken its resources along
        return (
            buffer is not None
            and buffer.GetContext() is window
            and bool(buffer.GetFBOIndex())
            and size == self._size
        )


def _downloaded(buffer: Any, kind: int, shape: tuple[int, ...]) -> NDArray:
    """Values in a pixel buffer, row 0 on top; frees it."""
    values = np.empty(shape, np.float32 if kind == VTK_FLOAT else np.uint8)
    height, width, parts = (*shape, 1)[:3]
    buffer.Download2D(kind, values, (width, height), parts, (0, 0))
    # The caller owns it, which Python's reference does not know
    while buffer.GetReferenceCount() > 1:
        buffer.UnRegister(None)
    return values[::-1].copy()
