"""Depth and colour of what VTK draws around the volumes, at a few places of every pixel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkUnsignedCharArray
from vtkmodules.vtkRenderingCore import vtkCamera, vtkProp, vtkRenderer

from ..backdrop import Backdrop
from .film_place import Place

GL_MULTISAMPLE = 0x809D
CENTRE = ((0.5, 0.5),)
# The usual places of eight samples of a pixel (Direct3D 11, 3.4.4.1)
SPREAD = tuple(
    (0.5 + x / 16, 0.5 + y / 16)
    for x, y in ((1, -3), (-1, 3), (5, 1), (-3, -5), (-5, 5), (-7, -1), (3, 7), (7, -7))
)


class DepthPass:
    """A renderer that draws some props of another one into the same window, just to be read back.

    It runs in the other's StartEvent, before that clears its part of the frame buffer, and is in no
    window's collection.
    """

    def __init__(self) -> None:
        self._renderer = vtkRenderer()
        self._renderer.InteractiveOff()
        self._renderer.AutomaticLightCreationOff()

    def read(
        self, renderer: vtkRenderer, place: Place, props: Sequence[vtkProp], offsets: Any
    ) -> Backdrop:
        """Backdrop of some props, one layer for each of `offsets`, positions in the pixel."""
        layered = renderer.GetLayer() > 0 or renderer.GetPreserveColorBuffer()
        before = _colours(renderer, place) if layered else None
        self._prepare(renderer, props)
        layers = []
        try:
            for offset in offsets:
                layers.append(self._draw(renderer, place, offset, before))
        finally:
            self._renderer.RemoveAllViewProps()
            if before is not None:
                _put_back(renderer, place, before)
        depth, colour = (np.stack(parts) for parts in zip(*layers, strict=True))
        return Backdrop(depth, colour, np.array(offsets))

    def _prepare(self, renderer: vtkRenderer, props: Sequence[vtkProp]) -> None:
        own = self._renderer
        own.RemoveAllViewProps()
        for prop in props:
            own.AddViewProp(prop)
        own.SetRenderWindow(renderer.GetRenderWindow())
        own.SetViewport(renderer.GetViewport())
        own.SetLightCollection(renderer.GetLights())
        own.SetBackground(renderer.GetBackground())
        own.SetBackground2(renderer.GetBackground2())
        own.SetGradientBackground(renderer.GetGradientBackground())
        own.SetBackgroundAlpha(renderer.GetBackgroundAlpha())
        own.SetUseImageBasedLighting(renderer.GetUseImageBasedLighting())
        own.SetEnvironmentTexture(renderer.GetEnvironmentTexture())

    def _draw(
        self, renderer: vtkRenderer, place: Place, offset: Sequence[float], before: Any
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        camera = vtkCamera()
        camera.DeepCopy(renderer.GetActiveCamera())
        shift = np.array(camera.GetWindowCenter())
        # Film positions count from the top, window centres upward
        shift += 2 * (np.array(offset) - 0.5) * (1, -1) / (place.width, place.height)
        camera.SetWindowCenter(*shift)
        self._renderer.SetActiveCamera(camera)
        window: Any = renderer.GetRenderWindow()
        state = window.GetState()
        state.vtkglDisable(GL_MULTISAMPLE)
        try:
            self._renderer.Render()
        finally:
            state.vtkglEnable(GL_MULTISAMPLE)
        depth = _depth(renderer, place, camera)
        colour = _colours(renderer, place)
        if before is not None:
            nothing = np.isinf(depth)
            colour[nothing] = before[nothing]
        # Premultiplied; without multisampling there is no alpha between 0 and 1
        colour[..., :3] *= colour[..., 3:] > 0
        return depth, colour


def _depth(renderer: vtkRenderer, place: Place, camera: vtkCamera) -> NDArray[np.float32]:
    """Distance along the view axis, (H, W), row 0 on top; inf where nothing was drawn."""
    values = vtkFloatArray()
    x, y, width, height = place
    window = renderer.GetRenderWindow()
    window.GetZbufferData(x, y, x + width - 1, y + height - 1, values)
    buffer = vtk_to_numpy(values).reshape(height, width)[::-1]
    near, far = camera.GetClippingRange()
    depth = np.full(buffer.shape, np.inf, np.float32)
    # Props at the far end, such as a sky, are background
    there = buffer < 1.0
    z = buffer[there].astype(np.float64)
    if camera.GetParallelProjection():
        z = near + z * (far - near)
    else:
        z = near * far / (far - z * (far - near))
    depth[there] = np.maximum(z, 0.0)
    return depth


def _colours(renderer: vtkRenderer, place: Place) -> NDArray[np.uint8]:
    """Frame buffer, (H, W, 4), row 0 on top."""
    values = vtkUnsignedCharArray()
    x, y, width, height = place
    window: Any = renderer.GetRenderWindow()
    window.GetRGBACharPixelData(x, y, x + width - 1, y + height - 1, 0, values, 0)
    return vtk_to_numpy(values).reshape(height, width, 4)[::-1].copy()


def _put_back(renderer: vtkRenderer, place: Place, pixels: NDArray[np.uint8]) -> None:
    x, y, width, height = place
    values = numpy_to_vtk(np.ascontiguousarray(pixels[::-1]).reshape(-1, 4), deep=True)
    window: Any = renderer.GetRenderWindow()
    window.SetRGBACharPixelData(x, y, x + width - 1, y + height - 1, values, 0, 0, 0)


def together(parts: Sequence[Backdrop]) -> Backdrop:
    """Backdrop with the places of several ones."""
    return Backdrop(
        np.concatenate([part.depth for part in parts]),
        np.concatenate([part.colour for part in parts]),
        np.concatenate([part.offsets for part in parts]),
    )


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
