"""Scenes of directional occlusion that tests of the CUDA backend sweep."""

import os
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from scenes import blob, frontal, medium, noise, scene, volume

from vtkmcvr.cutting import Plane
from vtkmcvr.gpu.device import _rebuilt
from vtkmcvr.layers import Layer
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.occlusion import Occlusion
from vtkmcvr.occlusion.rendering import layout, parts_of
from vtkmcvr.occlusion.tables import tables_of
from vtkmcvr.scene import Camera, Surface

PROGRAM = Path(__file__).parents[1] / "cuda_occlusion.py"
# So far away that directions go evenly over several segments
FAR = Camera((0, -125, 0), (0, 0, 0), view_angle=1)
NEAR = Camera((0, -5, 0), (0, 0, 0), view_angle=22)
GOLD = medium(6.0, (0.9, 0.6, 0.3))
PLAIN = scene(blob(9), GOLD, NEAR, size=(8, 6))


def holes():
    values = blob(9).values.copy()
    values[4, 4, :3] = np.nan
    values[2:4, 5, 5] = np.inf, -np.inf
    return volume(values, (0.25,) * 3)


# So many directions that faint stretches get fewer; a block of layers, another and a half
DEFAULT = Occlusion(directions=24, slices=18)
# One scene: what it takes to compile for the CPU
MODES = {
    "default": (PLAIN, DEFAULT),
    "fast": (PLAIN, Occlusion(mode="fast", slices=18)),
    "paper": (PLAIN, Occlusion(mode="paper", grid=3, slices=10)),
}
WALL = (
    scene(volume(np.ones((9, 9, 9)), (0.25,) * 3), medium(200.0), replace(NEAR, view_angle=8),
          size=(8, 6)),
    Occlusion(mode="paper", grid=3, slices=33),
)  # fmt: skip
MORE = {
    "far away, shaded, albedo and normal, clipped": (
        scene(
            blob(9), GOLD, FAR, size=(8, 6), aovs=("albedo", "normal"), surface=Surface(0.9),
            clip=(Plane((0, 0, 0), (1, 0, 0)),), lights=(ConstantEnvironment(1.0),),
        ),
        Occlusion(directions=6, slices=18, shaded=True),
    ),
    "coloured light from the side in a parallel view": (
        scene(blob(9), GOLD, frontal(0.9), size=(8, 6)),
        Occlusion(directions=6, slices=18, bleeding=0.7, toward_light=(0.5, -1, 0.5)),
    ),
    "two volumes": (
        scene(blob(9), GOLD, NEAR, size=(8, 6), layers=(Layer(noise(5), medium(1.0)),)),
        Occlusion(directions=3, slices=10),
    ),
    "fast, coloured": (PLAIN, Occlusion(mode="fast", slices=18, bleeding=1.0)),
    "paper, exact distances": (
        PLAIN, Occlusion(mode="paper", grid=3, slices=10, exact_distance=True)
    ),
    "nothing skipped": (PLAIN, Occlusion(directions=3, slices=10, skip=False)),
    "HC-09 extinction of 1e12": (
        scene(blob(9), medium(1e12), NEAR, size=(8, 6)), Occlusion(directions=3, slices=10)
    ),
    "HC-15 NaN and infinite voxels": (
        scene(holes(), GOLD, NEAR, size=(8, 6)), Occlusion(directions=3, slices=10)
    ),
    "the eye inside": (
        scene(blob(9), medium(1.0), Camera((0, 0, 0), (0, 1, 0), view_angle=60), size=(8, 6)),
        Occlusion(directions=3, slices=10),
    ),
}  # fmt: skip


def parts(described, settings):
    """What a sweep takes."""
    planned, raster, _ = layout(described, settings)
    return parts_of(described, planned, raster, settings)


def simulated(jobs, folder, program=PROGRAM):
    """What sweeps, or what another program takes, give in Numba's CUDA simulator."""
    (folder / "jobs").write_bytes(pickle.dumps(jobs))
    subprocess.run(
        [sys.executable, program, folder / "jobs", folder / "films"],
        env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1",
             # Hard cases have infinities
             "PYTHONWARNINGS": "ignore::RuntimeWarning"},
        check=True, timeout=500,
    )  # fmt: skip
    return pickle.loads((folder / "films").read_bytes())


def dense(part):
    """Tables whose arrays have memory of their own, as those on a device."""
    if isinstance(part, np.ndarray):
        return np.ascontiguousarray(part)
    return _rebuilt(part, dense) if isinstance(part, tuple) else part


def dense_tables(described, settings):
    """Arguments of a sweep but for the numbers of its blocks."""
    return dense(tables_of(*parts(described, settings)))
