"""Occlusion against the cone phase function by Monte Carlo: errors, seconds, growth.

python tests/bench/bench_occlusion.py [--quick] [PART ...]

PART is errors, speeds, growth, halving, exact or reach; all without any, and of the others what was
found before is kept. Writes docs/occlusion.json and the tables of docs/occlusion.md. Volumes come
from VTKMCVR_DATA. An error is the NRMS of linear radiance against a reference whose own noise, as
its film estimates it, is taken off in quadrature. Seconds are CPU seconds of the process over the
number of threads, the least of several runs, so that other work on the machine disturbs them
little; compilation and reading are not counted. Half-spaces, a slab and a penumbra are compared
with exact values.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.material import TransferFunction
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.phases import Cone
from vtkmcvr.readers import read_vtk
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import Scene, Volume
from vtkmcvr.studio import view_camera
from vtkmcvr.vtk_bridge.scene import volume_of

FOLDERS = (".", "occlusion", "bench")
sys.path[:0] = [str(Path(__file__).parents[1] / folder) for folder in FOLDERS]
from occlusion_reach import shares  # noqa: E402
from occlusion_scenes import (  # noqa: E402
    block,
    frontal,
    half_space,
    half_space_scene,
    penumbra,
)
from scenes import scene as scene_of  # noqa: E402

DATA = Path(os.environ.get("VTKMCVR_DATA", "../shared/data"))
DOCS = Path(__file__).parents[2] / "docs"
THREADS = 2
# File, extinction per voxel edge by scalar, zoom
VOLUMES = {
    "engine": ("scivis/engine.nhdr", ((100, 0.0), (160, 0.8)), 1.35),
    "cthead": ("scivis/cthead/CThead.nhdr", ((1000, 0.0), (1400, 0.5)), 1.2),
    "headsq": ("nrrd/headsq/quarter.%d", ((500, 0.0), (1150, 0.25)), 1.2),
}
# The same volumes as bone and metal look
OPAQUE = 8.0
NAMES = (*VOLUMES, *(f"{name}, opaque" for name in VOLUMES))
THETAS = (30, 60, 80)
MODES = {
    "default": {},
    "default, 96 directions, detail 1.5": {"directions": 96, "detail": 1.5},
    "fast": {"mode": "fast"},
    "paper, 7 x 7": {"mode": "paper", "grid": 7},
}


def scene_of_volume(name: str, size: int) -> Scene:
    """The volume under an even sky, filling the view."""
    file, nodes, zoom = VOLUMES[name.split(",")[0]]
    if name.endswith("opaque"):
        nodes = (nodes[0], (nodes[1][0], OPAQUE))
    volume = _head_square(file) if "%" in file else volume_of(read_vtk(str(DATA / file)))
    transfer = TransferFunction(None, ColourCurve([(0, 1, 1, 1)]), extinction=Curve(nodes))
    camera = view_camera(volume, azimuth=-35, elevation=25, aspect=1.0, zoom=zoom)
    return Scene(volume, transfer, camera, (ConstantEnvironment(1.0),), size=(size, size))


def _head_square(file: str) -> Volume:
    """93 slices of raw 16-bit numbers, 3.2 x 3.2 x 1.5 mm; its own header names no orientation."""
    planes = [np.fromfile(DATA / (file % n), "<i2").reshape(64, 64) for n in range(1, 94)]
    return Volume.from_grid(np.stack(planes), (3.2, 3.2, 1.5))


def nrms(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)))


def timed(scene: Scene, occlusion: Occlusion, runs: int):
    """Picture, and the least CPU seconds per thread of several runs."""
    best = math.inf
    for _ in range(runs):
        begin = time.process_time()
        picture = render_occlusion(scene, occlusion, threads=THREADS)
        best = min(best, (time.process_time() - begin) / THREADS)
    return picture, best


def errors(size: int, samples: int) -> list[dict]:
    rows = []
    for name in NAMES:
        scene = scene_of_volume(name, size)
        for theta in THETAS:
            begin = time.process_time()
            reference = render_scene(
                replace(scene, phase=Cone(theta)), samples=samples, threads=THREADS
            )
            spent = (time.process_time() - begin) / THREADS
            row = {"volume": name, "theta": theta, "reference_noise": reference.nrms,
                   "reference_seconds": spent, "modes": {}}  # fmt: skip
            for mode, settings in MODES.items():
                runs = 2 if mode in ("default", "fast") else 1
                picture, seconds = timed(scene, Occlusion(theta, **settings), runs)
                raw = nrms(picture.radiance, reference.radiance)
                row["modes"][mode] = {
                    "nrms": math.sqrt(max(raw**2 - reference.nrms**2, 0.0)),
                    "mean_ratio": float(picture.radiance.mean() / reference.radiance.mean()),
                    "seconds": seconds,
                }
            rows.append(row)
            print(json.dumps(row), flush=True)
    return rows


def speeds(runs: int) -> list[dict]:
    """512 x 512 pixels, 679 slices, 70 degrees, as in the paper's figure of the engine."""
    rows = []
    cases = [("fast", {"mode": "fast"}), ("default", {})]
    for name in ("engine", "cthead", "engine, opaque", "cthead, opaque"):
        scene = scene_of_volume(name, 512)
        for mode, settings in cases:
            picture, seconds = timed(scene, Occlusion(70, slices=679, **settings), runs)
            work = picture.work
            rows.append({
                "volume": name, "mode": mode, "seconds": seconds,
                "looked_up": work.looked_up / work.naive, "seen": work.seen / work.naive,
            })  # fmt: skip
            print(json.dumps(rows[-1]), flush=True)
    return rows


