"""Base of filters that render a scene and keep the picture while no value has changed."""

from __future__ import annotations

import dataclasses
from typing import Any

from vtkmodules.vtkCommonDataModel import vtkImageData

from vtkmcvr import checks
from vtkmcvr.noiseless_picture import NoiselessPicture
from vtkmcvr.picture import Picture
from vtkmcvr.plan import Plan
from vtkmcvr.scene import Scene
from vtkmcvr.schedule import Progress
from vtkmcvr.vtk_scene import image_of_picture

from .parameters import Parameter, optional
from .scene_filter import SceneFilter


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

    def settings(self) -> tuple[Any, ...]:
        """Return what decides the picture beside the scene; implemented by subclasses."""
        raise NotImplementedError

    def produce(self, image: vtkImageData) -> vtkImageData:
        """Return the picture of an image; the last one where no value has changed."""
        scene = self.scene(image)
        values = tuple(getattr(scene, field.name) for field in dataclasses.fields(scene))
        key = (values, self.settings())
        picture = self._picture
        if picture is None or picture.stopped_by == "user" or key != self._key:
            picture = self.render(scene)
            self._picture, self._key = picture, key
        return image_of_picture(picture)

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
