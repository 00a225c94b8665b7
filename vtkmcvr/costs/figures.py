"""Figures of a study, by matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from . import summary


def draw(results: dict[str, Any], folder: Path) -> list[Path]:
    """Write `convergence.png` and `error-time.png` into a folder; return their paths."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ImportError(
            "figures need matplotlib: pip install 'vtkmcvr[plot]', or go without by figures=False"
        ) from None
    jobs = (("convergence.png", _convergence), ("error-time.png", _error_time))
    paths = []
    for name, paint in jobs:
        figure = Figure(figsize=(7.2, 4.8), layout="constrained")
        paint(figure.add_subplot(), results)
        figure.savefig(folder / name, dpi=130)
        paths.append(folder / name)
    return paths


def _convergence(axes: Any, results: dict[str, Any]) -> None:
    """Error against samples of the scene as it is, with the line 1 / sqrt(N) and its band."""
    points = next(iter(results["measured"].values()))["points"]
    n = np.array([p["samples"] for p in points])
    measured = np.array([p["measured"] for p in points])
    spread = np.array([p["spread"] for p in points])
    known = [(p["samples"], p["estimated"]) for p in points if p["estimated"] is not None]
    axes.errorbar(n, measured, yerr=np.minimum(spread, 0.9 * measured), fmt="o", label="measured")
    if known:
        x, y = np.array(known).T
        axes.plot(x, y, "s", mfc="none", label="estimated by the picture itself")
        axes.plot(n, y[-1] * np.sqrt(x[-1] / n), "--", color="grey", label=r"$1/\sqrt{N}$")
    _logarithmic(axes, "samples per pixel")


def _error_time(axes: Any, results: dict[str, Any]) -> None:
    """Error against seconds of every variant that shows the same picture."""
    for entry in results["measured"].values():
        if entry["kind"] == "model":
            continue
        points = entry["points"]
        base = entry["group"] == "scene"
        axes.plot(
            [p["seconds"] for p in points], [p["measured"] for p in points],
            "k-o" if base else "-", ms=4, lw=2.2 if base else 1.1, zorder=3 if base else 2,
            label=entry["name"] if base else f"{entry['group']}: {entry['name']}",
        )  # fmt: skip
    floor = results["reference"]["nrms"]
    if floor:
        axes.axhline(floor, ls=":", color="grey", label=f"reference: {summary.percent(floor)}")
    _logarithmic(axes, "seconds")


def _logarithmic(axes: Any, across: str) -> None:
    axes.set(xscale="log", yscale="log", xlabel=across, ylabel="error (NRMS)")
    axes.grid(which="both", lw=0.3)
    axes.legend(fontsize=7)
