"""What each effect adds in time, on real volumes, as multiples of one baseline scene.

    python tests/bench/bench_effects.py [--size 160x120] [--samples 32] [--rounds 5]

Writes docs/speed.json and docs/speed.md. Volumes come from VTKMCVR_DATA. All scenes are rendered in
each round, one after the other, on one thread; the smallest CPU time of the rounds counts, so that
other programs disturb little. Compilation is left out.
"""

import argparse
import json
import os
import time
from pathlib import Path

import numpy as np
from effect_scenes import BASELINE, with_effects

import vtkmcvr
from vtkmcvr.costs.study import machine
from vtkmcvr.front import View, scene_of
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.vtk_bridge.scene import volume_of

DOCS = Path(__file__).resolve().parents[2] / "docs"
SUBJECTS = {
    "cthead": ("scivis/cthead/CThead.nhdr", "k", "ct-bone", View(azimuth=-28)),
    "engine": ("scivis/engine.nhdr", None, "solid", View(azimuth=-35, elevation=24)),
}
INTRODUCTION = """\
# What each effect costs

Made by `python tests/bench/bench_effects.py` (`make speed`) from [speed.json](speed.json). The
baseline is a preset's transfer function with the isotropic phase function, its key light (one
rectangle), ratio-tracked shadows, a pinhole, single scattering and Sobol points. Each row adds or
replaces one thing. `time` is the time of a camera path over that of the baseline. `error` is the
same for equal error: time times the square of the picture's relative error (NRMS) at equal samples.
An effect that makes the picture brighter or smoother may lower the second below the first.

From most points, many of 64 lights all around are hidden, which no choice among them can know: that
is most of their error. What the choice costs shows without shadows, beside one light without
shadows. Multiple scattering has its own picture, with more light in it. An environment map is one
with a small sun.

"""


def subject(name, data, size):
    """Look of a volume."""
    file, flip, preset, view = SUBJECTS[name]
    volume = volume_of(vtkmcvr.read(data / file))
    volume = volume.flipped(flip) if flip else volume
    return scene_of(volume, preset=preset, size=size, view=view)


def measure(dressed, samples, rounds):
    """Seconds per million paths and NRMS at one sample, of each scene."""
    scenes = with_effects(dressed)
    plans = [plan(scene) for _, _, scene in scenes]
    for planned in plans:
        render_scene(planned, samples=1, threads=1)
    seconds, squares = np.full((2, rounds, len(plans)), np.inf)
    for k in range(rounds):
        for i, planned in enumerate(plans):
            start = time.process_time()
            picture = render_scene(planned, samples=samples, threads=1, seed=k)
            seconds[k, i] = time.process_time() - start
            squares[k, i] = picture.nrms**2 * samples
    width, height = dressed.scene.size
    cost = 1e6 * seconds.min(0) / (width * height * samples)
    return [
        {"group": group, "name": name, "seconds": round(float(t), 4), "nrms": round(float(e), 4)}
        for (group, name, _), t, e in zip(scenes, cost, np.sqrt(squares.mean(0)), strict=True)
    ]


def multiples(rows):
    """Time, and time to equal error, over those of the baseline, by name."""
    first = next(row for row in rows if row["name"] == BASELINE)
    return {
        row["name"]: (
            row["seconds"] / first["seconds"],
            row["seconds"] * row["nrms"] ** 2 / (first["seconds"] * first["nrms"] ** 2),
        )
        for row in rows
    }


def page(facts):
    """The page of the measurements."""
    names = list(facts["volumes"])
    found = {name: multiples(facts["volumes"][name]) for name in names}
    heads = " | ".join(f"{name}: time | error" for name in names)
    lines = [f"| effect | {heads} |", "|---|" + "---:|---:|" * len(names)]
    group = ""
    for row in facts["volumes"][names[0]]:
        if row["group"] != group:
            group = row["group"]
            lines.append(f"| **{group}** |" + " | |" * len(names))
        cells = " | ".join("{:.2f} | {:.2f}".format(*found[name][row["name"]]) for name in names)
        lines.append(f"| {row['name']} | {cells} |")
    base = {name: facts["volumes"][name][0] for name in names}
    rates = ", ".join(f"{name} {1 / base[name]['seconds']:.2f}" for name in names)
    told = (
        f"Baseline in million camera paths per second and thread: {rates} "
        f"({facts['machine']['processor']}, one thread, {facts['size'][0]} x {facts['size'][1]}, "
        f"{facts['samples']} samples, least CPU time of {facts['rounds']} rounds).\n"
    )
    return INTRODUCTION + "\n".join(lines) + "\n\n" + told


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", default="160x120")
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--data", type=Path, default=os.environ.get("VTKMCVR_DATA"))
    parser.add_argument("--write", type=Path, default=DOCS, help="folder of speed.json, speed.md")
    args = parser.parse_args()
    if args.data is None:
        parser.error("where are the volumes? Set VTKMCVR_DATA or give --data")
    size = tuple(int(x) for x in args.size.split("x"))
    facts = {
        "machine": machine(), "size": size, "samples": args.samples, "rounds": args.rounds,
        "volumes": {
            name: measure(subject(name, Path(args.data), size), args.samples, args.rounds)
            for name in SUBJECTS
        },
    }  # fmt: skip
    (args.write / "speed.json").write_text(json.dumps(facts, indent=1) + "\n")
    (args.write / "speed.md").write_text(page(facts))
    print(page(facts))


if __name__ == "__main__":
    main()
