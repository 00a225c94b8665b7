"""What the user describes: plain, frozen, validated data. World units are those of the volume.

Nothing here knows VTK or Numba; `vtk_bridge` translates from VTK, `plan` into what kernels see.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from numpy.typing import NDArray

from . import checks
from .backdrop import Backdrop, check_backdrop
from .camera import Camera, Lens, PixelFilter, Stereo, Vector
from .cutting import Cropping, Shape
from .labels import Labels
from .layers import Layer, check_parts, layers
from .lights import ConstantEnvironment, EnvironmentMap, GradientEnvironment, Light
from .material import Surface, TransferFunction, TransferTable
from .phases import Cone, HenyeyGreenstein, Isotropic, Phase, Rayleigh, Schlick
from .receivers import Receiver, receivers
from .volume import Volume

__all__ = [
    "Camera", "Cone", "HenyeyGreenstein", "Isotropic", "Lens", "PixelFilter", "Rayleigh", "Scene",
    "Schlick", "Stereo", "Surface", "TransferFunction", "TransferTable", "Vector", "Volume",
]  # fmt: skip

ISOTROPIC = Isotropic()
ESTIMATORS = ("majorant-grid", "woodcock", "ray-march")


AOVS = ("albedo", "normal")


def known_aovs(names: Iterable[str]) -> tuple[str, ...]:
    """Return the names, each once, or say which are allowed."""
    given = (names,) if isinstance(names, str) else tuple(names)
    for name in given:
        if name not in AOVS:
            raise ValueError(f"aovs are some of {', '.join(AOVS)}; got {name!r}")
    return tuple(name for name in AOVS if name in given)


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that decides the radiance of a picture.

    Parameters
    ----------
    volume, transfer, camera
        The medium, its look, the view.
    lights : sequence of Light
        Area, directional and point lights, lights fixed to the camera, and at most one each of
        ConstantEnvironment, GradientEnvironment and EnvironmentMap.
    surface : Surface, optional
        None: volume scattering only.
    phase : Isotropic, HenyeyGreenstein, Schlick, Rayleigh or Cone
        How the volume spreads light.
    scattering : {"single", "multiple"}
        One scattering event between light and camera, as in Exposure Render, or many.
    max_scatterings : int, optional
        Most events of "multiple", >= 1. None: no limit; Russian roulette ends paths.
    estimator : {"majorant-grid", "woodcock", "ray-march"}
        How collisions are found: by delta tracking over local majorants; over the one global
        majorant of Exposure Render, with equal results; by equal steps, which is biased.
    step : float, optional
        Step of "ray-march" in world units. None: half the smallest voxel edge.
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
    aovs : sequence of {"albedo", "normal"}
        What the film also records of the first collision; a normal costs a gradient there.
    sampler : {"sobol", "independent"}
        How the leading random numbers of a path are drawn: spread evenly over the samples of a
        pixel, in independent batches, or each on its own. Both are unbiased.
    clip : sequence of Plane, Sphere or Box
        What all of them keep is left of the volume; the rest is cut off, for shadows too.
    crop : Cropping, optional
        VTK's 27 cropping regions.
    mask : array (k, j, i), optional
        0 hides a voxel: points nearest to it are transparent.
    labels : Labels, optional
        Transfer functions by label.
    receivers : sequence of PlaneReceiver, BoxReceiver, SphereReceiver or MeshReceiver
        Opaque surfaces that receive and cast shadows.
    layers : sequence of Layer
        Further volumes; where they overlap, extinctions add.
    backdrop : Backdrop, optional
        Opaque things that another renderer draws, where camera rays end; not for a panorama.
    """

    volume: Volume
    transfer: TransferFunction
    camera: Camera
    lights: tuple[Light, ...] = ()
    surface: Surface | None = None
    phase: Phase = ISOTROPIC
    scattering: str = "single"
    max_scatterings: int | None = None
    estimator: str = "majorant-grid"
    step: float | None = None
    shadow_reach: float = float("inf")
    environment_visible: bool = False
    ratio_tracking: bool = True
    light_sampling: str = "mis"
    size: tuple[int, int] = (800, 600)
    pixel_filter: PixelFilter = field(default_factory=PixelFilter)
    aovs: tuple[str, ...] = ()
    sampler: str = "sobol"
    clip: tuple[Shape, ...] = ()
    crop: Cropping | None = None
    mask: NDArray | None = None
    labels: Labels | None = None
    receivers: tuple[Receiver, ...] = ()
    layers: tuple[Layer, ...] = ()
    backdrop: Backdrop | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "lights", tuple(self.lights))
        for kind in (ConstantEnvironment, GradientEnvironment, EnvironmentMap):
            if sum(isinstance(light, kind) for light in self.lights) > 1:
                raise ValueError(f"a scene takes at most one {kind.__name__}")
        _check_transport(self)
        check_parts(self)
        object.__setattr__(self, "receivers", receivers(self.receivers))
        object.__setattr__(self, "layers", layers(self.layers))
        checks.number("shadow_reach", self.shadow_reach, least=0.0, finite=False)
        checks.choice("light_sampling", self.light_sampling, ("mis", "light", "scatter"))
        object.__setattr__(self, "aovs", known_aovs(self.aovs))
        checks.choice("sampler", self.sampler, ("sobol", "independent"))
        width, height = self.size
        object.__setattr__(
            self,
            "size",
            (
                checks.whole("film width", width, least=1),
                checks.whole("film height", height, least=1),
            ),
        )
        check_backdrop(self.backdrop, self.size)


def _check_transport(scene: Scene) -> None:
    """Phase function, order of scattering and estimator."""
    if not isinstance(scene.phase, Phase):
        raise ValueError(
            "phase is Isotropic(), HenyeyGreenstein(g), Schlick(k), Rayleigh() or Cone(angle); "
            f"got {scene.phase!r}"
        )
    if scene.transfer.g is not None and isinstance(scene.phase, (Rayleigh, Cone)):
        raise ValueError(
            "the transfer function gives g, which needs an Isotropic, HenyeyGreenstein or Schlick "
            f"phase; got {scene.phase}"
        )
    checks.choice("scattering", scene.scattering, ("single", "multiple"))
    checks.choice("estimator", scene.estimator, ESTIMATORS)
    if scene.step is not None:
        checks.number("step", scene.step, above=0.0)
    if scene.max_scatterings is not None:
        checks.whole("max_scatterings", scene.max_scatterings, least=1)
        if scene.scattering == "single" and scene.max_scatterings > 1:
            raise ValueError('max_scatterings above 1 needs scattering="multiple"')
    if scene.scattering == "multiple" and scene.shadow_reach != float("inf"):
        raise ValueError(
            "multiple scattering attenuates light on its whole way: leave shadow_reach at inf, "
            f"got {scene.shadow_reach:g}"
        )
