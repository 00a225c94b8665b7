"""Camera paths per second of vtkmcvr and Mitsuba 3 on the same scenes, in the same run.

    python tests/bench/bench_mitsuba.py [--size 256] [--spp 8] [--repeats 2] [--json FILE]

Both render single scattering: in a 256^3 medium under a constant light, sparse and dense; and,
where VTKMCVR_DATA has them, in the CT head and the engine under an environment and two area lights,
whose extinction and albedo are baked from the look, in small pictures. They take turns, so that a
machine that slows down slows both, and the median of the turns counts. Compilation and scene
preparation are not counted: each renders once before. Mitsuba runs in each of its variants that run
here: scalar, and with LLVM 19 or later (Debian's libllvm19; DRJIT_LIBLLVM_PATH) vectorised. Ours
runs with ratio tracking, our default, as Mitsuba does, and with binary shadow rays as Exposure
Render does. Paths alone say little, so the table also has the NRMS error of one sample per pixel
and the speed at equal error, against the best variant: Mitsuba seems to cast two shadow rays at a
collision (by light and by phase function), we cast one. All use all cores; the ratio of CPU times
is there because it hardly depends on what else the machine does.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from accuracy_peer import SIZE as SMALL
from accuracy_peer import bake
from accuracy_volumes import DATA, SUBJECTS, on_axes, scene_named, volume_named
from mitsuba_peers import LOADER, Contender, missing, mitsubas, module
from numpy.typing import NDArray
from scipy.ndimage import zoom

from vtkmcvr.plan import Plan, plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.schedule import default_threads

POINTS = 256
SYNTHETIC = ("sparse", "dense")
SCENES = (*SYNTHETIC, "CT head", "engine")


def medium(dense: bool) -> NDArray[np.float32]:
    """Noise in a sphere: all of it, eight times as dense; or its peaks with empty space between."""
    n = POINTS
    z, y, x = (axis.astype(np.float32) / n - 0.5 for axis in np.ogrid[0:n, 0:n, 0:n])
    noise = zoom(np.random.default_rng(0).random((32, 32, 32)).astype(np.float32), 8, order=1)
    inside = np.sqrt(x * x + y * y + z * z) < 0.45
    if dense:
        return np.where(inside, noise * 2, 0).astype(np.float32)
    return np.where(inside & (noise > 0.62), noise * 0.25, 0).astype(np.float32)


def write_scene(folder: Path, dense: bool, size: int) -> Path:
    """scene.json, from which both renderers build their scene."""
    np.save(folder / "sigma_t.npy", medium(dense))
    middle = (POINTS - 1) / 2
    spec = {
        "sigma_t": str(folder / "sigma_t.npy"),
        "albedo": 0.8,
        "spacing": [1, 1, 1],
        "origin": [0, 0, 0],
        "phase": {"g": 0},
        "max_depth": 2,
        "camera": {
            "position": [middle, middle, -1.6 * POINTS],
            "focal_point": [middle] * 3,
            "view_up": [0, 1, 0],
            "view_angle": 40,
        },
        "size": [size, size],
        "lights": [{"type": "constant", "radiance": [1, 1, 1]}],
    }
    path = folder / "scene.json"
    path.write_text(json.dumps(spec))
    return path


def contenders(path: Path, grey: bool) -> list[Contender]:
    """Mitsuba's variants and both of ours, ready to render."""
    loader = module(LOADER)
    ratio = plan(loader.load_scene(path))
    binary = plan(loader.load_scene(path, ratio_tracking=False))
    return [
        *mitsubas(path, grey),
        Contender("vtkmcvr, ratio", lambda seed, n: radiance(ratio, seed, n)),
        Contender("vtkmcvr, binary", lambda seed, n: radiance(binary, seed, n)),
    ]


def radiance(planned: Plan, seed: int, spp: int) -> NDArray[np.float32]:
    """One of our images."""
    return render_scene(planned, samples=spp, seed=seed).radiance


def write_named(name: str, folder: Path, size: int) -> Path:
    """scene.json of a scene by name."""
    if name in SYNTHETIC:
        return write_scene(folder, name == "dense", size)
    volume = on_axes(volume_named(name))
    return bake(scene_named(name, volume, SMALL), folder)


