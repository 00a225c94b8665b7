"""Volume -> picture by Monte Carlo light transport."""

from __future__ import annotations

import dataclasses
from typing import Any, get_args

from vtkmcvr import backends, checks
from vtkmcvr.phases import Phase
from vtkmcvr.pictures.picture import Picture
from vtkmcvr.rendering import DEFAULT_SAMPLES, render_scene
from vtkmcvr.scene import ESTIMATORS, Scene, Surface

from .parameters import Parameter, one_of, optional
from .picture_filter import PictureFilter
from .scene_inputs import Inputs


class MonteCarloFilter(PictureFilter):
    """Renders a volume by Monte Carlo light transport.

    Inputs: volumes as in `SceneFilter`. Output 0: vtkImageData of the film's size with the float32
    point arrays "radiance" (active; linear RGB premultiplied by alpha, and alpha), "depth" (world
    units, inf beside the volume) and "standard_error" (of RGB), and those named by `aovs`. Output
    1: a vtkTable of what is known of the picture, see `statistics.table_of_picture`.

    Rays are traced when a value that matters has changed; more `samples` go on from those that the
    picture has.

    Parameters
    ----------
    **settings
        Any parameter by name: `MonteCarloFilter(film_size=(800, 600), samples=64)`.
    """

    samples = Parameter(
        None, optional(lambda v: checks.whole("samples", v, least=1)),
        "Samples per pixel, >= 1. None: 64, or unlimited where `seconds` or `nrms` is set.",
    )  # fmt: skip
    seconds = Parameter(
        None, optional(lambda v: checks.number("seconds", v, above=0.0)),
        "Seconds to render, > 0, or None. Whichever of this and `samples` is met first ends it.",
    )  # fmt: skip
    nrms = Parameter(
        None, optional(lambda v: checks.number("nrms", v, above=0.0)),
        "Error to reach, such as 0.02, with 95 % confidence, or None.",
    )  # fmt: skip
    seed = Parameter(
        0, lambda v: checks.whole("seed", v, least=0), "Same seed, same picture; >= 0."
    )
    backend = Parameter(
        "auto", backends.checked,
        '"auto": a CUDA device where there is one, else the CPU; "cpu"; "cuda".',
    )  # fmt: skip
    surface = Parameter(
        None, optional(one_of("surface", Surface)),
        "Surface: mode, coat and gradient factor, instead of the property's shading, or None.",
    )  # fmt: skip
    phase = Parameter(
        None, optional(one_of("phase", *get_args(Phase))),
        "Phase function, instead of the property's scattering anisotropy, or None.",
    )  # fmt: skip
    shadow_reach = Parameter(
        float("inf"), lambda v: checks.number("shadow_reach", v, least=0.0, finite=False),
        "World units within which the volume attenuates light; 0: no shadows.",
    )  # fmt: skip
    estimator = Parameter(
        "majorant-grid", lambda v: checks.choice("estimator", v, ESTIMATORS),
        '"majorant-grid", "woodcock" (Exposure Render\'s global majorant) or "ray-march" (biased).',
    )  # fmt: skip
    ratio_tracking = Parameter(
        True, bool, "Whether shadow rays estimate transmittance, or see light or not (delta)."
    )
    sampler = Parameter(
        "sobol", lambda v: checks.choice("sampler", v, ("sobol", "independent")),
        '"sobol" (samples spread evenly) or "independent".',
    )  # fmt: skip

    def scene_of_inputs(self, inputs: Inputs) -> Scene:
        """Return the scene of what arrives, with the transport that is asked for."""
        scene = super().scene_of_inputs(inputs)
        return dataclasses.replace(
            scene, shadow_reach=self.shadow_reach, estimator=self.estimator,
            ratio_tracking=self.ratio_tracking, sampler=self.sampler,
            phase=self.phase or scene.phase, surface=self.surface or scene.surface,
        )  # fmt: skip

    def UpdateSamples(self, samples: int) -> None:
        """Bring the picture to so many samples per pixel in all, going on from those it has.

        Nothing is traced again: the bits are those of a run of `samples` from the start.
        """
        self.samples = samples
        self.Update()

    def settings(self) -> tuple[Any, ...]:
        """Return what decides the picture beside the scene."""
        return self.samples, self.seconds, self.nrms, self.seed, self.backend

    def refined(self, picture: Picture) -> Picture | None:
        """Return the picture with more samples, where their number is what ends it."""
        samples = DEFAULT_SAMPLES if self.samples is None else self.samples
        ends = self.seconds is None and self.nrms is None and samples > picture.samples
        if not ends or picture.seed != self.seed or self.backend not in ("auto", picture.backend):
            return None
        return picture.refine(samples, progress=self.report, abort=self.aborted)

    def render(self, scene: Scene) -> Picture:
        """Return the picture of a scene."""
        return render_scene(
            scene, samples=self.samples, seconds=self.seconds, nrms=self.nrms, seed=self.seed,
            threads=self.threads, backend=self.backend, progress=self.report, abort=self.aborted,
        )  # fmt: skip
