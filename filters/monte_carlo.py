"""Volume -> picture by Monte Carlo light transport."""

from __future__ import annotations

import dataclasses
from typing import Any, get_args

from vtkmodules.vtkCommonDataModel import vtkImageData

from vtkmcvr import checks
from vtkmcvr.phases import Phase
from vtkmcvr.picture import Picture
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import ESTIMATORS, Scene, Surface

from .parameters import Parameter, one_of, optional
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

    def scene(self, image: vtkImageData) -> Scene:
        """Return the scene of an image, with the transport that is asked for."""
        scene = super().scene(image)
        return dataclasses.replace(
            scene, shadow_reach=self.shadow_reach, estimator=self.estimator,
            ratio_tracking=self.ratio_tracking, sampler=self.sampler,
            phase=self.phase or scene.phase, surface=self.surface or scene.surface,
        )  # fmt: skip

    def settings(self) -> tuple[Any, ...]:
        """Return what decides the picture beside the scene."""
        return self.samples, self.seconds, self.nrms, self.seed

    def render(self, scene: Scene) -> Picture:
        """Return the picture of a scene."""
        return render_scene(
            scene, samples=self.samples, seconds=self.seconds, nrms=self.nrms, seed=self.seed,
            threads=self.threads, progress=self.report, abort=self.aborted,
        )  # fmt: skip