def growth(runs: int) -> list[dict]:
    """Time against twice the slices, twice the angle, four times the pixels."""
    rows = []
    scene, large = scene_of_volume("engine", 384), scene_of_volume("engine", 768)
    for mode in ("fast", "default"):
        base = Occlusion(40, mode, slices=500)
        _, once = timed(scene, base, runs)
        _, slices = timed(scene, replace(base, slices=1000), runs)
        _, angle = timed(scene, replace(base, half_angle=80), runs)
        _, narrow = timed(scene, replace(base, half_angle=10), runs)
        _, pixels = timed(large, base, runs)
        rows.append({
            "mode": mode, "seconds": once, "twice the slices": slices / once,
            "twice the angle": angle / once, "80 to 10 degrees": angle / narrow,
            "four times the pixels": pixels / once,
        })  # fmt: skip
        print(json.dumps(rows[-1]), flush=True)
    return rows


def halving() -> list[dict]:
    """Change of the picture when slices get half as thick."""
    rows = []
    for name in ("engine", "cthead"):
        scene = scene_of_volume(name, 256)
        for theta in (30, 60):
            usual = render_occlusion(scene, Occlusion(theta), threads=THREADS)
            count = int(dict((e.name, e.reason) for e in usual.plan.effects)["slices"].split()[0])
            finer = render_occlusion(scene, Occlusion(theta, slices=2 * count), threads=THREADS)
            change = nrms(finer.radiance, usual.radiance)
            rows.append({"volume": name, "theta": theta, "slices": count, "nrms": change})
            print(json.dumps(rows[-1]), flush=True)
    return rows


def reach() -> list[dict]:
    """Additions to beams that anything comes of."""
    rows = []
    for name in ("engine", "cthead", "engine, opaque", "cthead, opaque"):
        rows.append({"volume": name, **shares(scene_of_volume(name, 160), Occlusion(70))})
        print(json.dumps(rows[-1]), flush=True)
    return rows


def exact() -> list[dict]:
    """Half-spaces by angle (HC-83), a slab without a cone, a half-plane's penumbra."""
    rows = []
    for mode in ("default", "fast"):
        cases = [
            (f"half-space, {theta} degrees", half_space(theta),
             middle(half_space_scene(), Occlusion(theta, mode, slices=240)))
            for theta in (0, 30, 50, 80, 85, 89)
        ]  # fmt: skip
        for tau in (0.1, 1.0, 4.0):
            slab = scene_of(*block(4.0, 12.0, tau / 4), frontal(1.0), size=(5, 5))
            found = middle(slab, Occlusion(0, mode))
            cases.append((f"slab of {tau:g} depths, 0 degrees", -math.expm1(-2 * tau) / 2, found))
        found, expected, _ = penumbra(Occlusion(50, mode))
        cases.append(("width of a penumbra, 50 degrees, voxels", expected, found))
        rows += [{"mode": mode, "case": c, "exact": float(e), "found": float(f)}
                 for c, e, f in cases]  # fmt: skip
    print(json.dumps(rows), flush=True)
    return rows


