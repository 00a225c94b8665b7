"""Time of a camera path against the bare look-ups that it makes, threads, size, estimates a second.

    python tests/bench/bench_floor.py [--size 160x120] [--rounds 5] [--largest 1024] [--json FILE]

The floor of a scene: the positions at which its paths look up the volume are written down, in order
(by the kernels' own sources as plain Python), and looked up again by a loop that does nothing else.
Positions are few enough to stay in the caches, which makes the floor lower than it is in a picture.
A second floor adds what paths read of majorants and of the transfer function's tables.
The least processor time of the rounds counts. Estimates are whole 800 x 600 pictures of one sample
on all CPUs, by the clock. Volumes come from VTKMCVR_DATA; without it, the synthetic head alone.
"""

import argparse
import json
import os
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import numba
import numpy as np
from bench_effects import SUBJECTS, subject

import vtkmcvr
from vtkmcvr.costs.study import machine
from vtkmcvr.front import scene_of
from vtkmcvr.kernels.grid import trilinear
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film, render_scene
from vtkmcvr.schedule import default_threads
from vtkmcvr.work.sources import DECORATORS, load_kernels

# Film whose look-ups are written down
RECORDED = (80, 60)


@numba.njit(error_model="numpy", fastmath=True, nogil=True)
def look_up(values, positions):
    """Sum of the scalars at index positions (n, 3)."""
    total = np.float32(0)
    for i in range(len(positions)):
        total += trilinear(values, (positions[i, 0], positions[i, 1], positions[i, 2]))
    return total


@numba.njit(error_model="numpy", fastmath=True, nogil=True)
def read(table, places):
    """Sum of the entries of a flat table at some places."""
    total = np.float32(0)
    for i in range(len(places)):
        total += table[places[i]]
    return total


class Watched(np.ndarray):
    """Table that writes down the places, flat, at which it is read."""

    def __array_finalize__(self, other):
        self.places = getattr(other, "places", [])

    def __getitem__(self, place):
        indices = place if isinstance(place, tuple) else (place,)
        flat = 0
        for i, n in zip(indices, self.shape, strict=True):
            flat = flat * n + int(i)
        self.places.append(flat)
        return super().__getitem__(place)

    def again(self):
        """Table without a watch, flat, and the places."""
        return np.asarray(self).ravel(), np.array(self.places, np.int64)


def watched(packed):
    """Packed scene whose majorants and tables are watched, and those arrays."""
    tables = [
        array.view(Watched)
        for array in (packed.medium.majorant, packed.transfer.sigma_t, packed.transfer.colour)
    ]
    for table in tables:
        table.places = []
    majorant, sigma_t, colour = tables
    medium = packed.medium._replace(majorant=majorant)
    transfer = packed.transfer._replace(sigma_t=sigma_t, colour=colour)
    return packed._replace(medium=medium, transfer=transfer), tables


def recorded(scene):
    """What one sample of every pixel of a small film looks up, and its paths.

    Returns (positions in the volume (n, 3), watched tables, number of paths).
    """
    positions = []

    def decorator(function):
        if function.__name__ != "trilinear":
            return function
        return lambda values, p: positions.append(p) or function(values, p)

    planned = plan(replace(scene, size=RECORDED))
    film = empty_film(planned)
    goal = np.ones_like(film.count)
    packed, tables = watched(planned.packed)
    with np.errstate(all="ignore"):
        kernels = load_kernels("cpu", dict.fromkeys(DECORATORS, decorator))
        kernels.render_tile(film, packed, 0, RECORDED[1], 0, RECORDED[0], goal, 0)
    return np.array(positions, np.float32), tables, film.count.size


def least(rounds, work):
    """Least processor time of a few calls, after one that may compile."""
    work()
    taken = []
    for _ in range(rounds):
        start = time.process_time()
        work()
        taken.append(time.process_time() - start)
    return min(taken)


