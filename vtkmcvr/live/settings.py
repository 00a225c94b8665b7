"""What the user may ask of a live picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from .. import checks
from ..backends import BACKENDS, check_unused
from ..camera import Lens
from ..emission_absorption import EmissionAbsorption
from ..lights import Light
from ..noiseless import TECHNIQUES as NOISELESS
from ..noiseless import check_settings
from ..occlusion import Occlusion
from ..pictures.display import EXPOSURE, SHADED_EXPOSURE
from ..scene import Scene
from ..studio import Studio

TECHNIQUES = ("monte-carlo", *NOISELESS)
LIGHTING = ("scene", "studio")
MESHES = ("drawn", "traced")
SAMPLES = 256


@dataclass(frozen=True, eq=False)
class LiveSettings:
    """How the volumes of a renderer are drawn. Lengths are world units.

    Parameters
    ----------
    technique : {"monte-carlo", "occlusion", "emission-absorption"}
        Light transport; directional occlusion shading: smooth, quick and biased; or emission and
        absorption: what VTK itself shows. By the latter two, meshes hide the volume and are seen
        through it, but neither cast nor receive anything.
    occlusion : Occlusion, optional
        Cone, mode and accuracy of "occlusion".
    emission_absorption : EmissionAbsorption, optional
        Steps, rays and shading of "emission-absorption".
    samples : int, optional
        Samples per pixel at which a picture is done, >= 1. Default: 256, or unlimited where `nrms`
        or `seconds` is given.
    nrms : float, optional
        Error at which it is done, such as 0.02.
    seconds : float, optional
        Time after which it is done.
    lighting : {"scene", "studio"}, Studio or sequence of Light
        The renderer's own lights and environment; or a key light, a rim light and a fill that
        follow the camera, of usual brightness or of a `Studio`; or these lights.
    meshes : {"drawn", "traced"}
        "drawn": VTK draws meshes; they hide the volume and are seen through it. "traced": surfaces
        of one colour are rendered with the volume instead: they receive its soft shadow, and cast
        theirs on it.
    scattering : {"single", "multiple"}
    gradient_factor : float
        How much of a volume with shading on is surfaces, [0, 1].
    lens : Lens, optional
        Depth of field, of the volumes. Default: the camera's own.
    exposure : float, optional
        Stops; +1 doubles the brightness. Default: 1.5 where volumes have surfaces, which then are
        about as bright as VTK's; 2.5 where they only scatter, which sends less light back.
    text : bool, optional
        Whether the samples and the error so far stand in the corner. Default: where there is an
        interactive window.
    seed : int
        Same seed, same picture; >= 0.
    threads : int, optional
        >= 1. Default: all CPUs that the process may use.
    backend : {"auto", "cpu", "cuda"}
        Who renders; "auto" takes CUDA where it can be used. Emission and absorption are the CPU's.
    preview : float
        Seconds that the first estimate of a new view may take, > 0; it has fewer pixels where it
        has to.
    """

    technique: str = "monte-carlo"
    occlusion: Occlusion | None = None
    emission_absorption: EmissionAbsorption | None = None
    samples: int | None = None
    nrms: float | None = None
    seconds: float | None = None
    lighting: str | Studio | Sequence[Light] = "scene"
    meshes: str = "drawn"
    scattering: str = "single"
    gradient_factor: float = 0.5
    lens: Lens | None = None
    exposure: float | None = None
    text: bool | None = None
    seed: int = 0
    threads: int | None = None
    backend: str = "auto"
    preview: float = 0.06

    def __post_init__(self) -> None:
        checks.choice("technique", self.technique, TECHNIQUES)
        checks.choice("meshes", self.meshes, MESHES)
        checks.choice("backend", self.backend, BACKENDS)
        checks.choice("scattering", self.scattering, ("single", "multiple"))
        for name in ("samples", "threads"):
            if getattr(self, name) is not None:
                checks.whole(name, getattr(self, name), least=1)
        for name in ("nrms", "seconds"):
            if getattr(self, name) is not None:
                checks.number(name, getattr(self, name), above=0.0)
        checks.number("gradient_factor", self.gradient_factor, least=0.0, most=1.0)
        if self.exposure is not None:
            checks.number("exposure", self.exposure)
        checks.number("preview", self.preview, above=0.0)
        checks.whole("seed", self.seed, least=0)
        self._check_kinds()

    def exposure_of(self, scene: Scene) -> float:
        """Exposure of a scene, stops."""
        if self.exposure is not None:
            return self.exposure
        surfaces = [scene.surface, *(layer.surface for layer in scene.layers)]
        return EXPOSURE if surfaces.count(None) == len(surfaces) else SHADED_EXPOSURE

    def _check_kinds(self) -> None:
        if isinstance(self.lighting, str):
            checks.choice("lighting", self.lighting, LIGHTING)
        elif not isinstance(self.lighting, Studio):
            lights = tuple(self.lighting)
            _one_of("each light of lighting", lights, Light)
            object.__setattr__(self, "lighting", lights)
        _one_of("lens", (self.lens,), Lens, type(None))
        _one_of("occlusion", (self.occlusion,), Occlusion, type(None))
        _one_of("emission_absorption", (self.emission_absorption,), EmissionAbsorption, type(None))
        check_settings(
            self.technique, occlusion=self.occlusion, emission_absorption=self.emission_absorption
        )
        if self.technique == "emission-absorption":
            check_unused(self.backend, self.technique)
        if self.noiseless and self.meshes == "traced":
            raise ValueError(
                f'technique "{self.technique}" traces no meshes: leave meshes at "drawn"'
            )

    @property
    def noiseless(self) -> bool:
        """Whether the technique takes no samples."""
        return self.technique in NOISELESS

    @property
    def most_samples(self) -> int | None:
        """Samples at which a picture is done; None: no limit."""
        if self.samples is None and self.nrms is None and self.seconds is None:
            return SAMPLES
        return self.samples


def _one_of(name: str, values: Sequence[Any], *kinds: type) -> None:
    for value in values:
        if not isinstance(value, kinds):
            wanted = " or ".join(kind.__name__ for kind in kinds)
            raise TypeError(f"{name} is a {wanted}, got {type(value).__name__}")
