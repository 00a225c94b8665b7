"""What the user describes: plain, frozen, validated data. World units are those of the volume.

Nothing here knows VTK or Numba; `vtk_scene` translates from VTK, `plan` into what kernels see.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from . import checks
from .camera import Camera, Lens, PixelFilter, Stereo, Vector
from .lights import ConstantEnvironment, EnvironmentMap, Light
from .material import Surface, TransferFunction
from .volume import Volume

__all__ = [
    "Camera", "Lens", "PixelFilter", "Scene", "Stereo", "Surface", "TransferFunction", "Vector",
    "Volume",
]  # fmt: skip


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that decides the radiance of a picture.

    Parameters
    ----------
    volume, transfer, camera
        The medium, its look, the view.
    lights : sequence of Light
        Rectangle, directional and point lights, and at most one each of ConstantEnvironment and
        EnvironmentMap.
    surface : Surface, optional
        None: volume scattering only.
    phase_g : float
        Mean cosine of the Henyey-Greenstein phase function, -0.9999 to 0.9999; 0: isotropic.
    shadow_reach : float
        Distance from the scattering point within which the medium attenuates light, world units;
        inf: physically right; 0: no shadows.
    environment_visible : bool
        Whether camera rays that miss the volume see the environment.
    ratio_tracking : bool
        Shadow rays estimate transmittance by ratio tracking (True), or as seen or not by delta
        tracking as in Exposure Render (False).
    light_sampling : {"mis", "light", "scatter"}
        How directions toward light are drawn; "light" and "scatter" are for tests.
    size : (width, height)
        Pixels.
    pixel_filter : PixelFilter
    sampler : {"sobol", "independent"}
        How the leading random numbers of a path are drawn: spread evenly over the samples of a
        pixel, in independent batches, or each on its own. Both are unbiased.
    """

    volume: Volume
    transfer: TransferFunction
    camera: Camera
    lights: tuple[Light, ...] = ()
    surface: Surface | None = None
    phase_g: float = 0.0
    shadow_reach: float = float("inf")
    environment_visible: bool = False
    ratio_tracking: bool = True
    light_sampling: str = "mis"
    size: tuple[int, int] = (800, 600)
    pixel_filter: PixelFilter = field(default_factory=PixelFilter)
    sampler: str = "sobol"

    def __post_init__(self) -> None:
        object.__setattr__(self, "lights", tuple(self.lights))
        for kind in (ConstantEnvironment, EnvironmentMap):
            if sum(isinstance(light, kind) for light in self.lights) > 1:
                raise ValueError(f"a scene takes at most one {kind.__name__}")
        checks.number("phase_g", self.phase_g, least=-0.9999, most=0.9999)
        checks.number("shadow_reach", self.shadow_reach, least=0.0, finite=False)
        if self.light_sampling not in ("mis", "light", "scatter"):
            raise ValueError(
                f"light_sampling is one of mis, light, scatter; got {self.light_sampling!r}"
            )
        if self.sampler not in ("sobol", "independent"):
            raise ValueError(f"sampler is one of sobol, independent; got {self.sampler!r}")
        width, height = self.size
        object.__setattr__(
            self,
            "size",
            (
                checks.whole("film width", width, least=1),
                checks.whole("film height", height, least=1),
            ),
        )
