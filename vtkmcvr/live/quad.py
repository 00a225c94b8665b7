"""A picture over the whole viewport of a renderer, as an opaque prop of its own."""

from __future__ import annotations

import weakref
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
# The corners of the window, wherever the camera is
PLACE = "gl_Position = vec4(tcoord * 2.0 - 1.0, 0.0, 1.0);\n"
# After VTK's own texturing, which would multiply the colour
COLOUR = f"""
  vec4 seen = texture({TEXTURE}, tcoordVCVSOutput);
  if (seen.a <= 0.0) discard;
  gl_FragData[0] = seen;
"""


class Quad:
    """Rectangle over the whole viewport, over opaque props and below translucent ones.

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
        mapper.SetInputData(_square())
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

    def show(self, pixels: NDArray[np.uint8], smooth: bool = False) -> None:
        """Show a picture, bytes (h, w, 4) of any size, row 0 on top, where alpha is not 0.

        Parameters
        ----------
        pixels : array (h, w, 4)
            Straight alpha where it is blended.
        smooth : bool
            Whether a picture of fewer pixels than the window is interpolated.
        """
        rows, columns = pixels.shape[:2]
        image = vtkImageData()
        image.SetDimensions(columns, rows, 1)
        array = numpy_to_vtk(np.ascontiguousarray(pixels[::-1]).reshape(-1, 4), deep=True)
        array.SetName("rgba")
        image.GetPointData().SetScalars(array)
        self._texture.SetInputData(image)
        self._texture.SetInterpolate(smooth)
        self.actor.VisibilityOn()

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
