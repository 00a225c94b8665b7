"""Camera paths per second of vtkmcvr and Mitsuba 3 on the same scenes, in the same run.

    python tests/bench/bench_mitsuba.py [--size 512] [--spp 8] [--repeats 2] [--json FILE]

Both render single scattering in a 256^3 medium under a constant light, sparse and dense. They take
turns, so that a machine that slows down slows both, and the median of the turns counts.
Compilation and scene preparation are not counted: each renders once before. Ours runs with ratio
tracking, our default, as Mitsuba does, and with binary shadow rays as Exposure Render does. Paths
alone say little, so the table also has the NRMS error at equal samples and the speed at equal
error: Mitsuba seems to cast two shadow rays at a collision (by light and by phase function), we
cast one. Both use all cores; the ratio of CPU times is there because it hardly depends on what
else the machine does.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import platform
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import zoom

from vtkmcvr.plan import Plan, plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.schedule import default_threads

REPOSITORY = Path(__file__).resolve().parents[2]
PEERS = Path(os.environ.get("VTKMCVR_PEERS", REPOSITORY.parent / "shared" / "peers"))
LOADER = REPOSITORY / "tests" / "peers" / "mitsuba_scene.py"
POINTS = 256

Image = NDArray[np.float64]


@dataclass
class Contender:
    """One renderer on one scene: renders (seed, spp), remembers images and seconds."""

    name: str
    render: Callable[[int, int], NDArray]
    images: list[Image] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    cpu_seconds: list[float] = field(default_factory=list)

    def turn(self, seed: int, spp: int) -> None:
        """Render once, timed."""
        start, cpu_start = time.perf_counter(), time.process_time()
        image = self.render(seed, spp)
        self.seconds.append(time.perf_counter() - start)
        self.cpu_seconds.append(time.process_time() - cpu_start)
        self.images.append(np.asarray(image, np.float64))

    @property
    def median(self) -> float:
        """Seconds of one turn."""
        return float(np.median(self.seconds))

    @property
    def mean(self) -> float:
        """Mean of all images."""
        return float(np.mean(self.images))

    @property
    def mean_error(self) -> float:
        """Standard error of `mean`."""
        variance = np.var(self.images, axis=0, ddof=1) / len(self.images)
        # Channels are equal here: the light is grey
        return float(np.sqrt(variance[..., 0].sum()) / variance[..., 0].size)

    @property
    def nrms(self) -> float:
        """NRMS error of one image, from the spread of the turns."""
        noise = float(np.var(self.images, axis=0, ddof=1).mean())
        power = float((np.mean(self.images, axis=0) ** 2).mean()) - noise / len(self.images)
        return float(np.sqrt(noise / power))


def module(path: Path) -> Any:
    """Import a script by path."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    result = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = result
    spec.loader.exec_module(result)
    return result


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


def contenders(path: Path) -> list[Contender]:
    """Mitsuba and both of ours, ready to render."""
    import mitsuba as mi

    mi.set_variant("scalar_rgb")
    theirs = module(PEERS / "mitsuba_reference.py").build(mi, json.loads(path.read_text()), 1)
    loader = module(LOADER)
    ratio = plan(loader.load_scene(path))
    binary = plan(loader.load_scene(path, ratio_tracking=False))
    return [
        Contender("mitsuba scalar_rgb", lambda seed, n: mi.render(theirs, spp=n, seed=seed)),
        Contender("vtkmcvr, ratio", lambda seed, n: radiance(ratio, seed, n)),
        Contender("vtkmcvr, binary", lambda seed, n: radiance(binary, seed, n)),
    ]


def radiance(planned: Plan, seed: int, spp: int) -> NDArray[np.float32]:
    """One of our images."""
    return render_scene(planned, samples=spp, seed=seed).radiance


def measure(dense: bool, size: int, spp: int, repeats: int) -> list[Contender]:
    """Render a scene in turns."""
    with tempfile.TemporaryDirectory() as folder:
        racers = contenders(write_scene(Path(folder), dense, size))
    for racer in racers:
        racer.render(0, 1)
    for turn in range(repeats):
        for racer in racers:
            # Not the seeds of the other scene: Mitsuba's errors in both would be alike
            racer.turn(1 + turn + repeats * dense, spp)
    return racers


def facts(racers: list[Contender], paths: int) -> list[dict[str, Any]]:
    """One row for each contender, relative to the first."""
    peer = racers[0]
    return [
        {
            "name": r.name,
            "seconds": r.seconds,
            "paths_per_second": paths / r.median,
            "rate_ratio": peer.median / r.median,
            "cpu_seconds": r.cpu_seconds,
            "cpu_ratio": float(np.median(peer.cpu_seconds) / np.median(r.cpu_seconds)),
            "mean": r.mean,
            "mean_z": (r.mean - peer.mean) / max(np.hypot(r.mean_error, peer.mean_error), 1e-30),
            "nrms": r.nrms,
            # Time to a given error goes as seconds times variance
            "equal_error_ratio": peer.median * peer.nrms**2 / (r.median * r.nrms**2),
        }
        for r in racers
    ]


def table(rows: list[dict[str, Any]]) -> str:
    """Rows as text."""
    titles = f"{'Mpaths/s':>9}{'ratio':>8}{'CPU ratio':>11}{'mean':>10}{'z':>6}{'NRMS':>9}"
    lines = [
        f"{r['name']:20}{r['paths_per_second'] / 1e6:9.3f}{r['rate_ratio']:7.2f}x"
        f"{r['cpu_ratio']:10.2f}x{r['mean']:10.6f}{r['mean_z']:6.1f}{r['nrms']:9.5f}"
        f"{r['equal_error_ratio']:12.2f}x"
        for r in rows
    ]
    return "\n".join([f"{'':20}{titles}{'equal error':>13}", *lines])


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
    parser.add_argument("--size", type=int, default=512, help="pixels along each edge")
    parser.add_argument("--spp", type=int, default=8, help="samples per pixel of one turn")
    parser.add_argument("--repeats", type=int, default=2, help="turns of each, at least 2")
    parser.add_argument("--json", type=Path, help="write everything measured here")
    args = parser.parse_args()
    if args.repeats < 2:
        parser.error("--repeats must be at least 2: errors come from the spread of the turns")
    where = machine()
    print(", ".join(f"{key} {value}" for key, value in where.items()))
    print(
        f"{args.size}^2 pixels, {args.spp} samples per pixel, {args.repeats} turns each; "
        "compilation and scene preparation not counted"
    )
    scenes = {}
    for name in ("sparse", "dense"):
        racers = measure(name == "dense", args.size, args.spp, args.repeats)
        scenes[name] = facts(racers, args.size**2 * args.spp)
        print(f"\n{name} {POINTS}^3\n{table(scenes[name])}", flush=True)
    if args.json:
        asked = {"size": args.size, "spp": args.spp, "repeats": args.repeats}
        args.json.write_text(json.dumps({"machine": where, **asked, "scenes": scenes}, indent=2))
    agree = all(abs(row["mean_z"]) < 5 for rows in scenes.values() for row in rows)
    print("\nimage means agree" if agree else "\nIMAGE MEANS DISAGREE by more than 5 sigma")
    return 0 if agree else 1


if __name__ == "__main__":
    sys.exit(main())
