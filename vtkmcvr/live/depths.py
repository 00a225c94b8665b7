"""Depth and colour of what VTK draws around the volumes, at a place of every pixel."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkRenderingCore import vtkActor, vtkCamera, vtkProp, vtkRenderer

from ..backdrop import Backdrop, Veils
from .film_place import Place
from .peeling import Peeler
from .target import Target


class DepthPass:
    """A renderer that draws some props of another one beside the window, just to be read back.

    It is in no window's collection, and may draw between two frames.
    """

    def __init__(self) -> None:
        self._target = Target()
        self._renderer = vtkRenderer()
        self._renderer.InteractiveOff()
        self._renderer.AutomaticLightCreationOff()
        self._peeler = Peeler()

    def read(
        self,
        renderer: vtkRenderer,
        place: Place,
        props: Sequence[vtkProp],
        offset: Sequence[float],
        veils: Sequence[vtkActor] = (),
        below: NDArray[np.uint8] | None = None,
    ) -> Backdrop:
        """Backdrop at `offset`, a position in the pixel.

        Parameters
        ----------
        renderer : vtkRenderer
        place : Place
        props : sequence of vtkProp
            Opaque.
        offset : (x, y)
            From the pixel's upper left corner, 0 to 1.
        veils : sequence of vtkActor
            Translucent meshes.
        below : array (H, W, 4), optional
            What `colours_below` has found.
        """
        self._peeler.follow(veils)
        self._prepare(renderer)
        try:
            return self._look(renderer, place, props, offset, below, bool(veils))
        finally:
            self._renderer.RemoveAllViewProps()

    def background(self, renderer: vtkRenderer, place: Place) -> NDArray[np.uint8]:
        """Colours, (H, W, 4), row 0 on top, of a renderer that draws nothing else."""
        self._prepare(renderer)
        self._renderer.SetActiveCamera(renderer.GetActiveCamera())
        return self._target.draw(self._renderer, place)[1]

    def _prepare(self, renderer: vtkRenderer) -> None:
        own, window = self._renderer, renderer.GetRenderWindow()
        own.SetRenderWindow(window)
        own.SetViewport(renderer.GetViewport())
        own.SetLightCollection(renderer.GetLights())
        own.SetBackground(renderer.GetBackground())
        own.SetBackground2(renderer.GetBackground2())
        own.SetGradientBackground(renderer.GetGradientBackground())
        # A window without alpha shows its background as it is
        own.SetBackgroundAlpha(renderer.GetBackgroundAlpha() if window.GetAlphaBitPlanes() else 1.0)
        own.SetUseImageBasedLighting(renderer.GetUseImageBasedLighting())
        own.SetEnvironmentTexture(renderer.GetEnvironmentTexture())

    def _look(
        self,
        renderer: vtkRenderer,
        place: Place,
        props: Sequence[vtkProp],
        offset: Sequence[float],
        below: NDArray[np.uint8] | None,
        veiled: bool,
    ) -> Backdrop:
        """Backdrop at one position in the pixel."""
        own, camera = self._renderer, _shifted(renderer.GetActiveCamera(), place, offset)
        own.SetActiveCamera(camera)
        own.RemoveAllViewProps()
        for prop in props:
            own.AddViewProp(prop)
        buffer, colour = self._target.draw(own, place)
        # Props at the far end, such as a sky, are background
        if below is not None:
            colour[buffer >= 1] = below[buffer >= 1]
        # Premultiplied; without multisampling there is no alpha between 0 and 1
        colour[colour[..., 3] == 0] = 0
        veils = self._veils(place, camera, buffer) if veiled else None
        depth = _distance(buffer, camera)
        return Backdrop(depth[None], colour[None], np.array([offset]), veils)

    def _veils(self, place: Place, camera: vtkCamera, opaque: NDArray[np.float32]) -> Veils:
        """Translucent surfaces before what has been drawn."""
        self._renderer.RemoveAllViewProps()
        draw = partial(self._target.draw, self._renderer, place)
        found = [
            (_distance(buffer, camera), colour)
            for buffer, colour in self._peeler.layers(self._renderer, place, opaque, draw)
        ]
        if not found:
            nothing = np.zeros(0, np.float32), np.zeros((0, 4), np.uint8)
            return Veils(np.zeros(opaque.size + 1, np.int64), *nothing)
        depth, colour = (np.stack(parts)[:, None] for parts in zip(*found, strict=True))
        return Veils.of_layers(depth, colour)


def _shifted(camera: vtkCamera, place: Place, offset: Sequence[float]) -> vtkCamera:
    """Camera whose pixel centres are at a position in the pixel."""
    shifted = vtkCamera()
    shifted.DeepCopy(camera)
    # Film positions count from the top, window centres upward
    shift = 2 * (np.array(offset) - 0.5) * (1, -1) / (place.width, place.height)
    shifted.SetWindowCenter(*(np.array(camera.GetWindowCenter()) + shift))
    return shifted


def _distance(buffer: NDArray[np.float32], camera: vtkCamera) -> NDArray[np.float32]:
    """Distance along the view axis; inf where nothing was drawn."""
    near, far = camera.GetClippingRange()
    depth = np.full(buffer.shape, np.inf, np.float32)
    there = buffer < 1.0
    z = buffer[there].astype(np.float64)
    if camera.GetParallelProjection():
        z = near + z * (far - near)
    else:
        z = near * far / (far - z * (far - near))
    depth[there] = np.maximum(z, 0.0)
    return depth


def colours_below(renderer: vtkRenderer, place: Place) -> NDArray[np.uint8] | None:
    """Colours, (H, W, 4), row 0 on top, over which a renderer is about to draw.

    None where it clears them. To be asked for in its StartEvent.
    """
    if renderer.GetLayer() == 0 and not renderer.GetPreserveColorBuffer():
        return None
    values = vtkUnsignedCharArray()
    x, y, width, height = place
    window: Any = renderer.GetRenderWindow()
    window.GetRGBACharPixelData(x, y, x + width - 1, y + height - 1, 0, values, 0)
    return vtk_to_numpy(values).reshape(height, width, 4)[::-1].copy()
