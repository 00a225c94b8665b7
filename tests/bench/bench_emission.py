"""Ways to estimate a ray's emission, at equal cost, against the one that is used.

    python tests/bench/bench_emission.py [--rays 12] [--samples 1500]

A ray needs one walk of delta tracking for its scattering point. Emission can be read (a) at that
point alone, as here; (b) at all tentative collisions up to it, each in its expectation; (c) by a
walk of its own to the end of the ray, in which the transmittance weights all tentative collisions
(ratio tracking, Russian roulette below 0.3). Printed are variances over that of (a), and for (c)
the variance times the tentative collisions of both walks. Rays go through the neghip volume of
VTKMCVR_DATA, of four densities, with maxima of cells half as high again as those on the ray.
"""

import argparse
import os
from pathlib import Path

import numpy as np
from scipy.ndimage import map_coordinates

import vtkmcvr
from vtkmcvr.vtk_bridge.scene import volume_of

CELL, PER_VOXEL, LOOSE, ROULETTE = 8, 16, 1.5, 0.3
DENSITIES = (0.02, 0.1, 0.5, 3.0)


def profile(values, y, x, density):
    """Extinction and emitted radiance along a ray, PER_VOXEL entries a voxel."""
    n = len(values)
    s = np.linspace(0, n - 1, (n - 1) * PER_VOXEL + 1)
    v = map_coordinates(values, [s, np.full_like(s, y), np.full_like(s, x)], order=1)
    return density * np.clip((v - 0.15) / 0.4, 0, 1) ** 1.5, np.clip((v - 0.2) / 0.5, 0, 1) ** 2


def tentative(majorants, end, rng):
    """Distance and majorant of each tentative collision along the ray."""
    t, cell, tau = 0.0, 0, rng.exponential()
    while cell < len(majorants):
        leave = min((cell + 1) * CELL, end)
        reach = (leave - t) * majorants[cell]
        if tau >= reach:
            tau, t, cell = tau - reach, leave, cell + 1
            continue
        t += tau / majorants[cell]
        tau = rng.exponential()
        yield t, majorants[cell]


def one_sample(sigma_t, radiance, majorants, end, rng):
    """Estimates (a), (b), (c), and tentative collisions of either walk."""
    a = b = c = 0.0
    through, steps, more = 1.0, 0, 0
    walking = True
    for t, majorant in tentative(majorants, end, rng):
        at = int(t * PER_VOXEL)
        share, L = sigma_t[at] / majorant, radiance[at]
        if walking:
            steps += 1
            b += L * share
            if rng.random() < share:
                a, walking = L, False
        if through > 0:
            more += 1
            c += through * L * share
            through *= 1 - share
            if through < ROULETTE:
                through = ROULETTE if rng.random() * ROULETTE < through else 0.0
        if not walking and through == 0:
            break
    return a, b, c, steps, more


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rays", type=int, default=12)
    parser.add_argument("--samples", type=int, default=1500)
    args = parser.parse_args()
    data = Path(os.environ["VTKMCVR_DATA"])
    values = volume_of(vtkmcvr.read(data / "scivis/neghip.slc")).values.astype(float)
    values /= values.max()
    end, rng = len(values) - 1, np.random.default_rng(1)
    print("density  collisions   (a)   (b)   (c)   (c) at equal cost")
    for density in DENSITIES:
        variance, steps = np.zeros(3), np.zeros(2)
        for _ in range(args.rays):
            sigma_t, radiance = profile(values, *rng.uniform(15, 50, 2), density)
            cells = range(0, end, CELL)
            majorants = [
                LOOSE * sigma_t[k * PER_VOXEL : (k + CELL) * PER_VOXEL + 1].max() + 1e-9
                for k in cells
            ]
            found = np.array([
                one_sample(sigma_t, radiance, majorants, end, rng) for _ in range(args.samples)
            ])  # fmt: skip
            variance += found[:, :3].var(0)
            steps += found[:, 3:].mean(0)
        a, b, c = variance / variance[0]
        equal = c * steps.sum() / steps[0]
        print(f"{density:7}  {steps[0] / args.rays:10.1f}  {a:.2f}  {b:.2f}  {c:.2f}  {equal:.2f}")


if __name__ == "__main__":
    main()
