"""`vtkmcvr.study`: what each choice costs and gains on one scene, against a long reference."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from .. import __version__, checks, schedule
from ..plan import Plan, plan
from ..recipes.serialise import to_plain
from ..safe_files import replacing
from ..scene import Scene
from . import summary
from .families import families
from .ladder import Point, Reference, climb, make_reference, plain
from .occluded import cone_scene, occluded
from .stored import (
    error_plane,
    load_reference,
    load_results,
    save_error,
    save_reference,
    save_results,
)
from .variants import OTHER, Variant, base_variant, variants

# Shares of the time: the reference, the scene as it is, all variants together
REFERENCE_SHARE, BASE_SHARE = 0.35, 0.15
LEAST_SECONDS = 0.2
# With less, a picture cannot tell its noise from what else differs
LEAST_SAMPLES = 2

TABLES = "cost.md"

Report = Callable[[int, int, str], object]


@dataclass
class Study:
    """Results of `study`.

    Attributes
    ----------
    results : dict
        Plain JSON values: machine, scene, reference, points of every variant, what was left out.
    """

    results: dict[str, Any]
    folder: Path | None = None
    left_out: list[str] = field(default_factory=list)

    def rows(self) -> list[summary.Row]:
        """One row for each variant: seconds per sample, to 10 % and 1 %, bias."""
        return summary.rows(self.results)

    def __str__(self) -> str:
        return summary.markdown(self.results)

    def write(self, folder: str | os.PathLike) -> Path:
        """Write the tables as `cost.md`; `cost.json` is there if the study had this folder."""
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        save_results(target, self.results)
        with replacing(target / TABLES, ".md") as temporary:
            temporary.write_text(f"{self}\n", encoding="utf-8")
        return target / TABLES

    def draw(self, folder: str | os.PathLike) -> list[Path]:
        """Write the figures; needs matplotlib."""
        from .figures import draw

        return draw(self.results, Path(folder), self.folder)


def study(
    scene: Scene,
    budget: float = 60.0,
    *,
    folder: str | os.PathLike | None = None,
    threads: int | None = None,
    progress: Report | None = None,
    abort: Callable[[], bool] | None = None,
) -> Study:
    """Measure error against time for a scene and for everything worth comparing with it.

    Parameters
    ----------
    scene : Scene
    budget : float
        Seconds to spend, > 0, compilation included. What does not fit is left out and named.
    folder : path, optional
        Where `cost.json` and the reference are kept. A study of the same scene that is there
        already is continued.
    threads : int, optional
        Default: all CPUs that the process may use.
    progress : callable, optional
        Called with (done, of, what comes next).
    abort : callable, optional
        Asked between measurements; True ends the study with what it has.

    Returns
    -------
    Study
    """
    checks.number("budget", budget, above=0.0)
    threads = (
        schedule.default_threads() if threads is None else checks.whole("threads", threads, least=1)
    )
    home = None if folder is None else Path(folder)
    worker = _Worker(scene, budget, threads, home, progress, abort)
    worker.run()
    return Study(worker.results, home, worker.results["left_out"])


def fingerprint(scene: Scene) -> str:
    """Hash of everything that decides the radiance of a scene."""
    text = json.dumps(to_plain(scene), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


class _Worker:
    """One study: the reference first, then the scene as it is, then variants until time is over."""

    def __init__(
        self,
        scene: Scene,
        budget: float,
        threads: int,
        folder: Path | None,
        progress: Report | None,
        abort: Callable[[], bool] | None,
    ):
        self.scene, self.budget, self.threads, self.folder = scene, budget, threads, folder
        self.progress, self.abort = progress, abort
        self.all = [base_variant(scene), *variants(scene), *families(scene)]
        self.cones: dict[float, Reference] = {}
        self.end = time.perf_counter() + budget
        self.results = self._start()

    def _start(self) -> dict[str, Any]:
        fresh = {
            "version": __version__,
            "scene": fingerprint(self.scene),
            "size": list(self.scene.size),
            "threads": self.threads,
            "machine": machine(),
            "measured": {},
            "cones": {},
            "left_out": [],
            "refused": {},
        }
        stored = load_results(self.folder)
        same = ("version", "scene", "threads")
        whole = stored is not None and fresh.keys() <= stored.keys()
        if stored is not None and whole and all(stored[key] == fresh[key] for key in same):
            return stored
        return fresh

    def run(self) -> None:
        """Measure what is not measured yet."""
        planned = plan(self.scene)
        reference = self._reference(planned)
        self.results["left_out"] = []
        for number, variant in enumerate(self.all):
            if variant.key in self.results["measured"]:
                continue
            if self.progress is not None:
                self.progress(number, len(self.all), variant.key)
            if number and self._over():
                self.results["left_out"].append(variant.key)
                continue
            try:
                self._measure(variant, reference)
            except ValueError as error:
                # Occlusion does not know every part of a scene
                self.results["refused"][variant.key] = str(error)
            save_results(self.folder, self.results)
        save_results(self.folder, self.results)

    def _over(self) -> bool:
        return time.perf_counter() >= self.end or (self.abort is not None and self.abort())

    def _reference(self, planned: Plan) -> Reference:
        stored = load_reference(self.folder) if "reference" in self.results else None
        if stored is not None:
            return stored
        if self.progress is not None:
            self.progress(0, len(self.all), "reference")
        reference = make_reference(planned, REFERENCE_SHARE * self.budget, self.threads, self.abort)
        save_reference(self.folder, reference)
        self.results["reference"] = reference.facts()
        return reference

    def _seconds(self, variant: Variant) -> float:
        """Time for a variant."""
        share = BASE_SHARE
        if variant is not self.all[0]:
            share = (1 - REFERENCE_SHARE - BASE_SHARE) / (len(self.all) - 1)
        return max(share * self.budget, LEAST_SECONDS)

    def _measure(self, variant: Variant, reference: Reference) -> None:
        entry: dict[str, Any] = {
            "group": variant.group, "name": variant.name, "kind": variant.kind
        }  # fmt: skip
        if variant.occlusion is not None:
            cone = self._cone(variant.occlusion.half_angle)
            point, entry["bias"], radiance = occluded(
                self.scene, variant.occlusion, reference, cone, self.threads
            )
            points = [point]
        else:
            points, radiance = self._climb(variant, reference)
        entry["points"] = plain(points)
        self.results["measured"][variant.key] = entry
        if variant.kind != OTHER:
            save_error(self.folder, variant.key, error_plane(radiance, reference))

    def _climb(self, variant: Variant, reference: Reference) -> tuple[list[Point], NDArray]:
        planned, seconds = plan(variant.scene), self._seconds(variant)
        if variant.kind == OTHER:
            seconds /= 2
            reference = make_reference(planned, seconds, self.threads)
        return climb(
            planned, reference, seconds, self.threads, finish=variant.finish,
            adaptive=variant.adaptive, least=LEAST_SAMPLES,
        )  # fmt: skip

    def _cone(self, half_angle: float) -> Reference:
        """Reference of directional occlusion, as long as two variants."""
        if half_angle not in self.cones:
            planned = plan(cone_scene(self.scene, half_angle))
            seconds = 2 * self._seconds(self.all[-1])
            self.cones[half_angle] = make_reference(planned, seconds, self.threads)
            self.results["cones"][f"{half_angle:g}"] = self.cones[half_angle].facts()
        return self.cones[half_angle]


def machine() -> dict[str, Any]:
    """What the figures were measured on: processor and number of CPUs, no name of the host."""
    name = platform.processor() or platform.machine()
    linux = Path("/proc/cpuinfo")
    if linux.exists():
        lines = linux.read_text(encoding="utf-8").splitlines()
        names = [x.partition(":")[2].strip() for x in lines if x.startswith("model name")]
        name = names[0] if names else name
    return {"processor": name, "cpus": schedule.default_threads()}
