"""Algorithm that ParaView shows: a filter of this package with the look and view of ParaView's."""

from __future__ import annotations

import weakref
from typing import Any

from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData, vtkTable
from vtkmodules.vtkRenderingCore import vtkCamera, vtkVolumeProperty

from vtkmcvr.presets import look_named
from vtkmcvr.studio import Studio, view_camera
from vtkmcvr.vtk_bridge.look import property_of_look
from vtkmcvr.vtk_bridge.scene import volume_of

from ..tone_map import RGBA_COMPONENTS, ToneMapFilter
from . import active_view
from .panels import CAMERAS, LIGHTS, VIEW

RGBA = "rgba"


class ViewPicture(VTKPythonAlgorithmBase):
    """Volume -> picture and its statistics; a subclass names the filter that renders.

    What it takes of a view is read when the picture is made. A failure is an error of ParaView's
    output window and an empty picture.
    """

    technique: Any

    def __init__(self) -> None:
        super().__init__(1, "vtkImageData", 2, "vtkImageData")
        self.filter = self.technique(film_size=(400, 300), colours="display")
        self._tone = ToneMapFilter(background=None)
        self._tone.SetInputConnection(self.filter.GetOutputPort())
        self._look, self._camera, self._lights = VIEW, CAMERAS[0], LIGHTS[0]
        self._exposure = 0.0
        self._view = vtkCamera()
        self._image = vtkImageData()
        self._time: tuple[Any, ...] = ()
        self._taken: tuple[Any, ...] = ()
        me = weakref.ref(self)
        self.filter.aborted = lambda: me().GetAbortExecute()  # type: ignore[union-attr]
        self.filter.AddObserver("ProgressEvent", lambda caller, _: _progress(me(), caller))

    def change(self, **settings: Any) -> None:
        """Set parameters of the filter."""
        for name, value in settings.items():
            setattr(self.filter, name, value)
        self.Modified()

    # Properties of the panel

    def SetFilmSize(self, width: int, height: int) -> None:
        """Set the size of the picture in pixels."""
        self.change(film_size=(width, height))

    def SetThreads(self, threads: int) -> None:
        """Set the number of threads; 0: all CPUs."""
        self.change(threads=threads or None)

    def SetGradientFactor(self, share: float) -> None:
        """Set how much of a shaded volume is surfaces."""
        self.change(gradient_factor=share)

    def SetExposure(self, stops: float) -> None:
        """Set the brightness; no ray is traced."""
        self._exposure = stops
        self.Modified()

    def SetLook(self, name: str) -> None:
        """Set where opacity and colour come from."""
        self._look = name
        self.TakeFromView()

    def SetCamera(self, index: int) -> None:
        """Set where the camera comes from."""
        self._camera = CAMERAS[index]
        self.TakeFromView()

    def SetLights(self, index: int) -> None:
        """Set where the lights come from."""
        self._lights = LIGHTS[index]
        self.TakeFromView()

    def SetCameraPosition(self, *position: float) -> None:
        """Set where the camera is."""
        self._view.SetPosition(position)
        self.Modified()

    def SetCameraFocalPoint(self, *point: float) -> None:
        """Set what the camera looks at."""
        self._view.SetFocalPoint(point)
        self.Modified()

    def SetCameraViewUp(self, *direction: float) -> None:
        """Set what is up."""
        self._view.SetViewUp(direction)
        self.Modified()

    def SetCameraViewAngle(self, degrees: float) -> None:
        """Set the vertical view angle."""
        self._view.SetViewAngle(degrees)
        self.Modified()

    def TakeFromView(self) -> None:
        """Take anew what comes from the active view."""
        self._taken = ()
        self.Modified()

    # Requests of the pipeline

    def FillOutputPortInformation(self, port: int, info: Any) -> int:
        """Say that there are a picture and a table."""
        info.Set(vtkDataObject.DATA_TYPE_NAME(), "vtkTable" if port else "vtkImageData")
        return 1

    def RequestInformation(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Announce the film."""
        self.filter.RequestInformation(request, inputs, outputs)
        info = outputs.GetInformationObject(0)
        vtkDataObject.SetPointDataActiveScalarInfo(info, VTK_UNSIGNED_CHAR, RGBA_COMPONENTS)
        return 1

    def RequestUpdateExtent(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Ask for the whole volume."""
        return self.filter.RequestUpdateExtent(request, inputs, outputs)

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Make the picture."""
        try:
            self._prepare(vtkImageData.GetData(inputs[0], 0))
            self._tone.Update()
        except (ValueError, TypeError) as failure:
            vtkOutputWindow.GetInstance().DisplayErrorText(f"{type(self).__name__}: {failure}\n")
            return 0
        picture = vtkImageData.GetData(outputs, 0)
        picture.ShallowCopy(self.filter.GetOutputDataObject(0))
        shown = self._tone.GetOutputDataObject(0).GetPointData().GetArray(RGBA)
        picture.GetPointData().AddArray(shown)
        picture.GetPointData().SetActiveScalars(RGBA)
        vtkTable.GetData(outputs, 1).ShallowCopy(self.filter.GetOutputDataObject(1))
        return 1

    def _prepare(self, image: vtkImageData) -> None:
        """Bring the filter up to date with input, look and view."""
        time = (image.GetMTime(), image.GetUpdateTime())
        if time != self._time:
            self._image.ShallowCopy(image)
            self._time, self._taken = time, ()
            self.filter.SetInputDataObject(0, self._image)
        width, height = self.filter.film_size
        taken = (self._scalars(), width / height)
        if self._taken != taken:
            self._take(width / height)
            self._taken = taken
        if self._camera == CAMERAS[1]:
            self.filter.camera = self._view
        preset = self._look != VIEW
        self._tone.exposure = self._exposure + (look_named(self._look).exposure if preset else 0.0)

    def _scalars(self) -> str | None:
        """Let the filter take the array chosen; the active one where it was chosen for others."""
        info = self.GetInputArrayInformation(0)
        name = info.Get(vtkDataObject.FIELD_NAME()) if info else None
        present = name is not None and self._image.GetPointData().HasArray(name)
        self.filter.scalars = name if present else None
        return self.filter.scalars

    def _take(self, aspect: float) -> None:
        """Set look, camera and lights of the filter, from presets or from the view."""
        own: vtkVolumeProperty
        if self._look == VIEW:
            own, studio = active_view.look_of(self._image), Studio()
        else:
            if self.filter.scalars is not None:
                self._image.GetPointData().SetActiveScalars(self.filter.scalars)
            own, studio = property_of_look(self._look, self._image), look_named(self._look).studio
        self.filter.volume_property = own
        if self._camera == CAMERAS[0]:
            self.filter.camera = active_view.camera()
        elif self._camera == CAMERAS[2]:
            volume = volume_of(self._image, scalars=self.filter.scalars)
            self.filter.camera = view_camera(volume, aspect=aspect)
        from_view = self._lights == LIGHTS[1]
        self.filter.renderer = active_view.renderer() if from_view else None
        self.filter.studio = None if from_view else studio


def _progress(mine: Any, caller: Any) -> None:
    if mine is not None:
        mine.UpdateProgress(caller.GetProgress())
