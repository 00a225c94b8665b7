"""Techniques without noise, by name."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from . import backends
from .emission_absorption import (
    AS_VTK,
    EmissionAbsorption,
    EmissionAbsorptionPicture,
    render_emission_absorption,
)
from .occlusion import Occlusion, OcclusionPicture, render_occlusion
from .scene import Scene
from .screen import Colour, Display

TECHNIQUES = ("occlusion", "emission-absorption")


def check_settings(technique: str, **settings: object) -> None:
    """Refuse the settings of another technique, by the name of its argument."""
    for name, value in settings.items():
        owner = name.replace("_", "-")
        if value is not None and owner != technique:
            raise ValueError(f'{name}=... needs technique="{owner}"')


def render_noiseless(
    technique: str,
    scene: Scene,
    settings: Occlusion | EmissionAbsorption | None,
    exposure: float | None,
    usual: float,
    background: Colour | None = None,
    backend: str = "auto",
    **how: Any,
) -> OcclusionPicture | EmissionAbsorptionPicture:
    """Render a scene by a technique without noise.

    Parameters
    ----------
    technique : {"occlusion", "emission-absorption"}
    scene : Scene
    settings : Occlusion or EmissionAbsorption, optional
    exposure : float, optional
        Stops. Default: `usual`, but 0 for emission and absorption, which shows colours as they are.
    usual : float
        Exposure of light transport.
    background : colour, optional
        Of the display.
    backend : {"auto", "cpu", "cuda"}
        Emission and absorption are the CPU's alone.
    **how
        `threads`, `progress` and `abort`.
    """
    if technique == "occlusion":
        assert settings is None or isinstance(settings, Occlusion)
        display = Display(usual if exposure is None else exposure, background)
        return render_occlusion(scene, settings, display=display, backend=backend, **how)
    backends.check_unused(backend, technique)
    assert settings is None or isinstance(settings, EmissionAbsorption)
    display = replace(AS_VTK, exposure=exposure or 0.0, background=background)
    return render_emission_absorption(scene, settings, display=display, **how)