def middle(scene: Scene, occlusion: Occlusion) -> float:
    """Radiance of the middle pixel."""
    picture = render_occlusion(scene, occlusion, threads=THREADS)
    rows, columns = picture.alpha.shape
    return float(picture.radiance[rows // 2, columns // 2, 1])


def tables(facts: dict) -> str:
    lines = [
        "| volume | theta | mode | NRMS | mean / reference | seconds |",
        "|---|---|---|---|---|---|",
    ]
    for row in facts["errors"]:
        for mode, m in row["modes"].items():
            lines.append(
                f"| {row['volume']} | {row['theta']} | {mode} | {m['nrms']:.3f} | "
                f"{m['mean_ratio']:.3f} | {m['seconds']:.2f} |"
            )
    lines += [
        "",
        "512 x 512, 679 slices, 70 degrees; shares of the fragments of a loop over everything:",
        "",
        "| volume | mode | seconds | looked up | seen |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {r['volume']} | {r['mode']} | {r['seconds']:.2f} | {r['looked_up']:.1%} | "
        f"{r['seen']:.1%} |"
        for r in facts["speeds"]
    ]
    lines += [
        "",
        "| volume | additions to beams that are seen | that an open view ray may see |",
        "|---|---|---|",
    ]
    lines += [f"| {r['volume']} | {r['seen']:.0%} | {r['open']:.0%} |" for r in facts["reach"]]
    lines += [
        "",
        "| mode | twice the slices | twice the angle (40 to 80) | 80 degrees to 10 | "
        "four times the pixels |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {r['mode']} | {r['twice the slices']:.2f} x | {r['twice the angle']:.2f} x | "
        f"{r['80 to 10 degrees']:.2f} x | {r['four times the pixels']:.2f} x |"
        for r in facts["growth"]
    ]
    lines += ["", "| volume | theta | slices | NRMS to twice as many |", "|---|---|---|---|"]
    lines += [
        f"| {r['volume']} | {r['theta']} | {r['slices']} | {r['nrms']:.4f} |"
        for r in facts["halving"]
    ]
    lines += ["", "| case | exact | default | fast |", "|---|---|---|---|"]
    default, fast = ([r for r in facts["exact"] if r["mode"] == m] for m in ("default", "fast"))
    for a, b in zip(default, fast, strict=True):
        each = " | ".join(f"{r['found']:.4g} ({r['found'] / r['exact'] - 1:+.1%})" for r in (a, b))
        lines.append(f"| {a['case']} | {a['exact']:.4g} | {each} |")
    return "\n".join(lines)


def main(quick: bool, names: list[str]) -> None:
    size, samples, runs = (96, 32, 1) if quick else (160, 96, 3)
    scene = scene_of_volume("headsq", 16)
    for settings in MODES.values():
        render_occlusion(scene, Occlusion(**settings))
    parts = {
        "errors": lambda: errors(size, samples), "speeds": lambda: speeds(runs),
        "growth": lambda: growth(runs), "halving": halving, "exact": exact, "reach": reach,
    }  # fmt: skip
    if not set(names) <= set(parts):
        raise SystemExit(f"parts are {', '.join(parts)}, got {' '.join(names)}")
    found = DOCS / "occlusion.json"
    facts = json.loads(found.read_text()) if names else {}
    facts |= {name: parts[name]() for name in names or parts}
    if "errors" in (names or parts):
        facts |= {"reference_samples": samples, "size": size}
    found.write_text(json.dumps(facts, indent=1) + "\n")
    page = DOCS / "occlusion.md"
    text = page.read_text() if page.exists() else "<!-- tables -->\n"
    head = text.split("<!-- tables -->")[0]
    page.write_text(f"{head}<!-- tables -->\n\n{tables(facts)}\n")


if __name__ == "__main__":
    arguments = [a for a in sys.argv[1:] if a != "--quick"]
    main(len(arguments) + 1 < len(sys.argv), arguments)
