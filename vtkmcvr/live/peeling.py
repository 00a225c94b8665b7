"""Translucent meshes, layer by layer: what VTK draws of them behind what it has drawn before.

Depth peeling (Everitt, "Interactive order-independent transparency", NVIDIA 2001), read back.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.misc import calldata_type
from vtkmodules.vtkCommonCore import VTK_FLOAT, VTK_OBJECT, vtkCommand
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer
from vtkmodules.vtkRenderingOpenGL2 import vtkTextureObject

from ..vtk_bridge.props import identity
from .around import actor_key
from .film_place import Place
from .target import Pixels

UPDATE_SHADER = vtkCommand.UpdateShaderEvent
GL_BLEND = 0x0BE2
MOST_LAYERS = 16
# Steps of a depth buffer of 24 bits within which a fragment is the one drawn before
SAME = 3e-7
DECLARED = "//VTK::Color::Dec\nuniform sampler2D peeled;\nuniform ivec2 corner;\n"
DISCARDED = f"""
  if (gl_FragCoord.z <= texelFetch(peeled, ivec2(gl_FragCoord.xy) - corner, 0).r + {SAME}) discard;
//VTK::Color::Impl
"""


class Proxy:
    """Stands for an actor, whose own mapper and shaders are left alone."""

    def __init__(self, actor: vtkActor, bind: Callable[[Any], None]) -> None:
        self.actor, self._mapper, self._original = vtkActor(), vtkPolyDataMapper(), actor
        self._surface: vtkDataSetSurfaceFilter | None = None
        self._key: tuple[Any, ...] | None = None
        shaders = actor.GetShaderProperty().NewInstance()
        shaders.DeepCopy(actor.GetShaderProperty())
        shaders.AddFragmentShaderReplacement("//VTK::Color::Dec", True, DECLARED, False)
        shaders.AddFragmentShaderReplacement("//VTK::Color::Impl", True, DISCARDED, False)
        self._shaders = shaders

        @calldata_type(VTK_OBJECT)
        def update(_: Any, __: str, program: Any) -> None:
            bind(program)

        self._mapper.AddObserver(UPDATE_SHADER, update)

    def follow(self) -> None:
        """Take over what has changed of the actor."""
        key = actor_key(self._original)
        if key == self._key:
            return
        self._key = key
        self.actor.ShallowCopy(self._original)
        self.actor.SetShaderProperty(self._shaders)
        self.actor.ForceOpaqueOn()
        self.actor.VisibilityOn()
        mapper: Any = self._original.GetMapper()
        self._mapper.ShallowCopy(mapper)
        source = mapper.GetInputConnection(0, 0)
        if not mapper.GetInput().IsA("vtkPolyData"):
            self._surface = self._surface or vtkDataSetSurfaceFilter()
            self._surface.SetInputConnection(source)
            source = self._surface.GetOutputPort()
        self._mapper.SetInputConnection(source)
        self.actor.SetMapper(self._mapper)


class Peeler:
    """Reads the layers of translucent actors one after another, nearest first."""

    def __init__(self) -> None:
        self._known: dict[str, Proxy] = {}
        self._texture: Any = None
        self._corner = (0, 0)

    def follow(self, actors: Iterable[vtkActor]) -> None:
        """Stand for these actors as they are now; forget others."""
        self._known = {
            identity(actor): self._known.get(identity(actor)) or Proxy(actor, self._bind)
            for actor in actors
        }
        for proxy in self._known.values():
            proxy.follow()

    def layers(
        self,
        renderer: vtkRenderer,
        place: Place,
        opaque: NDArray[np.float32],
        draw: Callable[[], Pixels],
    ) -> Iterable[Pixels]:
        """Depth in the buffer, (H, W), 1 where nothing is, and colour, (H, W, 4), of each layer.

        Parameters
        ----------
        renderer : vtkRenderer
            Draws the proxies alone.
        place : Place
        opaque : array (H, W)
            Depth in the buffer of what hides them.
        draw : callable
            Renders, and reads depths and colours back.
        """
        window: Any = renderer.GetRenderWindow()
        self._corner = (place.x, place.y)
        done = np.where(opaque <= 0, np.float32(2), np.float32(-1))
        for proxy in self._known.values():
            renderer.AddViewProp(proxy.actor)
        state = window.GetState()
        state.vtkglDisable(GL_BLEND)
        self._texture = vtkTextureObject()
        self._texture.SetContext(window)
        try:
            for _ in range(MOST_LAYERS):
                depth, colour = self._next(place, done, draw)
                there = depth < opaque
                if not there.any():
                    return
                yield np.where(there, depth, np.float32(1)), colour
                done = np.where(there, depth, np.float32(2))
            warnings.warn(
                f"more than {MOST_LAYERS} translucent surfaces lie behind each other: those "
                "farther away are not drawn", RuntimeWarning, stacklevel=2,
            )  # fmt: skip
        finally:
            self._texture.ReleaseGraphicsResources(window)
            self._texture = None
            state.vtkglEnable(GL_BLEND)

    def _next(self, place: Place, done: NDArray[np.float32], draw: Callable[[], Pixels]) -> Pixels:
        texture = self._texture
        bottom_up = np.ascontiguousarray(done[::-1], np.float32)
        texture.Create2DFromRaw(place.width, place.height, 1, VTK_FLOAT, bottom_up)
        texture.Activate()
        try:
            return draw()
        finally:
            texture.Deactivate()

    def _bind(self, program: Any) -> None:
        """Set what the fragment shader of a proxy reads."""
        if self._texture is not None:
            program.SetUniformi("peeled", self._texture.GetTextureUnit())
            program.SetUniform2i("corner", self._corner)
