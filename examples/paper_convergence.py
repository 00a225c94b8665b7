"""Error against samples, as in Figure 11 of Exposure Render, for `paper_figures.py`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from paper_scenes import BRAIN, ENGINE, MAN, SKULL, Stage, stage_of

import vtkmcvr

SIZE = (160, 120)
SAMPLES = (4, 8, 16, 32, 64, 128, 256)
Curves = dict[str, dict[str, list[float]]]


def curves(data: Path | None, threads: int | None) -> Curves:
    """Estimated NRMS at each of `SAMPLES`, by panel and curve."""
    found: Curves = {}
    for panel, name, scene in scenes(data):
        found.setdefault(panel, {})[name] = errors(scene, threads)
    return found


def scenes(data: Path | None) -> Iterator[tuple[str, str, vtkmcvr.Scene]]:
    """Volumes in their looks; a skull by three apertures; an engine under up to 64 lights."""
    subjects = {"CT head": SKULL, "engine": ENGINE, "brain": BRAIN, "head": MAN}
    stages = {name: stage_of(subject, data, SIZE) for name, subject in subjects.items()}
    for name, stage in stages.items():
        yield "volumes", name, stage.scene
    skull = stages["CT head"].scene
    for name, share in (("pinhole", 0.0), ("medium aperture", 0.03), ("large aperture", 0.1)):
        lens = vtkmcvr.Lens(share * skull.camera.distance)
        yield "apertures", name, replace(skull, camera=replace(skull.camera, lens=lens))
    for n in (1, 4, 16, 64):
        lights = ring(stages["engine"], n)
        yield "lights", f"{n} light{'s' * (n > 1)}", replace(stages["engine"].scene, lights=lights)


def ring(stage: Stage, n: int) -> tuple:
    """Panels in a ring about the camera's view, together as bright as one."""
    scene = stage.scene
    right, up, forward = scene.camera.frame
    centre, radius = scene.volume.centre, scene.volume.radius
    # Apart from each other, since panels block light
    edge = min(0.5, 6.0 / n) * radius
    lights = []
    for phi in 2 * np.pi * (np.arange(n) + 0.37) / n:
        way = 0.8 * (np.cos(phi) * right + np.sin(phi) * up) - 0.6 * forward
        panel = vtkmcvr.RectangleLight(
            tuple(centre + 2.6 * radius * way), tuple(centre), (edge,) * 2
        )
        lights.append(vtkmcvr.with_irradiance(panel, 8.0 / n, centre))
    return tuple(lights)


def errors(scene: vtkmcvr.Scene, threads: int | None) -> list[float]:
    """NRMS of a picture as it is refined."""
    picture = vtkmcvr.render(scene, samples=SAMPLES[0], threads=threads)
    found = [picture.nrms]
    for samples in SAMPLES[1:]:
        picture = picture.refine(samples=samples)
        found.append(picture.nrms)
    return [round(float(x), 5) for x in found]


def plot(found: Curves, width: int, height: int) -> np.ndarray:
    """The panels side by side, (height, width, 3) bytes; needs matplotlib (`vtkmcvr[plot]`)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width / 100, height / 100), dpi=100, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    for axes, (panel, lines) in zip(
        figure.subplots(1, len(found), sharey=True), found.items(), strict=True
    ):
        for name, nrms in lines.items():
            axes.loglog(SAMPLES, nrms, marker=".", label=name, linewidth=1.2)
        axes.axhline(0.1, color="0.6", linewidth=0.8, linestyle=":")
        axes.set(title=panel, xlabel="samples per pixel", xticks=SAMPLES)
        axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
        axes.minorticks_off()
        axes.legend(fontsize=8, frameon=False)
        axes.grid(alpha=0.25)
    figure.axes[0].set(ylabel="NRMS", yticks=(0.05, 0.1, 0.2, 0.5))
    figure.axes[0].yaxis.set_major_formatter(lambda y, _: f"{100 * y:g} %")
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]
