"""Volume -> picture by emission and absorption."""

from __future__ import annotations

from typing import Any

from vtkmcvr.emission_absorption import (
    EmissionAbsorption,
    EmissionAbsorptionPicture,
    render_emission_absorption,
)
from vtkmcvr.scene import Scene

from .parameters import Parameter, one_of
from .picture_filter import PictureFilter


class EmissionAbsorptionFilter(PictureFilter):
    """Renders a volume by emission and absorption: what VTK's own volume mappers show.

    Inputs: volumes as in `SceneFilter`, no meshes. Output 0: vtkImageData of the film's size with
    the float32 point arrays "radiance" (active; the colours of the transfer function, composited as
    they are and premultiplied by alpha, and alpha), "depth" (world units, inf beside the volume)
    and, where `aovs` asks for them, "albedo" and "normal": the same as a `MonteCarloFilter`'s.
    With shading on, a lamp at the eye shades by the property's ambient, diffuse, specular and
    specular power; lights and lens do not count. `ToneMapFilter(curve="none", gamma=1.0)` shows it
    as VTK would. Output 1: a vtkTable, see `statistics.table_of_picture`.

    Parameters
    ----------
    **settings
        Any parameter by name: `EmissionAbsorptionFilter(emission_absorption=EmissionAbsorption(
        step=0.25))`.
    """

    emission_absorption = Parameter(
        EmissionAbsorption(), one_of("emission_absorption", EmissionAbsorption),
        "vtkmcvr.EmissionAbsorption: steps, rays and shading.",
    )  # fmt: skip

    takes_meshes = False
    scatters = False
    # Composited as they are
    renderer_colours = "linear"

    def settings(self) -> tuple[Any, ...]:
        """Return what decides the picture beside the scene."""
        return (self.emission_absorption,)

    def render(self, scene: Scene) -> EmissionAbsorptionPicture:
        """Return the picture of a scene."""
        return render_emission_absorption(
            scene, self.emission_absorption, threads=self.threads, progress=self.report,
            abort=self.aborted,
        )  # fmt: skip
