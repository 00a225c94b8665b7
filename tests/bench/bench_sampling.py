"""Variance of independent samples over that of Sobol points, by scene and leading dimensions.

    python tests/bench/bench_sampling.py [--pixels N] [--runs N]

Above 1: Sobol points are better. The variance of a pixel is that between runs of different seeds,
summed over pixels and channels. `worst` is the ratio in that of 5 x 4 parts of the picture where
independent samples are better with the greatest certainty (or Sobol points better with the least),
`z` its logarithm in standard errors, by the jackknife over runs: chance alone makes one of 20 parts
fall to about -2. `SE` is the mean square of `standard_error` over the variance between runs: 1
where it is calibrated. Below two batches of 16 samples it is an upper estimate.
"""

import argparse
from dataclasses import replace
from types import SimpleNamespace

import numpy as np

import vtkmcvr
from vtkmcvr.front import View, scene_of
from vtkmcvr.plan import plan

SAMPLES = (16, 64, 256)
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


def by_part(radiance):
    """Variance between runs, summed over parts of the picture, (4, 5)."""
    variance = radiance.var(axis=0, ddof=1).sum(axis=-1)
    rows = np.array_split(variance, PARTS[0], axis=0)
    return np.array([[c.sum() for c in np.array_split(r, PARTS[1], axis=1)] for r in rows])


def left_out(radiance):
    """Logarithms of `by_part` without each of the runs, (runs, 4, 5)."""
    runs = range(len(radiance))
    return np.stack([np.log(by_part(np.delete(radiance, i, axis=0)) + 1e-300) for i in runs])


def worst_part(before, after):
    """Ratio of variances in the part with the least z, and z."""
    n = len(before)
    spread = sum((n - 1) ** 2 / n * left_out(x).var(axis=0, ddof=1) for x in (before, after))
    variances = by_part(before), by_part(after)
    lit = variances[0] > 1e-3 * variances[0].max()
    ratio = variances[0][lit] / variances[1][lit]
    z = np.log(ratio) / np.sqrt(spread[lit])
    return ratio[z.argmin()], z.min()


def compare(scene, samples, runs):
    """Print one line for each set of dimensions."""
    baseline, _ = sampled(scene, samples, runs, 0)
    for name, sets in DIMENSIONS.items():
        radiance, error = sampled(scene, samples, runs, sets)
        after = radiance.var(axis=0, ddof=1).sum()
        ratio = baseline.var(axis=0, ddof=1).sum() / after
        worst, z = worst_part(baseline, radiance)
        calibration = error.sum() / after
        print(f"{samples:>9}  {name:<16}{ratio:>8.2f}{worst:>9.2f}{z:>7.1f}{calibration:>8.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pixels", type=int, default=40, help="height of the picture")
    parser.add_argument("--runs", type=int, default=16, help="seeds of each picture")
    args = parser.parse_args()
    size = (args.pixels * 5 // 4, args.pixels)
    for name, scene in scenes(size).items():
        print(f"\n{name}: {size[0]} x {size[1]}, {args.runs} runs")
        print(f"{'samples':>9}  {'dimensions':<16}{'ratio':>8}{'worst':>9}{'z':>7}{'SE':>8}")
        for samples in SAMPLES:
            compare(scene, samples, args.runs)


if __name__ == "__main__":
    main()
