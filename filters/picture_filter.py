"""Base of filters that render a scene and keep the picture while no value has changed."""

from __future__ import annotations

from typing import Any

from vtkmodules.vtkCommonDataModel import vtkImageData, vtkTable

from vtkmcvr import checks
from vtkmcvr.pictures.noiseless import NoiselessPicture
from vtkmcvr.pictures.picture import Picture
from vtkmcvr.plan import Plan
from vtkmcvr.scene import Scene
from vtkmcvr.schedule import Progress
from vtkmcvr.vtk_bridge.scene import image_of_picture

from .parameters import Parameter, optional
from .scene_filter import SceneFilter
from .scene_inputs import inputs_of
from .scene_values import value_of
from .statistics import table_of_picture


class PictureFilter(SceneFilter):
    """Volume -> picture; a subclass implements `render` and `settings`.

    A new clipping range or time stamp, or a light that moved along with the camera, hand out the
    picture that is there.

    Parameters
    ----------
    **settings
        Parameters by name.
    """

    threads = Parameter(
        None, optional(lambda v: checks.whole("threads", v, least=1)),
        "Threads, >= 1; changes no pixel. None: all CPUs that the process may use.",
    )  # fmt: skip

    def __init__(self, **settings: Any) -> None:
        self._picture: Picture | NoiselessPicture | None = None
        self._key: tuple[Any, ...] = ()
        super().__init__(**settings)

    @property
    def picture(self) -> Picture | NoiselessPicture | None:
        """The last picture, or None."""
        return self._picture

    @property
    def plan(self) -> Plan | None:
        """What the last picture simulated, with reasons, or None."""
        return None if self._picture is None else self._picture.plan

    def render(self, scene: Scene) -> Picture | NoiselessPicture:
        """Return the picture of a scene; implemented by subclasses."""
        raise NotImplementedError

    def refined(self, picture: Any) -> Picture | NoiselessPicture | None:
        """Return a picture of the same scene made better; None where it has to be made anew.

        Called where the scene is unchanged, and `settings` are not or the picture was aborted. The
        result is what `render` would make.
        """
        return None

    def settings(self) -> tuple[Any, ...]:
        """Return what decides the picture beside the scene; implemented by subclasses."""
        raise NotImplementedError

    def execute(self, inputs: Any, outputs: Any) -> None:
        """Hand out the picture and what is known of it; the last one where no value changed."""
        picture = self._up_to_date(self.scene_of_inputs(inputs_of(inputs)))
        vtkImageData.GetData(outputs, 0).ShallowCopy(image_of_picture(picture))
        vtkTable.GetData(outputs, 1).ShallowCopy(table_of_picture(picture))

    def _up_to_date(self, scene: Scene) -> Picture | NoiselessPicture:
        key = (value_of(scene), self.settings())
        picture = self._picture
        if picture is not None and picture.stopped_by != "user" and key == self._key:
            return picture
        better = None
        if picture is not None and key[0] == self._key[0]:
            better = self.refined(picture)
        self._picture, self._key = better or self.render(scene), key
        return self._picture

    def report(self, state: Progress) -> None:
        """Tell VTK how far the picture is."""
        self.UpdateProgress(state.fraction)

    def aborted(self) -> bool:
        """Whether VTK wants the picture to end as it is."""
        # Before VTK 9.3 there is only the flag
        if not hasattr(self, "CheckAbort"):
            return bool(self.GetAbortExecute())
        aborted = bool(self.CheckAbort())
        if aborted:
            # Else the pipeline throws the output away
            self.SetAbortOutput(False)
        return aborted
