"""Paths in step: beside paths one by one, what dark pixels save, and the share of each stage.

    python tests/bench/bench_step.py [--size 160x120] [--rounds 5] [--json FILE]

Nanoseconds of the processor a path, one thread, the least of rounds in which the launchers take
turns; single and multiple scattering. Dark pixels are those that `vtkmcvr.outline` knows to be
black: how many there are, of 800 x 600, and how long it takes to know them. Volumes come from
VTKMCVR_DATA; without it, the synthetic head alone.
"""

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from bench_floor import scenes

from vtkmcvr import outline
from vtkmcvr.costs.study import machine
from vtkmcvr.kernels.cpu import render_tile as one_by_one
from vtkmcvr.kernels.launch import way_in
from vtkmcvr.kernels.program import Due, place, program, run, steps_of
from vtkmcvr.kernels.room import LIVE, TAKEN, new_room
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film

SAMPLES = 32
KINDS = ("one by one", "in step", "in step, without dark pixels")


def due(planned, samples, without_dark):
    """Film, and what is due of it."""
    film = empty_film(planned)
    shape = film.count.shape
    dark = outline.dark_pixels(planned.packed, shape) if without_dark else np.zeros(shape, np.bool_)
    return film, Due(np.full_like(film.count, samples), dark, np.int64(0))


def turn(planned, kind, samples, room):
    """Seconds of the processor that all paths of a picture take."""
    film, asked = due(planned, samples, kind == KINDS[2])
    tile = 0, film.count.shape[0], 0, film.count.shape[1]
    made = None if kind == KINDS[0] else program(film, planned.packed, asked, room, {})
    start = time.process_time()
    if made is None:
        one_by_one(film, planned.packed, *tile, asked.goal, asked.seed)
    else:
        run(made, *tile)
    return time.process_time() - start


def beside_one_by_one(scene, rounds):
    """Nanoseconds a path of each kind."""
    planned, room = plan(scene), new_room()
    for kind in KINDS:
        turn(planned, kind, 1, room)
    seconds = np.array(
        [[turn(planned, kind, SAMPLES, room) for kind in KINDS] for _ in range(rounds)]
    ).min(0)
    paths = scene.size[0] * scene.size[1] * SAMPLES
    return dict(zip(KINDS, (1e9 * seconds / paths).tolist(), strict=True))


def dark(scene):
    """Share of dark pixels of 800 x 600, and milliseconds to know them."""
    packed = plan(replace(scene, size=(800, 600))).packed
    start = time.perf_counter()
    found = outline.dark_pixels(packed, (600, 800))
    return {"share": float(found.mean()), "ms": 1e3 * (time.perf_counter() - start)}


def by_stage(scene, samples=SAMPLES):
    """Share of each stage in the time of all, by the clock, one thread; {name: share}."""
    planned, room = plan(scene), new_room()
    film, asked = due(planned, samples, True)
    height, width = film.count.shape
    parts = steps_of(film, planned.packed, asked, room)
    names = [stage.py_func.__name__ for part in parts for stage, _ in part]
    made = program(film, planned.packed, asked, room, {})
    spent = dict.fromkeys(names, 0.0)

    def step(k):
        code, words = (int(address) for address in made.steps[k])
        start = time.perf_counter()
        way_in(code)(words)
        spent[names[k]] += time.perf_counter() - start

    place(made, 0, height, 0, width)
    while True:
        step(0)
        if room.numbers[TAKEN] == 0:
            break
        for k in range(1, made.again):
            step(k)
        while made.end > made.again and room.numbers[LIVE] > 0:
            for k in range(made.again, made.end):
                step(k)
        for k in range(made.end, len(names)):
            step(k)
    return {name: seconds / sum(spent.values()) for name, seconds in spent.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write everything measured here")
    args = parser.parse_args()
    facts = {"machine": machine(), "scenes": {}}
    for name, scene in scenes(tuple(int(x) for x in args.size.split("x"))):
        facts["scenes"][name] = row = {"dark": dark(scene)}
        known = row["dark"]
        print(f"{name}: {known['share']:.0%} of the pixels are dark, after {known['ms']:.1f} ms")
        for scattering in ("single", "multiple"):
            some = replace(scene, scattering=scattering)
            row[scattering] = found = {
                "ns": beside_one_by_one(some, args.rounds), "stages": by_stage(some)
            }  # fmt: skip
            whole = found["ns"][KINDS[0]]
            times = (f"{kind} {ns:.0f} ns ({ns / whole:.2f})" for kind, ns in found["ns"].items())
            shares = (f"{stage} {share:.0%}" for stage, share in found["stages"].items())
            print(f"  {scattering:9}{', '.join(times)}\n  {'':9}{', '.join(shares)}", flush=True)
    if args.json:
        args.json.write_text(json.dumps(facts, indent=1) + "\n")


if __name__ == "__main__":
    main()
