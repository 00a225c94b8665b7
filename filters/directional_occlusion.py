"""Volume -> picture by directional occlusion shading."""

from __future__ import annotations

from typing import Any

from vtkmcvr.occlusion import Occlusion, OcclusionPicture, render_occlusion
from vtkmcvr.scene import Scene

from .parameters import Parameter, one_of
from .picture_filter import PictureFilter


class DirectionalOcclusionFilter(PictureFilter):
    """Renders a volume by directional occlusion shading: quick, without noise, biased.

    Inputs: volumes as in `SceneFilter`, no meshes. Output 0: vtkImageData of the film's size with
    the float32 point arrays "radiance" (active; linear RGB premultiplied by alpha, and alpha),
    "depth" (world units, inf beside the volume) and, where `aovs` asks for them, "albedo" and
    "normal": the same as a `MonteCarloFilter`'s, so that a viewer can fade from one into the other.
    Output 1: a vtkTable, see `statistics.table_of_picture`. Lights count by how much they give the
    volume's centre; a lens does not count.

    Parameters
    ----------
    **settings
        Any parameter by name: `DirectionalOcclusionFilter(occlusion=Occlusion(half_angle=70))`.
    """

    occlusion = Parameter(
        Occlusion(), one_of("occlusion", Occlusion), "vtkmcvr.Occlusion: cone, mode and accuracy."
    )

    takes_meshes = False
    scatters = False

    def settings(self) -> tuple[Any, ...]:
        """Return what decides the picture beside the scene."""
        return (self.occlusion,)

    def render(self, scene: Scene) -> OcclusionPicture:
        """Return the picture of a scene."""
        return render_occlusion(
            scene, self.occlusion, threads=self.threads, progress=self.report, abort=self.aborted
        )
