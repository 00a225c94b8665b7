"""What the user may ask of emission and absorption."""

from __future__ import annotations

from dataclasses import dataclass

from .. import checks
from ..material import Phong

MOST_RAYS = 64
SHADINGS = ("scene", "none")


@dataclass(frozen=True)
class EmissionAbsorption:
    """Emission and absorption along view rays: VTK's volume rendering, without its step artefacts.

    The light that reaches the eye is the integral of T sigma_t c along the ray, with T the
    transmittance to the eye and c the colour of the transfer function (Max 1995), shaded by the
    gradient where asked for. Nothing casts a shadow.

    Parameters
    ----------
    step : float
        Longest way of a step along any index axis, in voxels, 0.001 to 16. Extinction and colour
        are pre-integrated over it (Engel et al. 2001); the error goes with its square. A step of
        optical depth 0.3 or more is looked at in six parts.
    sample_distance : float, optional
        Length of a step in world units instead, as vtkVolumeMapper has it.
    rays : int
        n of the n x n rays of a pixel, 1 to 64, spread by the pixel filter. 1: through its centre,
        as in VTK.
    shading : {"scene", "none"} or Phong
        "scene": each volume that has a surface is shaded, by the surface's `phong` or, without
        one, by VTK's defaults with the surface's highlight. "none": pure colour.
    skip : bool
        Empty space is leapt over, and rays end at a transmittance of 1e-5: changes no pixel by more
        than that.
    """

    step: float = 0.5
    sample_distance: float | None = None
    rays: int = 1
    shading: str | Phong = "scene"
    skip: bool = True

    def __post_init__(self) -> None:
        checks.number("step", self.step, least=1e-3, most=16.0)
        if self.sample_distance is not None:
            checks.number("sample_distance", self.sample_distance, above=0.0)
        if checks.whole("rays", self.rays, least=1) > MOST_RAYS:
            raise ValueError(f"rays are at most {MOST_RAYS}, got {self.rays}")
        if not isinstance(self.shading, Phong):
            checks.choice("shading", self.shading, SHADINGS)
