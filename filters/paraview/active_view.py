"""What ParaView's active view shows; the server must be the built-in one, or pvbatch."""

from __future__ import annotations

from typing import Any

from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkCamera, vtkRenderer, vtkVolume, vtkVolumeProperty

from vtkmcvr.vtk_bridge.props import volumes_of


def renderer() -> vtkRenderer:
    """Renderer of the active view; a ValueError where there is none."""
    from paraview import simple

    view = simple.active_objects.view
    if view is None or not hasattr(view, "GetRenderer"):
        raise ValueError(
            "there is no active 3-D view in this process: choose a Look and a Camera that need "
            "none, or make a Render View active"
        )
    return view.GetRenderer()


def camera() -> vtkCamera:
    """Copy of the active view's camera, which the view may then move."""
    result = vtkCamera()
    result.DeepCopy(renderer().GetActiveCamera())
    return result


def look_of(image: vtkImageData) -> vtkVolumeProperty:
    """Copy of the look under which the active view shows an image as Volume.

    Raises
    ------
    ValueError
        Where it does not.
    """
    found = [volume for volume in volumes_of(renderer()) if _shows(volume, image)]
    if not found:
        raise ValueError(
            "the active view does not show the input as Volume: show it so, or choose a Look"
        )
    result = vtkVolumeProperty()
    result.DeepCopy(found[0].GetProperty())
    return result


def _shows(volume: vtkVolume, image: vtkImageData) -> bool:
    mapper: Any = volume.GetMapper()
    data = mapper.GetDataSetInput() if hasattr(mapper, "GetDataSetInput") else mapper.GetInput()
    if not isinstance(data, vtkImageData):
        return False
    return data.GetDimensions() == image.GetDimensions() and data.GetBounds() == image.GetBounds()
