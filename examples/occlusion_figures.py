"""Figures 2 and 5 of "Directional Occlusion Shading" (2009), of any volume or the synthetic head.

python examples/occlusion_figures.py OUT.png [VOLUME] [SIZE]

Top row, as figure 2: isotropic Monte Carlo, Monte Carlo with an 80-degree cone, occlusion. Below,
as figure 5: theta 50, then 85; paper mode with 2 x 2 and with 13 x 13 samples, default mode.
"""

import sys
from dataclasses import replace

import numpy as np

import vtkmcvr
from vtkmcvr.phases import Cone, Isotropic
from vtkmcvr.pictures.files import write_png

SKY = (vtkmcvr.ConstantEnvironment(1.0),)
WHITE = vtkmcvr.Display(exposure=0.5, background=(1.0, 1.0, 1.0))


def main(out: str, path: str | None = None, size: str = "96") -> None:
    volume = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(64)) if path is None else None
    data = volume or vtkmcvr.read(path)
    pixels = int(size)
    scene = vtkmcvr.scene_of(data, size=(pixels, pixels), lights=SKY, surface=None).scene

    def occlusion(theta, mode="default", **settings):
        chosen = vtkmcvr.Occlusion(theta, mode, **settings)
        return vtkmcvr.render_occlusion(scene, chosen).show(WHITE)

    def traced(phase):
        return vtkmcvr.render_scene(replace(scene, phase=phase), samples=128).show(WHITE)

    rows = [[traced(Isotropic()), traced(Cone(80)), occlusion(80)]]
    for theta in (50, 85):
        coarse, fine = (occlusion(theta, "paper", grid=n) for n in (2, 13))
        rows.append([coarse, fine, occlusion(theta)])
    write_png(out, np.vstack([np.hstack(row) for row in rows]))


if __name__ == "__main__":
    main(*sys.argv[1:])
