"""Figures of a study, by matplotlib."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from . import families, summary
from .stored import load_error
from .variants import MODEL, OTHER

# Errors over the RMS radiance that maps show as black and as white
LEAST, MOST = 1e-3, 1.0
COLUMNS = 4


def draw(results: dict[str, Any], folder: Path, maps: Path | None = None) -> list[Path]:
    """Write figures of what was measured into a folder; return their paths.

    `convergence.png`, `error-time.png`, and where there is something to show `aperture.png`,
    `lights.png` and `errors.png`, from the maps of errors in the folder `maps`.
    """
    paths = [
        save_figure(folder / "convergence.png", lambda axes: _convergence(axes, results)),
        save_figure(folder / "error-time.png", lambda axes: _error_time(axes, results)),
    ]
    names = {families.APERTURES: "aperture.png", families.LIGHTS: "lights.png"}
    for group, name in names.items():
        curves = {
            entry["name"]: entry["points"]
            for entry in results["measured"].values()
            if entry["group"] == group
        }
        if curves:
            paths.append(save_figure(folder / name, partial(converge, curves=curves)))
    return [*paths, *_error_maps(results, folder / "errors.png", maps)]


def save_figure(path: Path, paint: Callable[[Any], object]) -> Path:
    """Write a figure of one diagram."""
    figure = _figure((7.2, 4.8))
    paint(figure.add_subplot())
    figure.savefig(path, dpi=130)
    return path


def _figure(size: tuple[float, float]) -> Any:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ImportError(
            "figures need matplotlib: pip install 'vtkmcvr[plot]', or go without by figures=False"
        ) from None
    return Figure(figsize=size, layout="constrained")


def converge(axes: Any, curves: dict[str, list[dict[str, Any]]], across: str = "samples") -> None:
    """Measured error of several scenes with 95 % bands, estimated error, the line 1 / sqrt(N)."""
    for index, (name, points) in enumerate(curves.items()):
        x = np.array([p[across] for p in points])
        measured = np.array([p["measured"] for p in points])
        spread = np.minimum([p["spread"] for p in points], 0.9 * measured)
        (line,) = axes.plot(x, measured, "o-", ms=3, lw=1.2, label=name)
        axes.fill_between(
            x, measured - spread, measured + spread, color=line.get_color(), alpha=0.2
        )
        known = [(p[across], p["estimated"]) for p in points if p["estimated"] is not None]
        if known:
            label = "estimated by the picture" if index == 0 else None
            axes.plot(*zip(*known, strict=True), "s", mfc="none", ms=6, mec=line.get_color(),
                      label=label)  # fmt: skip
    _root_line(axes, next(iter(curves.values())), across)
    _logarithmic(axes, "samples per pixel" if across == "samples" else "seconds")


def _root_line(axes: Any, points: list[dict[str, Any]], across: str) -> None:
    x = np.array([p[across] for p in points], float)
    last = points[-1]["measured"]
    label = r"$1/\sqrt{N}$" if across == "samples" else r"$1/\sqrt{t}$"
    axes.plot(x, last * np.sqrt(x[-1] / x), "--", color="grey", lw=1, label=label)


def _convergence(axes: Any, results: dict[str, Any]) -> None:
    """Error against samples of the scene as it is."""
    entry = next(iter(results["measured"].values()))
    converge(axes, {"measured, 95 % band": entry["points"]})


def _error_time(axes: Any, results: dict[str, Any]) -> None:
    """Error against seconds of every variant that shows the same picture, and the Pareto front."""
    shown = [e for e in results["measured"].values() if e["kind"] not in (MODEL, OTHER)]
    for index, entry in enumerate(shown):
        points = entry["points"]
        base = entry["group"] == "scene"
        axes.plot(
            [p["cpu_seconds"] for p in points], [p["measured"] for p in points],
            marker="o" if base else None, ms=4, lw=2.2 if base else 1.1, zorder=3 if base else 2,
            color="black" if base else f"C{index % 10}", ls="-" if index <= 10 else "--",
            label=entry["name"] if base else f"{entry['group']}: {entry['name']}",
        )  # fmt: skip
    front = pareto([p for entry in shown for p in entry["points"]])
    axes.plot(
        [p["cpu_seconds"] for p in front], [p["measured"] for p in front], color="gold", lw=7,
        alpha=0.5, zorder=1, label="Pareto front: no way measured is better in both",
    )  # fmt: skip
    floor = results["reference"]["nrms"]
    if floor:
        axes.axhline(floor, ls=":", color="grey", label=f"reference: {summary.percent(floor)}")
    _logarithmic(axes, "seconds")


def pareto(points: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Points of which no other is at least as quick and as exact, by time."""
    front: list[dict[str, Any]] = []
    for point in sorted(points, key=lambda p: (p["cpu_seconds"], p["measured"])):
        if point["measured"] > 0 and (not front or point["measured"] < front[-1]["measured"]):
            front.append(point)
    return front


def _logarithmic(axes: Any, across: str) -> None:
    axes.set(xscale="log", yscale="log", xlabel=across, ylabel="error (NRMS)")
    axes.grid(which="both", lw=0.3)
    axes.legend(fontsize=6)


def _error_maps(results: dict[str, Any], path: Path, maps: Path | None) -> list[Path]:
    """Where the errors are, one map for each variant that has one."""
    planes = [
        (entry, plane)
        for key, entry in results["measured"].items()
        if (plane := load_error(maps, key)) is not None
    ]
    if not planes:
        return []
    from matplotlib.colors import LogNorm

    rows = -(-len(planes) // COLUMNS)
    height, width = planes[0][1].shape
    figure = _figure((2.6 * COLUMNS, (2.6 * height / width + 0.35) * rows))
    grid = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for axes in grid:
        axes.axis("off")
    for axes, (entry, plane) in zip(grid, planes, strict=False):
        shown = axes.imshow(
            np.maximum(plane.astype(float), LEAST), cmap="inferno", norm=LogNorm(LEAST, MOST)
        )
        last = entry["points"][-1]
        title = f"{entry['group']}: {entry['name']}\n{summary.percent(last['measured'])}"
        axes.set_title(title, fontsize=7)
    figure.colorbar(shown, ax=list(grid), shrink=0.4, label="RMS error / RMS radiance")
    figure.savefig(path, dpi=80)
    _to_palette(path)
    return [path]


def _to_palette(path: Path) -> None:
    """Store a picture of one colour map in 256 colours: a third of the bytes."""
    from PIL import Image

    with Image.open(path) as image:
        small = image.convert("RGB").quantize(256, dither=Image.Dither.NONE)
    small.save(path, optimize=True)
