"""A picture over the viewport of a renderer, as an opaque prop of its own."""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkCommand, vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkTexture

TEXTURE = "volumes"
UPDATE_SHADER = vtkCommand.UpdateShaderEvent
GL_BLEND = 0x0BE2
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
WHOLE = (0.0, 0.0, 1.0, 1.0)
# A part of the viewport, wherever the camera is
PLACE = "gl_Position = vec4(vertexMC.xy * 2.0 - 1.0, 0.0, 1.0);\n"
# After VTK's own texturing, which would multiply the colour
COLOUR = f"""
  vec4 seen = texture({TEXTURE}, tcoordVCVSOutput);
  if (seen.a <= 0.0) discard;
  gl_FragData[0] = seen;
"""


class Quad:
    """Rectangle in the viewport, over opaque props and below translucent ones.

    Among the opaque props it is right with multisampling, depth peeling, render passes, tiles and
    parallel projection. It leaves depth alone, is not pickable, and has no bounds.

    Parameters
    ----------
    blended : bool
        Whether pixels are blended over what is there; otherwise they take its place.
    """

    def __init__(self, blended: bool) -> None:
        self._blended = blended
        self.actor = vtkActor()
        self._texture = vtkTexture()
        self._texture.SetColorModeToDirectScalars()
        self._texture.MipmapOff()
        self._texture.RepeatOff()
        mapper = vtkPolyDataMapper()
        self._square = _square()
        self._part: tuple[float, ...] = WHOLE
        mapper.SetInputData(self._square)
        self.actor.SetMapper(mapper)
        self.actor.ForceOpaqueOn()
        self.actor.UseBoundsOff()
        self.actor.PickableOff()
        self.actor.GetProperty().LightingOff()
        self.actor.GetProperty().SetTexture(TEXTURE, self._texture)
        shaders = self.actor.GetShaderProperty()
        shaders.AddVertexShaderReplacement("//VTK::PositionVC::Impl", True, PLACE, False)
        shaders.AddFragmentShaderReplacement("//VTK::TCoord::Impl", True, COLOUR, False)
        shaders.AddFragmentShaderReplacement(
            "//VTK::Depth::Impl", True, "gl_FragDepth = 0.0;\n", False
        )
        self._mapper_tag: int | None = None
        self.show(np.zeros((1, 1, 4), np.uint8))
        self.actor.VisibilityOff()

    def show(
        self, pixels: NDArray[np.uint8], smooth: bool = False, part: Sequence[float] = WHOLE
    ) -> None:
        """Show a picture, bytes (h, w, 4) of any size, row 0 on top, where alpha is not 0.

        Parameters
        ----------
        pixels : array (h, w, 4)
            Straight alpha where it is blended.
        smooth : bool
            Whether a picture of fewer pixels than the window is interpolated.
        part : (left, bottom, right, top)
            Of the viewport, 0 to 1, that it covers.
        """
        self._cover(tuple(part))
        rows, columns = pixels.shape[:2]
        image = vtkImageData()
        image.SetDimensions(columns, rows, 1)
        array = numpy_to_vtk(np.ascontiguousarray(pixels[::-1]).reshape(-1, 4), deep=True)
        array.SetName("rgba")
        image.GetPointData().SetScalars(array)
        self._texture.SetInputData(image)
        self._texture.SetInterpolate(smooth)
        self.actor.VisibilityOn()

    def _cover(self, part: tuple[float, ...]) -> None:
        if part == self._part:
            return
        left, bottom, right, top = self._part = part
        points = self._square.GetPoints()
        for i, (u, v) in enumerate(CORNERS):
            points.SetPoint(i, left + u * (right - left), bottom + v * (top - bottom), 0)
        points.Modified()

    def attach(self, renderer: vtkRenderer) -> None:
        """Draw in this renderer."""
        renderer.AddViewProp(self.actor)
        seen = weakref.ref(renderer)

        def prepare(*_: Any) -> None:
            owner = seen()
            window: Any = None if owner is None else owner.GetRenderWindow()
            if window is not None:
                state = window.GetState()
                state.vtkglDepthMask(0)
                (state.vtkglEnable if self._blended else state.vtkglDisable)(GL_BLEND)

        # VTK sets the depth mask for each actor, and has blending on
        self._mapper_tag = self.actor.GetMapper().AddObserver(UPDATE_SHADER, prepare)

    def detach(self, renderer: vtkRenderer) -> None:
        """Draw no more."""
        renderer.RemoveViewProp(self.actor)
        if self._mapper_tag is not None:
            self.actor.GetMapper().RemoveObserver(self._mapper_tag)
            self._mapper_tag = None


def _square() -> vtkPolyData:
    points, places, cells = vtkPoints(), vtkFloatArray(), vtkCellArray()
    places.SetNumberOfComponents(2)
    places.SetName("TCoords")
    for u, v in CORNERS:
        points.InsertNextPoint(u, v, 0)
        places.InsertNextTuple2(u, v)
    cells.InsertNextCell(4, [0, 1, 2, 3])
    square = vtkPolyData()
    square.SetPoints(points)
    square.GetPointData().SetTCoords(places)
    square.SetPolys(cells)
    return square