def measure(name: str, size: int, spp: int, repeats: int) -> list[dict[str, Any]]:
    """Render a scene in turns; one row for each contender."""
    grey = name in SYNTHETIC
    with tempfile.TemporaryDirectory() as folder:
        racers = contenders(write_named(name, Path(folder), size), grey)
        for racer in racers:
            racer.render(0, spp)
        # Ours take more samples in the small pictures, or their time would be that of starting
        samples = [spp if grey or "mitsuba" in racer.name else 8 * spp for racer in racers]
        for turn in range(repeats):
            for racer, count in zip(racers, samples, strict=True):
                # Not the seeds of another scene: Mitsuba's errors in both would be alike
                racer.turn(1 + turn + repeats * SCENES.index(name), count)
    return facts(racers, samples)


def facts(racers: list[Contender], samples: list[int]) -> list[dict[str, Any]]:
    """One row for each contender, relative to the variant of Mitsuba that is best at it."""
    first, rows = racers[0], []
    for r, count in zip(racers, samples, strict=True):
        paths = count * r.images[0][..., 0].size
        rows.append({
            "name": r.name, "samples": count, "seconds": r.seconds, "cpu_seconds": r.cpu_seconds,
            "paths_per_second": paths / r.median,
            "cpu_per_path": float(np.median(r.cpu_seconds)) / paths,
            "mean": r.mean,
            "mean_z": (r.mean - first.mean) / max(np.hypot(r.mean_error, first.mean_error), 1e-30),
            "nrms": r.nrms * math.sqrt(count),
            # Time to a given error goes as seconds times variance
            "cost": r.median * r.nrms**2,
        })  # fmt: skip
    theirs = [row for row in rows if "mitsuba" in row["name"]]
    for row in rows:
        row["rate_ratio"] = row["paths_per_second"] / max(t["paths_per_second"] for t in theirs)
        row["cpu_ratio"] = min(t["cpu_per_path"] for t in theirs) / row["cpu_per_path"]
        row["equal_error_ratio"] = min(t["cost"] for t in theirs) / row["cost"]
    return rows


def table(rows: list[dict[str, Any]]) -> str:
    """Rows as text."""
    titles = f"{'Mpaths/s':>9}{'ratio':>9}{'CPU ratio':>11}{'mean':>10}{'z':>6}{'NRMS':>9}"
    lines = [
        f"{r['name']:22}{r['paths_per_second'] / 1e6:9.3f}{r['rate_ratio']:8.2f}x"
        f"{r['cpu_ratio']:10.2f}x{r['mean']:10.6f}{r['mean_z']:6.1f}{r['nrms']:9.5f}"
        f"{r['equal_error_ratio']:12.2f}x"
        for r in rows
    ]
    return "\n".join([f"{'':22}{titles}{'equal error':>13}", *lines])


def machine() -> dict[str, Any]:
    """What the numbers depend on."""
    return {
        "cpu": cpu_model(),
        "threads": default_threads(),
        "load_before": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "python": platform.python_version(),
        "numba": version("numba"),
        "mitsuba": version("mitsuba"),
    }


def cpu_model() -> str:
    """Name of the processor, as far as the system tells it."""
    info = Path("/proc/cpuinfo")
    for line in info.read_text().splitlines() if info.exists() else ():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()


def main() -> int:
    """Measure, print, and fail if the images disagree."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=256, help="pixels along each edge")
    parser.add_argument("--spp", type=int, default=8, help="samples per pixel of one turn")
    parser.add_argument("--repeats", type=int, default=2, help="turns of each, at least 2")
    parser.add_argument("--json", type=Path, help="write everything measured here")
    args = parser.parse_args()
    if args.repeats < 2:
        parser.error("--repeats must be at least 2: errors come from the spread of the turns")
    if missing():
        parser.error(missing())
    where = machine()
    print(", ".join(f"{key} {value}" for key, value in where.items()))
    print(
        f"{args.size}^2 pixels, {args.spp} samples per pixel, {args.repeats} turns each; "
        "compilation and scene preparation not counted"
    )
    scenes = {}
    for name in SCENES:
        if name not in SYNTHETIC and not (DATA / SUBJECTS[name].file).exists():
            print(f"\n{name}: not in VTKMCVR_DATA")
            continue
        scenes[name] = measure(name, args.size, args.spp, args.repeats)
        what = f"{POINTS}^3" if name in SYNTHETIC else f"{SMALL[0]} x {SMALL[1]} pixels"
        print(f"\n{name}, {what}\n{table(scenes[name])}", flush=True)
    if args.json:
        asked = {"size": args.size, "spp": args.spp, "repeats": args.repeats}
        args.json.write_text(json.dumps({"machine": where, **asked, "scenes": scenes}, indent=2))
    agree = all(abs(row["mean_z"]) < 5 for rows in scenes.values() for row in rows)
    print("\nimage means agree" if agree else "\nIMAGE MEANS DISAGREE by more than 5 sigma")
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main())
