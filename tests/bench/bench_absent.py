"""Time of a scene by the kernels as they are, against kernels from which absent effects were cut.

    python tests/bench/bench_absent.py [--rounds 60] [--each] [--json FILE]

The other build is compiled from the same sources without all that serves absent effects only
(`tests/without_effects.py`). Both take turns on one thread, 64 x 48 pixels a turn; the ratio is
that of the least processor times. `--each`: a build for each absent effect too, which compiles for
minutes.
"""

import argparse
import json
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from scenes import everything, scene
from without_effects import absent_parts, compiled_launcher

from vtkmcvr.costs.study import machine
from vtkmcvr.lights import ConstantEnvironment, DirectionalLight
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.scene import Surface
from vtkmcvr.tiles import goes_in_step

SIZE, SAMPLES = (64, 48), 32
SCENES = {
    "one directional light": scene(lights=(DirectionalLight((0.3, 1, -1)),)),
    "a sky, with surfaces": scene(lights=(ConstantEnvironment(),), surface=Surface()),
    "all kinds of light": everything(),
}


def turn(launcher, planned):
    """Processor seconds of one picture."""
    film = empty_film(planned)
    goal = np.full_like(film.count, SAMPLES)
    launch = launcher.at(film, planned.packed, goal, np.int64(0))
    start = time.process_time()
    launch(0, SIZE[1], 0, SIZE[0])
    return time.process_time() - start


def ratio(whole, without, planned, rounds):
    """Least time of the kernels as they are over that of the others, taking turns."""
    for launcher in (whole, without):
        turn(launcher, planned)
    times = np.array([[turn(k, planned) for k in (whole, without)] for _ in range(rounds)])
    least = times.min(axis=0)
    return float(least[0] / least[1]), float(1e9 * least[0] / (SIZE[0] * SIZE[1] * SAMPLES))


def measure(some, rounds, each):
    """Rows of one scene: what was cut, ratio, nanoseconds a path."""
    planned = plan(replace(some, size=SIZE))
    film = empty_film(planned)
    absent = sorted(absent_parts(planned.packed) | absent_parts(film))
    in_step = goes_in_step(planned.packed)
    whole = compiled_launcher(in_step)
    rows = []
    for cut in [absent, *([name] for name in absent if each)]:
        found, cost = ratio(whole, compiled_launcher(in_step, cut), planned, rounds)
        what = cut[0] if len(cut) == 1 else f"all {len(cut)} that are absent"
        rows.append({"cut": what, "ratio": round(found, 4), "ns": round(cost, 1)})
        print(f"  {what:32}{found:8.3f}{cost:10.0f} ns a path", flush=True)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=60)
    parser.add_argument("--each", action="store_true", help="a build for each absent effect too")
    parser.add_argument("--json", type=Path)
    args = parser.parse_args()
    facts = {"machine": machine(), "rounds": args.rounds, "scenes": {}}
    for name, some in SCENES.items():
        print(name)
        facts["scenes"][name] = measure(some, args.rounds, args.each)
    if args.json:
        args.json.write_text(json.dumps(facts, indent=1) + "\n")


if __name__ == "__main__":
    main()
