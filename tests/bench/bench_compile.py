"""Seconds of the processor that a new combination of effects takes to compile.

    python tests/bench/bench_compile.py [--preset solid] [--json FILE]

The synthetic CT head with a look, in a cache of its own that starts empty: first as it is, then
with one effect less or another transport each time, so that what they share is compiled already.
The combinations are those of `bench_looks.py` whose kernels differ; each is rendered once, small.
"""

import argparse
import json
import os
import tempfile
import time
from pathlib import Path


def measure(preset):
    """Seconds of each first picture, by name; the first includes all that others share."""
    # After the cache has its place
    from bench_looks import variants

    import vtkmcvr
    from vtkmcvr.front import scene_of
    from vtkmcvr.plan import plan

    head = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(64))
    scene = scene_of(head, preset=preset, size=(32, 24)).scene
    found = {}
    for name, variant in variants(scene).items():
        planned = plan(variant)
        start = time.process_time()
        vtkmcvr.render_scene(planned, samples=1, backend="cpu")
        found[name] = time.process_time() - start
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--preset", default="solid")
    parser.add_argument("--json", type=Path, help="write everything measured here")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as cache:
        os.environ["NUMBA_CACHE_DIR"] = cache
        found = measure(args.preset)
    for name, seconds in found.items():
        print(f"{name:<26}{seconds:>8.2f} s")
    if args.json:
        args.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