def repeated(rounds, n, work):
    """Least processor time of what goes through n entries, of calls that are long enough."""
    repeats = max(1, 2_000_000 // n)
    return least(rounds, lambda: [work() for _ in range(repeats)]) / repeats


def path_seconds(scene, rounds, samples=64):
    """Processor time of a path, one thread; what a picture takes once is little beside so many."""
    planned = plan(scene)
    spent = least(rounds, lambda: render_scene(planned, samples=samples, threads=1, backend="cpu"))
    return spent / (scene.size[0] * scene.size[1] * samples)


def against_floor(scene, rounds):
    """Time of a path, its look-ups, and what they take alone."""
    positions, tables, paths = recorded(scene)
    values = plan(scene).packed.medium.values
    floor = repeated(rounds, len(positions), lambda: look_up(values, positions)) / paths
    seconds, all_of_them = path_seconds(scene, rounds), floor
    for table in tables:
        flat, places = table.again()
        all_of_them += repeated(rounds, len(places), partial(read, flat, places)) / paths
    return {
        "path_ns": 1e9 * seconds, "lookups": len(positions) / paths,
        "lookup_ns": 1e9 * floor * paths / len(positions), "floor_ns": 1e9 * floor,
        "over_floor": seconds / floor,
        "table_reads": sum(len(table.places) for table in tables) / paths,
        "floor_with_tables_ns": 1e9 * all_of_them, "over_floor_with_tables": seconds / all_of_them,
    }  # fmt: skip


def by_threads(scene, rounds):
    """Speed of two threads over that of one, by the clock."""
    planned = plan(scene)
    best = {}
    for threads in (1, 2) * rounds:
        done = render_scene(planned, samples=16, threads=threads, backend="cpu")
        best[threads] = min(best.get(threads, np.inf), done.seconds)
    return best[1] / best[2]


def estimates(scene, rounds):
    """Pictures of one sample a second, 800 x 600, all CPUs."""
    planned = plan(replace(scene, size=(800, 600)))
    done = [render_scene(planned, samples=4, backend="cpu").seconds / 4 for _ in range(rounds)]
    return 1 / min(done)


def grown(edge):
    """The synthetic head at 256 points an edge, and the same one with `edge` points."""
    head = vtkmcvr.head_phantom(256)
    small = vtkmcvr.Volume.from_grid(*head)
    share = np.linspace(0, 255, edge)
    nearest = np.rint(share).astype(int)
    values = head.values[np.ix_(nearest, nearest, nearest)]
    spacing = tuple(s * 255 / (edge - 1) for s in head.spacing)
    return small, vtkmcvr.Volume.from_grid(values, spacing, head.origin)


def by_size(edge, rounds, size):
    """Time of a path in the larger volume over that in the smaller one, same view and look."""
    small, large = grown(edge)
    scene = scene_of(small, preset="solid", size=size).scene
    taken = [path_seconds(replace(scene, volume=volume), rounds) for volume in (small, large)]
    return taken[1] / taken[0]


def scenes(size):
    """Name and scene of each volume that is there: a look with its environment and area lights."""
    data = os.environ.get("VTKMCVR_DATA")
    for name in SUBJECTS if data else ():
        yield name, subject(name, Path(data), size).scene
    head = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(192))
    yield "synthetic head", scene_of(head, preset="ct-bone", size=size).scene


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--largest", type=int, default=1024, help="points an edge; 0: leave out")
    parser.add_argument("--json", type=Path, help="write everything measured here")
    args = parser.parse_args()
    size = tuple(int(x) for x in args.size.split("x"))
    facts = {"machine": machine(), "scenes": {}}
    print(f"{facts['machine']['processor']}, {default_threads()} CPUs")
    titles = "ns/path  look-ups  ns/look-up  floor ns  over floor  reads  with them  over both"
    titles += "  2 threads  estimates/s"
    print(f"{'':16}{titles}")
    for name, scene in scenes(size):
        row = against_floor(scene, args.rounds)
        row["two_threads"], row["estimates"] = (
            by_threads(replace(scene, size=(400, 300)), args.rounds), estimates(scene, args.rounds)
        )  # fmt: skip
        facts["scenes"][name] = row
        print(
            f"{name:16}{row['path_ns']:7.0f}{row['lookups']:10.1f}{row['lookup_ns']:12.1f}"
            f"{row['floor_ns']:10.0f}{row['over_floor']:12.2f}{row['table_reads']:7.1f}"
            f"{row['floor_with_tables_ns']:11.0f}{row['over_floor_with_tables']:11.2f}"
            f"{row['two_threads']:11.2f}"
            f"{row['estimates']:13.1f}",
            flush=True,
        )
    if args.largest:
        facts["growth"] = by_size(args.largest, args.rounds, size)
        print(f"a path in {args.largest}^3 over one in 256^3: {facts['growth']:.2f}")
    if args.json:
        args.json.write_text(json.dumps(facts, indent=1) + "\n")


if __name__ == "__main__":
    main()
