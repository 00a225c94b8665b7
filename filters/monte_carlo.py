"""Volume -> picture by Monte Carlo light transport."""

from __future__ import annotations

import dataclasses
from typing import Any

from vtkmodules.vtkCommonDataModel import vtkImageData

from vtkmcvr import checks
from vtkmcvr.picture import Picture
from vtkmcvr.plan import Plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Scene
from vtkmcvr.schedule import Progress
from vtkmcvr.vtk_scene import image_of_picture

from .parameters import Parameter, optional
from .scene_filter import SceneFilter


class MonteCarloFilter(SceneFilter):
    """Renders a volume by Monte Carlo light transport.

    Input: vtkImageData with one component. Output: vtkImageData of the film's size with the float32
    point arrays "radiance" (active; linear RGB premultiplied by alpha, and alpha), "depth" (world
    units, inf beside the volume) and "standard_error" (of RGB), and those named by `aovs`.

    Rays are traced when a value that matters has changed. A new clipping range or time stamp, or a
    light that moved along with the camera, hand out the picture that is there.

    Parameters
    ----------
    **settings
        Any parameter by name: `MonteCarloFilter(film_size=(800, 600), samples=64)`.
    """

    samples = Parameter(
        None, optional(lambda v: checks.whole("samples", v, least=1)),
        "Samples per pixel, >= 1. None: 64, or unlimited where `seconds` is set.",
    )  # fmt: skip
    seconds = Parameter(
        None, optional(lambda v: checks.number("seconds", v, above=0.0)),
        "Seconds to render, > 0, or None. Whichever of this and `samples` is met first ends it.",
    )  # fmt: skip
    seed = Parameter(
        0, lambda v: checks.whole("seed", v, least=0), "Same seed, same picture; >= 0."
    )
    threads = Parameter(
        None, optional(lambda v: checks.whole("threads", v, least=1)),
        "Threads, >= 1; changes no pixel. None: all CPUs that the process may use.",
    )  # fmt: skip

    def __init__(self, **settings: Any) -> None:
        self._picture: Picture | None = None
        self._key: tuple[Any, ...] = ()
        super().__init__(**settings)

    @property
    def picture(self) -> Picture | None:
        """The last picture, or None."""
        return self._picture

    @property
    def plan(self) -> Plan | None:
        """What the last picture simulated, with reasons, or None."""
        return None if self._picture is None else self._picture.plan

    def produce(self, image: vtkImageData) -> vtkImageData:
        """Return the picture of an image; the last one where no value has changed."""
        scene = self.scene(image)
        values = tuple(getattr(scene, field.name) for field in dataclasses.fields(scene))
        key = (values, self.samples, self.seconds, self.seed)
        picture = self._picture
        if picture is None or picture.stopped_by == "user" or key != self._key:
            picture = self._render(scene)
            self._picture, self._key = picture, key
        return image_of_picture(picture)

    def _render(self, scene: Scene) -> Picture:
        def progress(state: Progress) -> None:
            self.UpdateProgress(state.fraction)

        return render_scene(
            scene, samples=self.samples, seconds=self.seconds, seed=self.seed,
            threads=self.threads, progress=progress, abort=self._aborted,
        )  # fmt: skip

    def _aborted(self) -> bool:
        # Before VTK 9.3 there is only the flag
        if not hasattr(self, "CheckAbort"):
            return bool(self.GetAbortExecute())
        aborted = bool(self.CheckAbort())
        if aborted:
            # Else the pipeline throws the output away
            self.SetAbortOutput(False)
        return aborted
