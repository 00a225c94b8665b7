"""Volumes of one renderer, drawn by light transport instead of by VTK's mapper."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkRenderingCore import vtkProp, vtkRenderer

from ..backdrop import Backdrop
from ..plan import Plan, plan
from ..scene import Scene
from ..vtk_bridge.props import volumes_of
from .around import Around, around
from .corner import CornerText
from .film_place import Place, place_of
from .job import Estimate, Job, NoiselessJob, is_compiled
from .overlay import Overlay
from .preview import Preview
from .reading import SceneReader
from .refiner import Refiner
from .settings import LiveSettings
from .surroundings import Surroundings

# Longest time in one event for looking at the meshes, but for the first place of a pixel
LOOK_SECONDS = 0.02


class LiveView:
    """Draws the volumes of a renderer whenever it renders.

    Where nothing changes, the newest estimate is drawn. Where something has changed, the first
    estimate of the new picture is made within the frame, and the refiner goes on with it; or, in a
    window without events, the whole picture is.

    While the renderer draws, the volumes are hidden and the refiner rests; at all other times they
    are as the user left them.

    Parameters
    ----------
    renderer : vtkRenderer
    settings : LiveSettings
    refiner : Refiner
    progressive : callable
        Whether pictures are refined from frame to frame, asked for each frame.
    """

    def __init__(
        self,
        renderer: vtkRenderer,
        settings: LiveSettings,
        refiner: Refiner,
        progressive: Callable[[], bool],
    ) -> None:
        self.renderer, self.refiner, self.progressive = renderer, refiner, progressive
        self.settings = settings
        self.error: BaseException | None = None
        self.restarts = 0
        self.job: Job | NoiselessJob | None = None
        self.shown: Estimate | None = None
        self._reader, self._preview = SceneReader(), Preview()
        self._surroundings = Surroundings(renderer)
        self._quad, self._text = Overlay(), CornerText()
        self._key: tuple[Any, ...] | None = None
        self._plan: Plan | None = None
        self._settled, self._changed = True, False
        self._hidden: list[vtkProp] = []
        self._drawing = False
        self._said = ""
        self._quad.attach(renderer)
        self._text.attach(renderer)
        self._tags = [
            renderer.AddObserver(vtkCommand.StartEvent, self._start),
            renderer.AddObserver(vtkCommand.EndEvent, self._end),
        ]

    @property
    def waiting(self) -> bool:
        """Whether another frame would show more."""
        if self.job is None:
            return self._changed
        return self.job.newest is not None and self.job.newest is not self.shown

    @property
    def settled(self) -> bool:
        """Whether the picture is in the making, and needs no frame to go on."""
        return self._settled

    def look_on(self) -> None:
        """Do between two frames what the picture in the making wants done of VTK, for a while."""
        if self._settled:
            return
        volumes, place = volumes_of(self.renderer), place_of(self.renderer)
        with self._alone():
            props = self._around()
            self._changed = self._reader.key(self.renderer, place, volumes, props) != self._key
            if not self._changed:
                self._go_on(place, volumes, props)
                self._key = self._reader.key(self.renderer, place, volumes, props)
        self.refiner.go_on()

    def change(self, settings: LiveSettings) -> None:
        """Take other settings from the next frame on."""
        self.settings = settings
        self._key = None

    def check(self) -> None:
        """Raise what is wrong with the renderer's volumes."""
        volumes = volumes_of(self.renderer)
        if volumes:
            props = self._around()
            plan(self._scene((64, 64), volumes, props, None))

    def close(self) -> None:
        """Leave everything to VTK again."""
        self.refiner.drop(self)
        for tag in self._tags:
            self.renderer.RemoveObserver(tag)
        self._tags = []
        self._show_again()
        self._quad.detach(self.renderer)
        self._text.detach(self.renderer)

    # Frames

    def _start(self, *_: Any) -> None:
        if not self._drawing:
            with self._alone():
                self._frame()
                self.error = None

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Rest the refiner, and start nothing within; what goes wrong leaves the picture to VTK."""
        self._drawing = True
        self.refiner.pause()
        try:
            yield
        except Exception as error:
            self._fail(error)
        finally:
            self._drawing = False

    def _end(self, *_: Any) -> None:
        self._show_again()
        # A window finishes what renderers have begun, and says when it has
        if not self.renderer.GetRenderWindow().CheckInRenderStatus():
            self.refiner.go_on()

    def _frame(self) -> None:
        volumes, place = volumes_of(self.renderer), place_of(self.renderer)
        self._quad.come_last(self.renderer)
        if not volumes or place.empty:
            self._rest()
            return
        props = self._around()
        if self._reader.key(self.renderer, place, volumes, props) != self._key:
            self._restart(place, volumes, props)
        elif not self._settled:
            self._go_on(place, volumes, props)
        # Reading a scene may create functions that were never set, and drawing some props elsewhere
        # counts as a change of theirs
        self._key = self._reader.key(self.renderer, place, volumes, props)
        self._swap()
        self._hide([*volumes, *props.hidden])

    def _go_on(self, place: Place, volumes: Any, props: Around) -> None:
        """Look at more places; once there are none left, make the picture."""
        if not self._surroundings.look_on(props, LOOK_SECONDS):
            self._settle(place, volumes, props)

    def _restart(self, place: Place, volumes: Any, props: Around) -> None:
        """Begin a new picture."""
        self.restarts += 1
        self.refiner.drop(self)
        self.job, self.shown, self._changed = None, None, False
        self._surroundings.begin(place, props)
        self._quad.hide()
        self._say_limits(props)
        if not self.progressive():
            self._surroundings.look_on(props, math.inf)
            self._settle(place, volumes, props)
            return
        backdrop = self._surroundings.centre(props)
        planned = self._planned(self._scene(place[2:], volumes, props, backdrop))
        self._settled = False
        if self.settings.noiseless or is_compiled(planned, self.settings):
            self._show(self._preview.estimate(planned, self.settings))
        else:
            # Until the kernels are there the picture is VTK's own
            self._text.say("compiling")

    def _settle(self, place: Place, volumes: Any, props: Around) -> None:
        """Make the picture in full, here or in the background."""
        backdrop = self._surroundings.together()
        scene = self._scene(place[2:], volumes, props, backdrop)
        edges = self._surroundings.edges(backdrop)
        if self.settings.noiseless:
            self.job = NoiselessJob(scene, self.settings, edges)
        else:
            self.job = Job(self._planned(scene), self.settings, edges)
        self._settled = True
        if self.progressive():
            self.refiner.put(self, self.job)
        else:
            self.job.finish()

    def _planned(self, scene: Scene) -> Plan:
        self._plan = plan(scene, self._plan)
        return self._plan

    def _swap(self) -> None:
        """Show the newest estimate."""
        if self.job is None:
            return
        if not self.progressive() and not self.job.done:
            self.refiner.go_on()
            self.refiner.wait()
        self.refiner.reraise()
        newest = self.job.newest
        if newest is not None and newest is not self.shown:
            self._show(newest)

    def _show(self, estimate: Estimate) -> None:
        self.shown = estimate
        self._quad.show(estimate.shown, smooth=estimate.samples == 0)
        wanted = self.settings.text
        self._text.say(estimate.words if (self.progressive() if wanted is None else wanted) else "")

    # Parts of a frame

    def _around(self) -> Around:
        return around(self.renderer, self.settings.meshes == "traced", self._quad.actors)

    def _say_limits(self, props: Around) -> None:
        """Warn of what is not drawn as it should be, once."""
        if props.limits and props.limits != self._said:
            warnings.warn(props.limits, RuntimeWarning, stacklevel=2)
        self._said = props.limits

    def _scene(self, size: Any, volumes: Any, props: Around, backdrop: Backdrop | None) -> Scene:
        return self._reader.scene(
            self.renderer, tuple(size), volumes, props.traced, backdrop, self.settings
        )

    def _hide(self, props: list[vtkProp]) -> None:
        if self.shown is None:
            return
        self._hidden = props
        for prop in props:
            prop.VisibilityOff()

    def _show_again(self) -> None:
        for prop in self._hidden:
            prop.VisibilityOn()
        self._hidden = []

    def _rest(self) -> None:
        """Draw nothing: there is no volume."""
        self.refiner.drop(self)
        self.job = self.shown = self._key = None
        self._settled, self._changed = True, False
        self._quad.hide()
        self._text.say("")

    def _fail(self, error: BaseException) -> None:
        """Leave this picture to VTK, and say why once."""
        first = repr(error) != repr(self.error)
        self._rest()
        self.error = error
        if first:
            warnings.warn(f"volumes are drawn by VTK: {error}", RuntimeWarning, stacklevel=2)
