"""Volume -> picture by Monte Carlo light transport."""

from __future__ import annotations

from typing import Any

from vtkmcvr import backends, checks
from vtkmcvr.picture import Picture
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Scene

from .parameters import Parameter, optional
from .picture_filter import PictureFilter


class MonteCarloFilter(PictureFilter):
    """Renders a volume by Monte Carlo light transport.

    Input: vtkImageData with one component. Output: vtkImageData of the film's size with the float32
    point arrays "radiance" (active; linear RGB premultiplied by alpha, and alpha), "depth" (world
    units, inf beside the volume) and "standard_error" (of RGB), and those named by `aovs`.

    Rays are traced when a value that matters has changed.

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
    backend = Parameter(
        "auto", backends.checked,
        '"auto": a CUDA device where there is one, else the CPU; "cpu"; "cuda".',
    )  # fmt: skip

    def settings(self) -> tuple[Any, ...]:
        """Return what decides the picture beside the scene."""
        return self.samples, self.seconds, self.seed, self.backend

    def render(self, scene: Scene) -> Picture:
        """Return the picture of a scene."""
        return render_scene(
            scene, samples=self.samples, seconds=self.seconds, seed=self.seed,
            threads=self.threads, backend=self.backend, progress=self.report, abort=self.aborted,
        )  # fmt: skip
