"""What accuracy costs in time: docs/accuracy.json, docs/accuracy.md and their figures.

    python tests/bench/bench_accuracy.py [--budget 12m] [--only PART] [--small] [--folder docs]

Volumes come from VTKMCVR_DATA, the script that renders with Mitsuba from VTKMCVR_PEERS; without it
that part is left out. The budget is for kernels that are compiled already: a first run on a machine
compiles for some minutes more. Each part is stored when it is done, and `--only` measures one again
(volumes, occlusion, peers, fall, study, page) and keeps the others.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import accuracy_figures
import accuracy_peer
import mitsuba_peers
from accuracy_measure import THREADS, Facts, fall, full_size, half_size, shaded
from accuracy_page import FULL_BUDGET, page
from accuracy_volumes import SUBJECTS, scene_named, volume_named

from vtkmcvr import __version__
from vtkmcvr.commands.cost import duration
from vtkmcvr.costs.study import machine, study

DOCS = Path(__file__).parents[2] / "docs"
STUDY_SIZE, SMALL, STUDY_SHARE = (320, 240), (128, 96), 0.24
STUDIED = "CT abdomen"
OCCLUDED, PEERS = ("CT head", "engine", "CT abdomen"), ("CT head", "engine", "CT abdomen")
MOST_SAMPLES = 4096


class Page:
    """Facts that are stored after each part."""

    def __init__(self, folder: Path, budget: float):
        self.folder, self.factor = folder, budget / FULL_BUDGET
        self.json = folder / "accuracy.json"
        stored = json.loads(self.json.read_text()) if self.json.exists() else {}
        self.facts: Facts = {**stored, "threads": THREADS, **conditions()}
        self.budget, self.study_size = budget, STUDY_SIZE
        self.facts.setdefault("budgets", {})
        self.facts.setdefault("volumes", {})
        self.facts["studied"] = STUDIED
        self.start = time.perf_counter()

    def keep(self, what: str) -> None:
        """Store what is measured so far."""
        self.json.write_text(json.dumps(self.facts, indent=1, allow_nan=False) + "\n")
        print(f"{time.perf_counter() - self.start:6.0f} s  {what}", flush=True)

    def volumes(self) -> None:
        """Each volume at 800 x 600 and at 400 x 300."""
        for name in SUBJECTS:
            scene = scene_named(name, volume_named(name), (80, 60))
            found = {"full": full_size(scene, self.factor), "half": half_size(scene, self.factor)}
            self.facts["volumes"][name] = found
            self.keep(name)

    def occlusion(self) -> None:
        """Bias of directional occlusion."""
        self.facts["occlusion"] = {}
        for name in OCCLUDED:
            scene = scene_named(name, volume_named(name), (80, 60))
            self.facts["occlusion"][name] = shaded(scene, self.factor)
            self.keep(f"{name}, occlusion")

    def peers(self) -> None:
        """Mitsuba, where it is."""
        reason = mitsuba_peers.missing()
        self.facts["peers"] = {}
        for name in PEERS if not reason else ():
            self.facts["peers"][name] = accuracy_peer.beside_mitsuba(name, volume_named(name))
            self.keep(f"{name}, beside Mitsuba")
        if reason:
            self.keep(f"no peer: {reason}")

    def fall(self) -> None:
        """Power of the number of samples."""
        scene = scene_named(STUDIED, volume_named(STUDIED), (80, 60))
        self.facts["fall"] = fall(scene, MOST_SAMPLES if self.factor > 0.3 else 256)
        self.keep("fall of the error")

    def study(self) -> None:
        """Every choice on one volume; where time is over, the rest is named."""
        scene = scene_named(STUDIED, volume_named(STUDIED), self.study_size)
        with tempfile.TemporaryDirectory() as folder:
            found = study(scene, STUDY_SHARE * FULL_BUDGET * self.factor, folder=folder,
                          threads=THREADS)  # fmt: skip
            while found.left_out and self.time_left():
                found = study(scene, STUDY_SHARE * FULL_BUDGET * self.factor, folder=folder,
                              threads=THREADS)  # fmt: skip
            self.facts["study"] = found.results
            self.keep("study")
            accuracy_figures.draw(self.facts, self.folder / "images", Path(folder))

    def time_left(self) -> bool:
        """Whether compilation may take more."""
        return time.perf_counter() - self.start < 2.5 * FULL_BUDGET * self.factor

    def page(self) -> None:
        """Write the page from the facts."""
        (self.folder / "accuracy.md").write_text(page(self.facts), encoding="utf-8")
        self.keep("page")


def conditions() -> Facts:
    """Machine and versions."""
    try:
        peer = version("mitsuba")
    except PackageNotFoundError:
        peer = None
    where = {
        **machine(), "python": platform.python_version(), "numba": version("numba"),
        "mitsuba": peer, "load_before": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }  # fmt: skip
    return {"version": __version__, "machine": where}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parts = ("volumes", "occlusion", "peers", "fall", "study", "page")
    parser.add_argument("--budget", type=duration, default=FULL_BUDGET, metavar="12m")
    parser.add_argument("--only", choices=parts, action="append")
    parser.add_argument("--small", action="store_true", help="study of 128 x 96 pixels")
    parser.add_argument("--folder", type=Path, default=DOCS)
    args = parser.parse_args()
    made = Page(args.folder, args.budget)
    if args.small:
        made.study_size = SMALL
    for part in args.only or parts:
        measure: Callable[[], None] = getattr(made, part)
        if part != "page":
            made.facts["budgets"][part] = args.budget
        measure()
    if args.only and "page" not in args.only and made.facts["volumes"]:
        made.page()


if __name__ == "__main__":
    main()
