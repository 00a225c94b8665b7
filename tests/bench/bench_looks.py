"""Camera paths per second of a look, what each effect takes of it, and the best macrocell edge.

    python tests/bench/bench_looks.py [VOLUME [--preset NAME] [--flip AXES]] [--size WxH]

Without a volume: the synthetic CT head. Rates are medians over repeats that alternate between the
variants, on all CPUs of the process; compilation is left out.
"""

import argparse
import platform
import statistics
from dataclasses import replace

import vtkmcvr
from vtkmcvr import schedule, voxels
from vtkmcvr.front import View, scene_of
from vtkmcvr.plan import plan
from vtkmcvr.vtk_bridge.scene import volume_of

CELL_EDGES = (2, 3, 4, 6, 8)


def variants(scene):
    """The scene, the scene without one of its effects each time, and with another transport."""
    lights = scene.lights
    area = tuple(x for x in lights if isinstance(x, vtkmcvr.RectangleLight))
    return {
        "as it is": scene,
        "no shadows": replace(scene, shadow_reach=0.0),
        "shadows seen or not": replace(scene, ratio_tracking=False),
        "no specular coat": replace(scene, surface=replace(scene.surface, specular=0.0)),
        "no surfaces": replace(scene, surface=None),
        "environment only": replace(scene, lights=tuple(x for x in lights if x not in area)),
        "area lights only": replace(scene, lights=area),
        "multiple scattering": replace(scene, scattering="multiple"),
        "one global majorant": replace(scene, estimator="woodcock"),
        "no lights": replace(scene, lights=()),
        "no lights, no surfaces": replace(scene, lights=(), surface=None),
    }


def rates(plans, samples, repeats):
    """Median paths per second of each plan, and its NRMS."""
    measured = {name: [] for name in plans}
    for _ in range(repeats):
        for name, planned in plans.items():
            picture = vtkmcvr.render_scene(planned, samples=samples)
            measured[name].append((picture.paths_per_second, picture.nrms))
    return {
        name: tuple(statistics.median(column) for column in zip(*rows, strict=True))
        for name, rows in measured.items()
    }


def plan_with_cells(scene, edge):
    """The scene's plan over macrocells of another edge."""
    before = voxels.SMALLEST_CELL, voxels.MOST_CELLS
    try:
        voxels.SMALLEST_CELL, voxels.MOST_CELLS = edge, 2**40
        return plan(replace(scene, volume=replace(scene.volume)))
    finally:
        voxels.SMALLEST_CELL, voxels.MOST_CELLS = before


def show(title, results):
    print(f"\n{title:<26}{'M paths/s':>10}{'share':>8}{'NRMS':>9}{'variance x time':>17}")
    best = next(iter(results.values()))
    for name, (rate, nrms) in results.items():
        cost = nrms**2 / rate / (best[1] ** 2 / best[0]) if nrms else 0.0
        print(f"{name:<26}{rate / 1e6:>10.2f}{best[0] / rate:>8.2f}{nrms:>9.3f}{cost:>17.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("volume", nargs="?")
    parser.add_argument("--preset", default="ct-bone")
    parser.add_argument("--flip")
    parser.add_argument("--size", default="512x512")
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--repeats", type=int, default=3)
    args = parser.parse_args()
    if args.volume:
        volume = volume_of(vtkmcvr.read(args.volume))
    else:
        volume = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(192))
    volume = volume.flipped(args.flip) if args.flip else volume
    size = tuple(int(x) for x in args.size.split("x"))
    scene = scene_of(volume, preset=args.preset, size=size, view=View(azimuth=-28)).scene
    print(f"{platform.processor() or platform.machine()}, {schedule.default_threads()} threads,")
    print(f"{volume.shape} {volume.values.dtype}, {args.preset}, {size}, {args.samples} samples")
    plans = {name: plan(variant) for name, variant in variants(scene).items()}
    rates(plans, 1, 1)  # compile
    show("effect", rates(plans, args.samples, args.repeats))
    edges = {f"macrocells of {e} voxels": plan_with_cells(scene, e) for e in CELL_EDGES}
    show("macrocell edge", rates(edges, args.samples, args.repeats))


if __name__ == "__main__":
    main()
