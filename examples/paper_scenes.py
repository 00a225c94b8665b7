"""What `paper_figures.py` draws: the volumes, and pictures of them in scenes like the paper's."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import vtkmcvr
from vtkmcvr.environment_files import read_environment
from vtkmcvr.front import View
from vtkmcvr.presets import Dressed
from vtkmcvr.vtk_bridge.scene import volume_of

GOLD = (1.0, 0.60, 0.20)
FLESH = (0.93, 0.50, 0.36)
BONE = (0.92, 0.88, 0.80)
STUDIO_MAP = "env/studio_small_03_1k.hdr"


@dataclass(frozen=True)
class Subject:
    """A volume and how it is looked at.

    Parameters
    ----------
    file : str
    flip : str or None
        Index axes that the file has the wrong way round.
    preset : str
    view : View
    clip : sequence of Plane
    tissue : 4 floats
        Values from which on there is flesh, all flesh, bone, dense bone.
    """

    file: str
    flip: str | None
    preset: str
    view: View
    clip: tuple = ()
    tissue: tuple[float, float, float, float] = (-120.0, 0.0, 350.0, 1200.0)


WITHOUT_HEADREST = (vtkmcvr.Plane((0, 233, 0), (0, -1, 0)),)
SKULL = Subject(
    "scivis/cthead/CThead.nhdr", "k", "ct-bone", View(azimuth=38, elevation=4, zoom=1.4),
    WITHOUT_HEADREST,
)  # fmt: skip
ENGINE = Subject("scivis/engine.nhdr", None, "solid", View(azimuth=-35, elevation=28, zoom=0.8))
ENGINE_NEAR = replace(ENGINE, view=View(azimuth=-42, elevation=14, zoom=1.15))
BRAIN = Subject("nifti/MR_Gd.nii.gz", None, "mr-head", View(azimuth=-60, elevation=15, zoom=1.4))
MAN = Subject(
    "scivis/vismale.nhdr", "k", "solid", View(azimuth=35, zoom=1.3),
    (vtkmcvr.Plane((22, 0, 0), (1, 0, 0)),),
    tissue=(45.0, 62.0, 125.0, 200.0),
)  # fmt: skip
PHANTOM = Subject("", None, "ct-bone", View(azimuth=-28))


@dataclass(frozen=True)
class Stage:
    """A subject in its look, and where the data is.

    Attributes
    ----------
    dressed : Dressed
    subject : Subject
        `PHANTOM` where the file of the one that was asked for is absent.
    data : Path or None
    """

    dressed: Dressed
    subject: Subject
    data: Path | None

    @property
    def scene(self) -> vtkmcvr.Scene:
        """Scene of the look."""
        return self.dressed.scene


def stage_of(subject: Subject, data: Path | None, size: tuple[int, int]) -> Stage:
    """The subject in its look; the synthetic head where its file is absent."""
    if data is None or not (data / subject.file).exists():
        subject = PHANTOM
        volume = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(128))
    else:
        volume = volume_of(vtkmcvr.read(data / subject.file))
    volume = volume.flipped(subject.flip) if subject.flip else volume
    dressed = vtkmcvr.scene_of(
        volume, preset=subject.preset, size=size, view=subject.view, clip=subject.clip
    )
    return Stage(dressed, subject, data)


@dataclass(frozen=True)
class Shot:
    """How large, how long, on how many threads."""

    size: tuple[int, int]
    samples: int
    threads: int | None

    def __call__(self, stage: Stage, samples: int | None = None, exposure=None, **scene: object):
        """Picture of the scene with some of its fields replaced."""
        return vtkmcvr.render(
            replace(stage.scene, **scene), samples=samples or self.samples, threads=self.threads,
            exposure=stage.dressed.exposure if exposure is None else exposure,
        )  # fmt: skip


def painted(stage: Stage, *rgb: float) -> vtkmcvr.TransferFunction:
    """Transfer function of the look in one colour."""
    return replace(stage.scene.transfer, colour=vtkmcvr.ColourCurve([(0.0, *rgb)]))


def depth_of_field(stage: Stage, shot: Shot) -> list:
    """Three apertures, sharp at what is near on the left."""
    scene = stage.scene
    focus = vtkmcvr.autofocus(scene, (shot.size[0] * 5 // 12, shot.size[1] * 6 // 10))
    look = {
        "transfer": painted(stage, 0.75, 0.45, 0.30),
        "surface": vtkmcvr.Surface(1.0, specular=0.2, exponent=80.0),
    }
    lenses = [vtkmcvr.Lens(share * focus, focus) for share in (0.0, 0.05, 0.12)]
    return [shot(stage, camera=replace(scene.camera, lens=lens), **look) for lens in lenses]


def hybrid_scattering(stage: Stage, shot: Shot) -> list:
    """Phase function only, hybrid, surfaces only."""
    coat = replace(stage.scene.surface, specular=0.10, exponent=80.0)
    return [
        shot(stage, surface=None, exposure=0.7),
        shot(stage, surface=replace(coat, gradient_factor=0.7), exposure=0.7),
        shot(stage, surface=replace(coat, mode="brdf"), exposure=0.7),
    ]


def soft_shadow(stage: Stage, shot: Shot) -> list:
    """A plane under the volume and one light above it, in three sizes of the same power."""
    scene = stage.scene
    volume, corners = scene.volume, scene.volume.corners
    centre, radius = volume.centre, volume.radius
    right, _, forward = scene.camera.frame
    floor = (*centre[:2], corners[:, 2].min() - 0.005 * radius)
    place = centre + radius * (-1.7 * right - 0.3 * forward + np.array((0.0, 0.0, 1.9)))
    look = {
        "transfer": painted(stage, 0.86, 0.84, 0.80),
        "surface": vtkmcvr.Surface(1.0, specular=0.10, exponent=60.0),
        "receivers": (vtkmcvr.PlaneReceiver(floor, (0, 0, 1), colour=0.5),),
    }
    sky = vtkmcvr.ConstantEnvironment((0.22, 0.26, 0.33))

    def lamp(edge: float):
        panel = vtkmcvr.RectangleLight(tuple(place), tuple(centre), (edge * radius,) * 2)
        return vtkmcvr.with_irradiance(panel, (4.6, 4.2, 3.7), centre)

    return [shot(stage, lights=(sky, lamp(edge)), **look) for edge in (0.05, 0.6, 1.6)]


def thin_media(stage: Stage, shot: Shot) -> list:
    """Bone as a surface in flesh of three densities."""
    return [
        shot(stage, transfer=flesh_and_bone(opacity, stage.subject.tissue), exposure=0.3)
        for opacity in (0.003, 0.012, 0.05)
    ]


def flesh_and_bone(opacity: float, tissue: tuple[float, float, float, float]):
    """Transfer function: flesh of an opacity per millimetre, dense bone."""
    skin, flesh, bone, dense = tissue
    end = 0.5 * (flesh + bone)
    opacities = [(skin, 0), (flesh, opacity), (end, opacity), (bone, 0.3), (dense, 0.95)]
    colours = [(flesh, *FLESH), (end, *FLESH), (bone, *BONE), (dense, *BONE)]
    return vtkmcvr.TransferFunction(vtkmcvr.Curve(opacities), vtkmcvr.ColourCurve(colours))


def gold(stage: Stage, shot: Shot) -> list:
    """Bone under photographic light, then satin and polished gold in the same studio."""
    scene = stage.scene
    edge = scene.transfer.opacity.nodes[0][0]
    metal = replace(
        painted(stage, 0.03, 0.018, 0.004), density_scale=3.0,
        specular=vtkmcvr.ColourCurve([(edge, *GOLD)]),
    )  # fmt: skip
    lights = studio(stage)
    return [
        shot(stage, lights=lights, exposure=-0.8),
        *(
            shot(
                stage, transfer=metal, lights=lights, exposure=-0.7,
                surface=vtkmcvr.Surface(1.0, mode="brdf", exponent=exponent, coat="ggx"),
            )
            for exponent in (30.0, 250.0)
        ),
    ]  # fmt: skip


def studio(stage: Stage) -> tuple:
    """Panorama of a photographer's studio; soft boxes where it is absent."""
    if stage.data is not None and (stage.data / STUDIO_MAP).exists():
        return (vtkmcvr.EnvironmentMap(read_environment(stage.data / STUDIO_MAP)),)
    return studio_panels(stage.scene)


