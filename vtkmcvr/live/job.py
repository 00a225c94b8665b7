"""One picture in the making: a planned scene and its film, advanced step by step."""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass
from typing import Any

from .. import packed, schedule
from ..noiseless import render_noiseless
from ..pack import structure
from ..pictures.noiseless import NoiselessPicture
from ..pictures.picture import Display, Picture
from ..plan import Plan
from ..scene import Scene
from .settings import LiveSettings
from .shown import Edges, Shown, noiseless_picture_of
from .work import Look, on_device, work_of

# Longest time between two pictures to show
STEP_SECONDS = 0.5


# Structures of scenes whose kernels are in memory
_compiled: set[Any] = set()


def is_compiled(planned: Plan, settings: LiveSettings) -> bool:
    """Whether the kernels of a scene are in memory already."""
    return (on_device(planned, settings), structure(planned.packed)) in _compiled


@dataclass(frozen=True)
class Estimate:
    """A picture to show, and how good it is.

    Attributes
    ----------
    shown : Shown
    samples : int
        Samples per pixel; 0 where a sample stands for several.
    error : float
        Estimated NRMS; NaN where the technique is biased, inf where it is not known yet.
    done : bool
        Whether the target is reached.
    technique : str
        What it was made by, where it is biased.
    """

    shown: Shown
    samples: int
    error: float
    done: bool
    technique: str = ""

    @property
    def words(self) -> str:
        """What stands in the corner: "128 samples, error 1.8 %"."""
        if math.isnan(self.error):
            return self.technique
        if not self.samples:
            return "preview"
        known = f", error {100 * self.error:.2g} %" if math.isfinite(self.error) else ""
        return f"{self.samples} sample{'s' if self.samples != 1 else ''}{known}"


class Cancellable:
    """Something that another thread may tell to stop."""

    samples: int

    def __init__(self) -> None:
        self._cancelled = threading.Event()
        self.running = threading.Event()
        self.running.set()
        self.newest: Estimate | None = None
        self.stopped_by = ""

    def cancel(self) -> None:
        """Stop as soon as the tiles at work are finished."""
        self._cancelled.set()

    @property
    def cancelled(self) -> bool:
        """Whether it has been told to stop."""
        return self._cancelled.is_set()

    @property
    def done(self) -> bool:
        """Whether there is nothing left to do."""
        return bool(self.stopped_by)

    def finish(self) -> None:
        """Go on until the target is reached."""
        while not self.done and not self.cancelled:
            self.advance()

    def advance(self, most: int | None = None) -> None:
        """Make the next estimate."""
        raise NotImplementedError


class Job(Cancellable):
    """A picture that is refined until its target is reached or it is cancelled.

    Only one thread may call `advance`; any may cancel and look at `newest`.

    Parameters
    ----------
    scene : Plan
    settings : LiveSettings
    edges : Edges, optional
        Pixels at an edge of the scene's backdrop.
    """

    def __init__(
        self, scene: Plan, settings: LiveSettings, edges: Edges | None = None
    ) -> None:
        super().__init__()
        self.plan, self.settings, self.edges = scene, settings, edges
        self.exposure = settings.exposure_of(scene.scene)
        backdrop = scene.scene.backdrop
        self.veiled = None if backdrop is None else backdrop.veiled
        self.work = work_of(scene, settings)
        self.spent = 0.0

    @property
    def film(self) -> packed.Film:
        """Film so far."""
        return self.work.film

    @property
    def samples(self) -> int:  # type: ignore[override]
        """Samples per pixel so far."""
        return self.work.samples

    def advance(self, most: int | None = None) -> None:
        """Add samples for up to half a second, or up to `most` in all, and make an estimate."""
        goal = self._next(self.samples, most)
        rules = schedule.StopRules(
            goal, self._time_left(), self._aborted, self.settings.nrms, self.running
        )
        why, seconds = self.work.advance(rules)
        self.spent += seconds
        _compiled.add((on_device(self.plan, self.settings), structure(self.plan.packed)))
        if self.cancelled:
            return
        samples = self.samples
        if why != "samples" or samples == self.settings.most_samples:
            self.stopped_by = why
        shown = self.work.shown(Look(self.exposure, self.edges, self.veiled))
        self.newest = Estimate(shown, samples, self.work.error, self.done)

    def picture(self) -> Picture:
        """Return the picture so far; on the CPU it shares the film."""
        threads = self.settings.threads or schedule.default_threads()
        return Picture(
            self.film, self.plan, Display(self.exposure), self.spent,
            self.stopped_by or "user", self.settings.seed, threads,
            backend="cuda" if self.work.device_name else "cpu", device=self.work.device_name,
        )  # fmt: skip

    def _next(self, samples: int, most: int | None) -> int:
        """Twice the samples, as far as they take half a second."""
        goal = max(1, 2 * samples)
        if samples and self.spent > 0:
            goal = min(goal, samples + max(1, int(STEP_SECONDS * samples / self.spent)))
        for limit in (most, self.settings.most_samples):
            goal = goal if limit is None else min(goal, limit)
        return goal

    def _time_left(self) -> float | None:
        if self.settings.seconds is None:
            return None
        return max(self.settings.seconds - self.spent, 1e-3)

    def _aborted(self) -> bool:
        return self.cancelled


class NoiselessJob(Cancellable):
    """The same by a technique without noise: one pass, no samples.

    Parameters
    ----------
    scene : Scene
    settings : LiveSettings
    edges : Edges, optional
        Pixels at an edge of the scene's backdrop.
    """

    def __init__(
        self, scene: Scene, settings: LiveSettings, edges: Edges | None = None
    ) -> None:
        super().__init__()
        self.scene, self.settings, self.edges = scene, settings, edges
        self.samples = 0
        self._picture: NoiselessPicture | None = None

    def advance(self, most: int | None = None) -> None:
        """Render the picture."""
        own = self.settings
        picture = render_noiseless(
            own.technique, self.scene, own.occlusion or own.emission_absorption, own.exposure,
            own.exposure_of(self.scene), threads=own.threads, abort=lambda: self.cancelled,
            backend=own.backend,
        )  # fmt: skip
        if self.cancelled:
            return
        self.samples, self.stopped_by, self._picture = 1, "end", picture
        shown = noiseless_picture_of(picture, self.edges)
        self.newest = Estimate(shown, 1, math.nan, True, own.technique)

    def picture(self) -> NoiselessPicture:
        """Return the picture, once it is done."""
        if self._picture is None:
            raise RuntimeError("the picture is not done yet")
        return self._picture
