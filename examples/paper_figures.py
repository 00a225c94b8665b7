"""Figures like 3, 6, 7, 8, 9 and 11 of Exposure Render (PLoS ONE 2012), on public volumes.

python examples/paper_figures.py [PICTURE.png]                   convergence on the synthetic head
python examples/paper_figures.py --all FOLDER --data DIR         all of them, about 900 pixels wide
                                 [--only NAME] [--width 900] [--samples 256] [--threads 1]

Where a volume is not in DIR, the synthetic head stands in for it. `figures.json` says what was
drawn, in how many seconds.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import vtkmcvr
from vtkmcvr.front import View
from vtkmcvr.picture_files import write_png
from vtkmcvr.presets import Dressed
from vtkmcvr.vtk_scene import volume_of

GAP = 4
GOLD = (1.0, 0.71, 0.29)
FLESH = (0.93, 0.52, 0.38)
BONE = (0.92, 0.88, 0.80)


@dataclass(frozen=True)
class Subject:
    """A volume's file, the axis along which it is stored the wrong way round, its look, cuts."""

    file: str
    flip: str | None
    preset: str
    view: View
    clip: tuple = ()


WITHOUT_HEADREST = (vtkmcvr.Plane((0, 233, 0), (0, -1, 0)),)
HEAD = Subject(
    "scivis/cthead/CThead.nhdr", "k", "ct-bone", View(azimuth=-28, zoom=1.42), WITHOUT_HEADREST
)
ENGINE = Subject("scivis/engine.nhdr", None, "solid", View(azimuth=-35, elevation=24, zoom=0.9))
WITHOUT_CUSHION = (
    vtkmcvr.Plane((0, 190, 0), (0, -1, 0)),
    vtkmcvr.Plane((186, 0, 0), (-1, 0, 0)),
    vtkmcvr.Plane((22, 0, 0), (1, 0, 0)),
)
FACE = replace(HEAD, preset="ct-skin", view=View(azimuth=26, zoom=1.5), clip=WITHOUT_CUSHION)
SKULL = replace(HEAD, view=View(azimuth=38, elevation=4, zoom=1.45))
BRAIN = Subject("nifti/MR_Gd.nii.gz", None, "mr-head", View(azimuth=-60, elevation=15, zoom=1.4))


@dataclass(frozen=True)
class Shot:
    """How large, how long, on how many threads."""

    size: tuple[int, int]
    samples: int
    threads: int

    def __call__(self, dressed: Dressed, samples: int | None = None, **scene: object):
        """Picture of the scene with some of its fields replaced."""
        return vtkmcvr.render(
            replace(dressed.scene, **scene), samples=samples or self.samples,
            exposure=dressed.exposure, threads=self.threads,
        )  # fmt: skip


def dressed_subject(subject: Subject, data: Path | None, size: tuple[int, int]) -> Dressed:
    """The subject in its look; the synthetic head where its file is absent."""
    if data is None or not (data / subject.file).exists():
        volume = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(128))
        return vtkmcvr.scene_of(volume, preset="ct-bone", size=size, view=View(azimuth=-28))
    volume = volume_of(vtkmcvr.read(data / subject.file))
    volume = volume.flipped(subject.flip) if subject.flip else volume
    return vtkmcvr.scene_of(
        volume, preset=subject.preset, size=size, view=subject.view, clip=subject.clip
    )


