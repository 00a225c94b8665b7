"""Figures of the accuracy page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vtkmcvr.costs import figures
from vtkmcvr.costs.figures import converge, save_figure

Facts = dict[str, Any]
PREFIX = "accuracy-"


def draw(facts: Facts, folder: Path, maps: Path) -> None:
    """Write all figures that the facts allow."""
    folder.mkdir(parents=True, exist_ok=True)
    volumes = {
        name: found["half"]["points"] for name, found in facts["volumes"].items() if "half" in found
    }
    if volumes:
        save_figure(folder / f"{PREFIX}volumes.png", lambda axes: converge(axes, volumes))
        save_figure(
            folder / f"{PREFIX}seconds.png", lambda axes: converge(axes, volumes, "cpu_seconds")
        )
    if "fall" in facts:
        curves = {
            f"{name}: $N^{{{facts['fall'][name]['exponent']:.3f}}}$": [
                {"samples": p["samples"], "measured": p["nrms"], "spread": p["spread"],
                 "estimated": None}
                for p in facts["fall"][name]["points"]
            ]
            for name in ("independent", "sobol")
        }  # fmt: skip
        save_figure(folder / f"{PREFIX}fall.png", lambda axes: converge(axes, curves))
    if "study" in facts:
        for path in figures.draw(facts["study"], folder, maps):
            path.rename(path.with_name(PREFIX + path.name))