def studio_panels(scene) -> tuple:
    """Soft boxes on the left, on the right and above, and a dim sky, bright from above."""
    right, up, forward = scene.camera.frame
    centre, radius = scene.volume.centre, scene.volume.radius
    panels = [
        (-1.0 * right + 0.5 * up - 0.7 * forward, (1.4, 1.8), (7.0, 6.4, 5.6)),
        (1.2 * right + 0.2 * up - 0.1 * forward, (0.5, 2.0), (10.0, 9.5, 9.0)),
        (0.1 * right + 1.5 * up - 0.4 * forward, (1.6, 1.0), (6.0, 5.6, 5.2)),
    ]
    lights = [
        vtkmcvr.RectangleLight(
            tuple(centre + 2.2 * radius * way / np.linalg.norm(way)), tuple(centre),
            (width * radius, height * radius), radiance, tuple(up),
        )
        for way, (width, height), radiance in panels
    ]  # fmt: skip
    sky = vtkmcvr.GradientEnvironment((0.8, 0.75, 0.7), (0.3, 0.27, 0.24), (0.10, 0.08, 0.06))
    return (sky, *lights)


def convergence(stage: Stage, shot: Shot) -> list:
    """1, 4, 16, 64 and 256 samples; each picture refines the one before."""
    pictures = [shot(stage, samples=1)]
    for samples in (4, 16, 64, 256):
        pictures.append(pictures[-1].refine(samples=samples))
    return pictures