def depth_of_field(dressed: Dressed, shot: Shot) -> list:
    """Three apertures, sharp where the middle of the picture is."""
    camera = dressed.scene.camera
    focus = vtkmcvr.autofocus(dressed.scene, (shot.size[0] * 11 // 20, shot.size[1] * 6 // 10))
    return [
        shot(dressed, camera=replace(camera, lens=vtkmcvr.Lens(share * focus, focus)))
        for share in (0.0, 0.04, 0.12)
    ]


def hybrid_scattering(dressed: Dressed, shot: Shot) -> list:
    """Phase function only, hybrid, surfaces only."""
    coat = replace(dressed.scene.surface, specular=0.06, exponent=60.0)
    return [
        shot(dressed, surface=None),
        shot(dressed, surface=replace(coat, gradient_factor=0.6)),
        shot(dressed, surface=replace(coat, mode="brdf")),
    ]


def soft_shadow(dressed: Dressed, shot: Shot) -> list:
    """A plane under the volume and one light above it, in three sizes of the same power."""
    scene = dressed.scene
    volume, corners = scene.volume, scene.volume.corners
    centre, radius = volume.centre, volume.radius
    right, _, forward = scene.camera.frame
    floor = (*centre[:2], corners[:, 2].min() - 0.01 * radius)
    place = centre + radius * (-1.3 * right - 0.9 * forward + np.array((0.0, 0.0, 1.9)))
    plane = vtkmcvr.PlaneReceiver(floor, (0, 0, 1), colour=0.5)
    sky = vtkmcvr.ConstantEnvironment((0.35, 0.40, 0.48))
    metal = replace(scene.transfer, colour=vtkmcvr.ColourCurve([(0.0, 0.86, 0.84, 0.80)]))

    def lamp(edge: float):
        panel = vtkmcvr.RectangleLight(tuple(place), tuple(centre), (edge * radius,) * 2)
        return vtkmcvr.with_irradiance(panel, (4.0, 3.7, 3.3), centre)

    return [
        shot(dressed, transfer=metal, lights=(sky, lamp(edge)), receivers=(plane,))
        for edge in (0.05, 0.5, 1.5)
    ]


def thin_media(dressed: Dressed, shot: Shot) -> list:
    """Bone as a surface in flesh of three densities."""
    shift = dressed.scene.transfer.opacity.nodes[0][0] - 150.0
    return [
        shot(dressed, transfer=flesh_and_bone(opacity, shift)) for opacity in (0.001, 0.006, 0.03)
    ]


def flesh_and_bone(opacity: float, shift: float):
    """Transfer function in HU plus `shift`: flesh of an opacity per millimetre, dense bone."""
    opacities = [(-120, 0), (0, opacity), (180, opacity), (350, 0.5), (1200, 0.95)]
    colours = [(0, *FLESH), (180, *FLESH), (350, *BONE), (1500, *BONE)]
    return vtkmcvr.TransferFunction(
        vtkmcvr.Curve([(x + shift, a) for x, a in opacities]),
        vtkmcvr.ColourCurve([(x + shift, *rgb) for x, *rgb in colours]),
    )


def gold(dressed: Dressed, shot: Shot) -> list:
    """Rough, satin and polished gold under the lights of a studio."""
    scene = dressed.scene
    metal = vtkmcvr.ColourCurve([(0.0, 0.05, 0.03, 0.006)])
    edge = scene.transfer.opacity.nodes[0][0]
    transfer = replace(
        scene.transfer, colour=metal, density_scale=3.0,
        specular=vtkmcvr.ColourCurve([(edge, *GOLD)]),
    )  # fmt: skip
    return [
        shot(
            dressed, transfer=transfer, lights=studio_panels(scene),
            surface=vtkmcvr.Surface(1.0, mode="brdf", exponent=exponent, coat="ggx"),
        )
        for exponent in (4.0, 16.0, 80.0)
    ]  # fmt: skip


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
    sky = vtkmcvr.GradientEnvironment((1.6, 1.5, 1.4), (0.7, 0.62, 0.55), (0.25, 0.17, 0.10))
    return (sky, *lights)


def convergence(dressed: Dressed, shot: Shot) -> list:
    """1, 4, 16, 64 and 256 samples; each picture refines the one before."""
    pictures = [shot(dressed, samples=1)]
    for samples in (4, 16, 64, 256):
        pictures.append(pictures[-1].refine(samples=samples))
    return pictures


@dataclass(frozen=True)
class Figure:
    """What to draw of which volume; pictures side by side and their height over their width."""

    subject: Subject
    draw: Callable[[Dressed, Shot], list]
    columns: int = 3
    aspect: float = 1.1


FIGURES = {
    "figure_3_depth_of_field": Figure(HEAD, depth_of_field),
    "figure_6_hybrid": Figure(FACE, hybrid_scattering),
    "figure_7_soft_shadow": Figure(ENGINE, soft_shadow, aspect=0.9),
    "figure_8_thin_media": Figure(HEAD, thin_media),
    "figure_9_gold": Figure(SKULL, gold),
    "figure_11_convergence": Figure(BRAIN, convergence, columns=5, aspect=0.9),
}


def make(name: str, path: Path, data: Path | None, width: int, samples: int, threads: int) -> dict:
    """Draw one figure and return what it took, one entry per picture."""
    figure = FIGURES[name]
    column = (width - GAP * (figure.columns - 1)) // figure.columns
    shot = Shot((column, round(column * figure.aspect)), samples, threads)
    dressed = dressed_subject(figure.subject, data, shot.size)
    pictures = figure.draw(dressed, shot)
    write_png(path, montage([picture.rgba[..., :3] for picture in pictures]))
    return {
        "preset": dressed.preset,
        "size": shot.size,
        "samples": [p.samples for p in pictures],
        "seconds": [round(p.seconds, 2) for p in pictures],
        "nrms": [round(p.nrms, 4) if p.samples > 1 else None for p in pictures],
    }


def montage(pictures: list[np.ndarray]) -> np.ndarray:
    """Pictures side by side with a white gap between them."""
    gap = np.full((len(pictures[0]), GAP, 3), 255, np.uint8)
    parts = [part for picture in pictures for part in (picture, gap)]
    return np.hstack(parts[:-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("picture", nargs="?", default="paper_figures.png")
    parser.add_argument("--all", metavar="FOLDER", type=Path)
    parser.add_argument("--data", type=Path, default=os.environ.get("VTKMCVR_DATA"))
    parser.add_argument("--only", choices=FIGURES, action="append")
    parser.add_argument("--width", type=int, default=900)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--threads", type=int)
    args = parser.parse_args()
    if args.all is None:
        made = make("figure_11_convergence", Path(args.picture), None, 900, 256, args.threads)
        print(json.dumps(made))
        return
    args.all.mkdir(parents=True, exist_ok=True)
    record = args.all / "figures.json"
    made = json.loads(record.read_text()) if record.exists() else {}
    for name in args.only or FIGURES:
        data = Path(args.data) if args.data else None
        path = args.all / f"{name}.png"
        made[name] = make(name, path, data, args.width, args.samples, args.threads)
        print(name, json.dumps(made[name]), flush=True)
        record.write_text(json.dumps(made, indent=1) + "\n")


if __name__ == "__main__":
    main()
