"""Figures 2 and 5 of "Directional Occlusion Shading" (2009), on any volume.

python examples/occlusion_figures.py VOLUME [FOLDER] [SIZE]

figure_2.png: isotropic Monte Carlo, Monte Carlo with an 80-degree cone, directional occlusion.
figure_5.png: theta 50 (above) and 85 (below); paper mode with 2 x 2 and 13 x 13 samples, default.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import vtkmcvr
from vtkmcvr.phases import Cone, Isotropic
from vtkmcvr.picture_files import write_png

SKY = (vtkmcvr.ConstantEnvironment(1.0),)


def main(volume: str, folder: str = ".", size: str = "320") -> None:
    pixels = int(size)
    dressed = vtkmcvr.scene_of(
        vtkmcvr.read(volume), size=(pixels, pixels), lights=SKY, surface=None
    )
    scene = dressed.scene
    white = vtkmcvr.Display(exposure=0.5, background=(1.0, 1.0, 1.0))

    def occlusion(theta, mode="default", **settings):
        chosen = vtkmcvr.Occlusion(theta, mode, **settings)
        return vtkmcvr.render_occlusion(scene, chosen).show(white)

    def traced(phase):
        lit = replace(scene, phase=phase)
        return vtkmcvr.render_scene(lit, samples=128).show(white)

    figure_2 = [traced(Isotropic()), traced(Cone(80)), occlusion(80)]
    write_png(Path(folder, "figure_2.png"), np.hstack(figure_2))
    figure_5 = [
        np.hstack(
            [
                occlusion(theta, "paper", grid=2),
                occlusion(theta, "paper", grid=13),
                occlusion(theta),
            ]
        )
        for theta in (50, 85)
    ]
    write_png(Path(folder, "figure_5.png"), np.vstack(figure_5))


if __name__ == "__main__":
    main(*sys.argv[1:])
