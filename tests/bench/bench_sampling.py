"""Variance of independent samples over that of Sobol points, by scene and leading dimensions.

    python tests/bench/bench_sampling.py [--pixels N] [--runs N]

Above 1: Sobol points are better. The variance of a pixel is that between runs of different seeds,
summed over pixels and channels. `worst` is the smallest ratio among 5 x 4 parts of the picture,
whose own chance error is given under it. `SE` is the mean square of `standard_error` over the
variance between runs: 1 where it is calibrated.
"""

import argparse
from dataclasses import replace
from types import SimpleNamespace

import numpy as np

import vtkmcvr
from vtkmcvr.front import View, scene_of
from vtkmcvr.plan import plan

SAMPLES = (16,)
# Sets of Sobol points that a path draws, with a lens in the order in which it draws them
DIMENSIONS = {"pixel": 1, "pixel and lens": 2, "and collision": 3, "and light": 16}
PARTS = (4, 5)


def scenes(size):
    """A CT head as its preset shows it, through a lens; soft blob; thin fog; sharp box."""
    head = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(96))
    camera = scene_of(head, preset="ct-bone", size=size, view=View(azimuth=-28)).scene.camera
    camera = replace(camera, lens=vtkmcvr.Lens(0.05 * head.radius))
    looks = SimpleNamespace(vtkmcvr=vtkmcvr, size=size)
    return {
        "CT head, preset": scene_of(head, preset="ct-bone", size=size, camera=camera).scene,
        "soft ball, environment": ball(looks, 4.0, (vtkmcvr.ConstantEnvironment(1.0),)),
        "fog, area light": ball(looks, 0.5, (rectangle(),)),
        "dense ball, lamp": ball(looks, 60.0, (vtkmcvr.PointLight((3, -4, 3), 20.0),)),
    }


def rectangle():
    return vtkmcvr.RectangleLight((2, -2, 2), (0, 0, 0), (1.5, 1.5), 5.0)


def ball(looks, sigma_t, lights):
    """Ball of radius 0.8 with a soft edge, its near side out of focus."""
    z, y, x = np.mgrid[-1:1:33j, -1:1:33j, -1:1:33j]
    values = np.clip((0.9 - np.sqrt(x * x + y * y + z * z)) * 5, 0, 1).astype(np.float32)
    matrix = np.diag([1 / 16, 1 / 16, 1 / 16, 1.0])
    matrix[:3, 3] = -1
    return vtkmcvr.Scene(
        vtkmcvr.Volume(values, matrix),
        vtkmcvr.TransferFunction(
            None,
            vtkmcvr.ColourCurve([(0, 0.9, 0.8, 0.7)]),
            extinction=vtkmcvr.Curve([(0, 0), (1, sigma_t)]),
        ),
        vtkmcvr.Camera((0, -6, 0), (0, 0, 0), view_angle=24, lens=vtkmcvr.Lens(0.3, 6.5)),
        lights=lights,
        size=looks.size,
    )


def sampled(scene, samples, runs, sets):
    """Radiance of runs (runs, H, W, 3) and the mean square of their standard error, (H, W, 3)."""
    planned = plan(replace(scene, sampler="sobol" if sets else "independent"))
    if sets:
        sobol = planned.packed.sobol._replace(sets=np.int64(sets))
        planned = replace(planned, packed=planned.packed._replace(sobol=sobol))
    pictures = [
        vtkmcvr.render_scene(planned, samples=samples, seed=1 + seed) for seed in range(runs)
    ]
    radiance = np.stack([p.film.mean for p in pictures])
    return radiance, np.mean([p.standard_error.astype(float) ** 2 for p in pictures], axis=0)


def by_part(variance):
    """Sums over parts of the picture."""
    rows = np.array_split(variance.sum(axis=-1), PARTS[0], axis=0)
    return np.array([[c.sum() for c in np.array_split(r, PARTS[1], axis=1)] for r in rows])


def compare(scene, samples, runs):
    """Print one line for each set of dimensions."""
    baseline, _ = sampled(scene, samples, runs, 0)
    before = baseline.var(axis=0, ddof=1)
    floor = 1e-3 * by_part(before).max()
    for name, sets in DIMENSIONS.items():
        radiance, error = sampled(scene, samples, runs, sets)
        after = radiance.var(axis=0, ddof=1)
        ratios = by_part(before) / np.maximum(by_part(after), 1e-300)
        worst = ratios[by_part(before) > floor].min()
        print(
            f"{samples:>9}  {name:<16}{before.sum() / after.sum():>8.2f}{worst:>9.2f}"
            f"{error.sum() / after.sum():>8.2f}"
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pixels", type=int, default=40, help="height of the picture")
    parser.add_argument("--runs", type=int, default=16, help="seeds at 256 samples, more below")
    args = parser.parse_args()
    size = (args.pixels * 5 // 4, args.pixels)
    chance = np.sqrt(4 / (args.pixels**2 * 5 / 4 / 20) / (args.runs - 1))
    for name, scene in scenes(size).items():
        print(f"\n{name}: {size[0]} x {size[1]}, chance error of worst about {chance:.0%}")
        print(f"{'samples':>9}  {'dimensions':<16}{'ratio':>8}{'worst':>9}{'SE':>8}")
        for samples in SAMPLES:
            compare(scene, samples, args.runs)


if __name__ == "__main__":
    main()
