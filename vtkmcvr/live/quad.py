"""A picture drawn over what a renderer has drawn, as its last opaque prop."""

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
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
# The corners of the window, wherever the camera is
PLACE = "gl_Position = vec4(tcoord * 2.0 - 1.0, 0.0, 1.0);\n"
# After VTK's own texturing, which would multiply the colour
COLOUR = f"""
  vec4 seen = texture({TEXTURE}, tcoordVCVSOutput);
  if (seen.a <= 0.0) discard;
  gl_FragData[0] = seen;
"""


class PictureQuad:
    """Rectangle over the whole viewport, blended over opaque props and below translucent ones.

    Being the last of the opaque props it is right with multisampling, depth peeling, render passes,
    tiles and parallel projection. It leaves depth alone, is not pickable, and has no bounds.
    """

    def __init__(self) -> None:
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

    def show(self, pixels: NDArray[np.uint8]) -> None:
        """Show a picture, bytes (h, w, 4) of any size, straight alpha, row 0 on top."""
        rows, columns = pixels.shape[:2]
        image = vtkImageData()
        image.SetDimensions(columns, rows, 1)
        array = numpy_to_vtk(np.ascontiguousarray(pixels[::-1]).reshape(-1, 4), deep=True)
        array.SetName("rgba")
        image.GetPointData().SetScalars(array)
        self._texture.SetInputData(image)

    def smooth(self, on: bool) -> None:
        """Whether a picture of fewer pixels than the window is interpolated."""
        self._texture.SetInterpolate(on)

    def attach(self, renderer: vtkRenderer) -> None:
        """Draw in this renderer."""
        renderer.AddViewProp(self.actor)
        seen = weakref.ref(renderer)

        def keep_depth(*_: Any) -> None:
            owner = seen()
            window: Any = None if owner is None else owner.GetRenderWindow()
            if window is not None:
                window.GetState().vtkglDepthMask(0)

        # VTK sets the depth mask for each actor
        self._mapper_tag = self.actor.GetMapper().AddObserver(UPDATE_SHADER, keep_depth)

    def detach(self, renderer: vtkRenderer) -> None:
        """Draw no more."""
        renderer.RemoveViewProp(self.actor)
        if self._mapper_tag is not None:
            self.actor.GetMapper().RemoveObserver(self._mapper_tag)
            self._mapper_tag = None

    def come_last(self, renderer: vtkRenderer) -> None:
        """Stay the last prop, whatever has been added since."""
        if renderer.GetViewProps().GetLastProp() is not self.actor:
            renderer.RemoveViewProp(self.actor)
            renderer.AddViewProp(self.actor)


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
