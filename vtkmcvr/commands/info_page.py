"""The page that `vtkmcvr info` prints."""

from __future__ import annotations

import math
from typing import Any

BAR_WIDTH = 40


def format_info(info: dict[str, Any]) -> str:
    """Format the facts from `volume_info` as a plain-text page.

    Parameters
    ----------
    info : dict
        What `volume_info` returned.

    Returns
    -------
    str
        Lines of text, ending with a histogram whose bars are logarithmic in the count.
    """
    lines = [f"{label:<12} {text}" for label, text in _rows(info) if text]
    lines += [f"{'note':<12} {note}" for note in info["notes"]]
    lines += [f"{'label':<12} {s['value']} {s['name']}" for s in info.get("segments", [])]
    return "\n".join(lines + _histogram_lines(info)) + "\n"


def _rows(info: dict[str, Any]) -> list[tuple[str, str]]:
    unit = f" {info['units']}" if info["units"] else ""
    percentiles = [
        f"{p} %: {_numbers([value])}"
        for p, value in info["percentiles"].items()
        if value is not None
    ]
    return [
        ("dimensions", " x ".join(str(n) for n in info["dimensions"])),
        ("spacing", _numbers(info["spacing"])),
        ("origin", _numbers(info["origin"])),
        ("direction", "   ".join(_numbers(axis) for axis in zip(*info["direction"], strict=True))),
        ("bounds", _numbers(info["bounds"])),
        ("values", _describe_values(info)),
        ("modality", info["modality"]),
        ("range", f"{_numbers(info['range'])}{unit}" if info["range"] else "no finite value"),
        ("percentiles", ", ".join(percentiles)),
        ("not finite", _describe_nonfinite(info)),
    ]


def _describe_nonfinite(info: dict[str, Any]) -> str:
    nan, infinite = info["nan"], info["inf"]
    return f"{nan} NaN, {infinite} infinite" if nan or infinite else ""


def _describe_values(info: dict[str, Any]) -> str:
    if not info["association"]:
        return "none: the image has no point or cell array"
    count = info["components"]
    parts = f", {count} components" if count > 1 else ""
    name = f"'{info['array']}' " if info["array"] else ""
    return f"{name}on {info['association']}, {info['dtype']}{parts}, {info['memory_mb']:.1f} MB"


def _numbers(values: Any) -> str:
    return " ".join(f"{value + 0.0:.6g}" for value in values)


def _histogram_lines(info: dict[str, Any]) -> list[str]:
    counts, edges = info["histogram"]["counts"], info["histogram"]["edges"]
    if not counts:
        return []
    longest = math.log1p(max(counts))
    lines = ["", "from .. to (bars are logarithmic)"]
    for count, low, high in zip(counts, edges[:-1], edges[1:], strict=True):
        bar = "#" * math.ceil(BAR_WIDTH * math.log1p(count) / longest)
        lines.append(f"{low:>12.5g} .. {high:<12.5g} {bar:<{BAR_WIDTH}} {count}".rstrip())
    return lines
