"""What more lights cost: time per camera path and variance for 1, 2, 4, ... 64 lights.

    python tests/bench/bench_lights.py [--size 120x90] [--samples 16] [--rounds 5]

The same volume under n disks spread over a dome, together as bright as one. All scenes are rendered
in each round, one after the other, on one thread; the smallest CPU time of the rounds counts.
Ratios to one light are printed: time per path, variance of the picture at equal samples, and their
product, the time to equal error. "even" is the variance where lights are chosen at random, without
the tree's estimates, for comparison.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.lights import DiskLight, PointLight, with_irradiance
from vtkmcvr.phantom import head_phantom
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Scene, Surface, TransferFunction, Volume
from vtkmcvr.studio import view_camera

COUNTS = (1, 2, 4, 8, 16, 64)
MATERIAL = TransferFunction(
    Curve([(-400.0, 0.0), (-100.0, 0.2), (150.0, 0.4), (250.0, 1.0)]),
    ColourCurve([(-400.0, 0.8, 0.5, 0.4), (150.0, 0.9, 0.7, 0.6), (300.0, 0.95, 0.93, 0.88)]),
)


def dome(n, volume, kind):
    """n lights on a half sphere around the volume, in a spiral; from the second on, of 4 powers."""
    golden = np.pi * (3 - np.sqrt(5))
    lights = []
    for i in range(n):
        z = 0.3 + 0.6 * (i + 0.5) / n
        ring, phi = np.sqrt(1 - z * z), golden * i - 2.0
        place = volume.centre + 2.5 * volume.radius * np.array(
            (ring * np.cos(phi), ring * np.sin(phi), z)
        )
        share = (1.0, 0.3, 2.0, 0.7)[i % 4]
        if kind == "disks":
            light = DiskLight(tuple(place), tuple(volume.centre), 0.3 * volume.radius)
        else:
            light = PointLight(tuple(place))
        lights.append(with_irradiance(light, 5.0 * share, volume.centre))
    total = sum((1.0, 0.3, 2.0, 0.7)[i % 4] for i in range(n))
    return tuple(light.with_brightness(np.array(light.brightness) / total) for light in lights)


def variance(picture):
    """Mean over the pixels of the variance of one sample."""
    film = picture.film
    return float((film.m2[..., 1] / (film.count - 1)).mean())


def evenly(planned):
    """The same plan with estimates that tell nothing: each light has the same chance everywhere."""
    lights = planned.packed.all_lights
    if lights.few is not None:
        even = tuple(
            node._replace(flux=np.float32(i < lights.number), law=np.int32(3))
            for i, node in enumerate(lights.few)
        )
        return replace(
            planned, packed=planned.packed._replace(all_lights=lights._replace(few=even))
        )
    tree = lights.tree
    ends = [row[2] >= 0 for row in tree.links]
    inside = [sum(ends[k : row[0]]) for k, row in enumerate(tree.links)]
    flux, law = np.array(inside, np.float32), np.full_like(tree.law, 3)
    flat = tree._replace(flux=flux, law=law)
    flat = lights._replace(tree=flat)
    return replace(planned, packed=planned.packed._replace(all_lights=flat))


def measure(kind, surface, volume, size, samples, rounds):
    base = Scene(volume, MATERIAL, view_camera(volume), surface=surface, size=size)
    plans = [plan(replace(base, lights=dome(n, volume, kind))) for n in COUNTS]
    seconds = np.full(len(COUNTS), np.inf)
    for planned in plans:
        render_scene(planned, samples=1, threads=1)
    for _ in range(rounds):
        for k, planned in enumerate(plans):
            start = time.process_time()
            picture = render_scene(planned, samples=samples, threads=1)
            seconds[k] = min(seconds[k], time.process_time() - start)
    spread = [variance(render_scene(p, samples=4 * samples, seed=2, threads=1)) for p in plans]
    even = [
        variance(render_scene(evenly(p), samples=4 * samples, seed=2, threads=1)) for p in plans
    ]
    paths = size[0] * size[1] * samples
    hit = picture.film.hits.sum() / picture.film.count.sum()
    what = "phase function" if surface is None else "hybrid surfaces"
    print(f"\n{kind}, {what}; {hit:.0%} of the paths scatter")
    print("lights  ns/path   time  variance  time to equal error  variance when chosen evenly")
    for k, n in enumerate(COUNTS):
        t, v = seconds[k] / seconds[0], spread[k] / spread[0]
        print(
            f"{n:6d}  {1e9 * seconds[k] / paths:7.0f}  {t:5.2f}  {v:8.2f}  {t * v:19.2f}  "
            f"{even[k] / spread[0]:27.2f}"
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="120x90")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--rounds", type=int, default=5)
    args = parser.parse_args()
    size = tuple(int(x) for x in args.size.split("x"))
    volume = Volume.from_grid(*head_phantom(96))
    for kind in ("disks", "points"):
        for surface in (None, Surface(0.7)):
            measure(kind, surface, volume, size, args.samples, args.rounds)


if __name__ == "__main__":
    main()
