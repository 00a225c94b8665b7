"""What is compared: the scene as it is, and the scene with one thing done otherwise."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from numpy.typing import NDArray

from ..lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    GradientEnvironment,
    PointLight,
)
from ..occlusion import Occlusion
from ..occlusion.settings import MODES
from ..phases import Isotropic
from ..pictures import denoise
from ..pictures.picture import Picture
from ..scene import Scene

# Lights that no scattered ray can meet
DELTA = (DirectionalLight, PointLight)
SKIES = (ConstantEnvironment, GradientEnvironment, EnvironmentMap)

# Against the scene as it is: equal in the mean; a bias of the method; another model of light;
# another scene, which has a reference of its own
SAME, BIAS, MODEL, OTHER = "same mean", "bias", "model", "other scene"


@dataclass(frozen=True, eq=False)
class Variant:
    """One way to render the scene.

    Attributes
    ----------
    group : str
        Heading under which it is compared.
    name : str
    kind : str
        `SAME`, `BIAS`, `MODEL` or `OTHER`: what a difference from the scene as it is means.
    scene : Scene
    finish : callable, optional
        Picture -> radiance, applied before the comparison.
    adaptive : bool
        Samples go where the noise is.
    occlusion : Occlusion, optional
        Directional occlusion instead of Monte Carlo.
    """

    group: str
    name: str
    kind: str
    scene: Scene
    finish: Callable[[Picture], NDArray] | None = None
    adaptive: bool = False
    occlusion: Occlusion | None = None

    @property
    def key(self) -> str:
        """Identifier in results."""
        return f"{self.group}: {self.name}"


def base_variant(scene: Scene) -> Variant:
    """The scene as it is."""
    return Variant("scene", "as it is", SAME, scene)


def variants(scene: Scene) -> list[Variant]:
    """Everything that is worth comparing for this scene, the most asked for first."""
    return [
        *_effects_off(scene),
        *_denoisers(scene),
        *_samplers(scene),
        *_light_sampling(scene),
        *_shadows(scene),
        *_estimators(scene),
        *_scattering(scene),
        *_occluded(scene),
    ]


def _effects_off(scene: Scene) -> Iterator[Variant]:
    """Each effect that is on, switched off."""
    group = "without an effect"

    def without(name: str, **changes: object) -> Variant:
        return Variant(group, name, MODEL, replace(scene, **changes))  # type: ignore[arg-type]

    if scene.lights and scene.shadow_reach and scene.scattering == "single":
        yield without("no shadows", shadow_reach=0.0)
    if scene.surface is not None:
        yield without("no surface shading", surface=None)
        coat = scene.surface.specular
        if (max(coat) if isinstance(coat, tuple) else coat) > 0:
            yield without("no specular coat", surface=replace(scene.surface, specular=0.0))
    if not isinstance(scene.phase, Isotropic):
        yield without("isotropic phase", phase=Isotropic())
    if scene.camera.lens is not None and scene.camera.lens.radius > 0:
        yield without("no depth of field", camera=replace(scene.camera, lens=None))
    skies = tuple(light for light in scene.lights if isinstance(light, SKIES))
    others = tuple(light for light in scene.lights if not isinstance(light, SKIES))
    if skies and others:
        yield without("no environment", lights=others)
        yield without("environment alone", lights=skies)
    yield from _parts_off(scene)


def _parts_off(scene: Scene) -> Iterator[Variant]:
    """Channels of the transfer function, cuts, and things beside the volume."""
    transfer = scene.transfer
    changes: dict[str, dict[str, Any]] = {}
    if transfer.emission is not None:
        changes["no emission"] = {"transfer": replace(transfer, emission=None)}
    if transfer.gradient_opacity is not None:
        changes["no gradient opacity"] = {"transfer": replace(transfer, gradient_opacity=None)}
    if scene.receivers:
        changes["no receivers"] = {"receivers": ()}
    if scene.layers:
        changes["first volume alone"] = {"layers": ()}
    if scene.clip or scene.crop is not None or scene.mask is not None:
        changes["no cuts"] = {"clip": (), "crop": None, "mask": None}
    if scene.labels is not None:
        changes["one transfer function for all labels"] = {"labels": None}
    for name, change in changes.items():
        yield Variant("without an effect", name, MODEL, replace(scene, **change))


def _denoisers(scene: Scene) -> Iterator[Variant]:
    """Error after denoising; a trained one is guided by albedo and normal."""
    guided = replace(scene, aovs=("albedo", "normal"))
    for method in denoise.available():
        yield Variant(
            "denoiser", method, BIAS, guided if method == "oidn" else scene,
            _denoised_by(method),
        )  # fmt: skip


def _denoised_by(method: str) -> Callable[[Picture], NDArray]:
    return lambda picture: picture.denoised(method).radiance


def _samplers(scene: Scene) -> Iterator[Variant]:
    for sampler in ("independent", "sobol"):
        if sampler != scene.sampler:
            yield Variant("sampler", sampler, SAME, replace(scene, sampler=sampler))
    yield Variant("sampler", "adaptive", SAME, scene, adaptive=True)


def _light_sampling(scene: Scene) -> Iterator[Variant]:
    if scene.light_sampling == "mis" and scene.lights:
        for how, name in (("light", "by lights only"), ("scatter", "by scattering only")):
            if how == "light" or not all(isinstance(light, DELTA) for light in scene.lights):
                yield Variant("directions", name, SAME, replace(scene, light_sampling=how))


def _shadows(scene: Scene) -> Iterator[Variant]:
    if scene.lights and scene.shadow_reach:
        ratio = not scene.ratio_tracking
        name = "ratio tracking" if ratio else "delta tracking (seen or not)"
        yield Variant("shadow rays", name, SAME, replace(scene, ratio_tracking=ratio))


def _estimators(scene: Scene) -> Iterator[Variant]:
    edge = float(scene.volume.spacing.min())
    if scene.estimator == "majorant-grid":
        woodcock = replace(scene, estimator="woodcock")
        yield Variant("collisions", "woodcock (global majorant)", SAME, woodcock)
    for voxels in (4.0, 1.0, 0.25):
        marched = replace(scene, estimator="ray-march", step=voxels * edge)
        yield Variant("collisions", f"ray marching, step {voxels:g} voxels", BIAS, marched)


def _scattering(scene: Scene) -> Iterator[Variant]:
    if scene.scattering == "single" and math.isinf(scene.shadow_reach):
        many = replace(scene, scattering="multiple")
        yield Variant("scattering", "multiple", MODEL, many)
    elif scene.scattering == "multiple":
        one = replace(scene, scattering="single", max_scatterings=None)
        yield Variant("scattering", "single", MODEL, one)


# Directional occlusion at half angle 60, where not said otherwise
ANGLE, ANGLES, SLICES = 60.0, (30.0, 80.0), (64, 256)


def _occluded(scene: Scene) -> Iterator[Variant]:
    """Directional occlusion by mode, half angle and slices."""
    settings = {f"{mode}, {ANGLE:g} degrees": Occlusion(ANGLE, mode) for mode in MODES}
    settings |= {f"default, {angle:g} degrees": Occlusion(angle) for angle in ANGLES}
    settings |= {f"default, {n} slices": Occlusion(ANGLE, slices=n) for n in SLICES}
    for name, occlusion in settings.items():
        yield Variant("occlusion", name, MODEL, scene, occlusion=occlusion)
