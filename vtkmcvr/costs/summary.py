"""A study in figures that people ask for: seconds to 10 % and to 1 %, what a second gives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

# Kinds of variants whose difference from their reference is noise, and how well it must be known
UNBIASED, SURE = ("same mean", "other scene"), 0.15


@dataclass(frozen=True)
class Row:
    """Summary of one variant.

    Attributes
    ----------
    group, name, kind : str
    seconds_per_sample : float
        Of one sample for every pixel: processor time over threads, which other work on the machine
        disturbs little.
    noise : float or None
        NRMS noise of one sample per pixel; None where the variance is not known (denoisers).
    floor : float
        NRMS difference from the scene as it is that no sample removes: bias or another model.
    floor_spread : float
        95 % half width of `floor`; a floor below it is not distinguishable from 0.
    last : dict
        Last point measured.
    bias : dict or None
        Of directional occlusion: NRMS difference from the model that it approximates.
    """

    group: str
    name: str
    kind: str
    seconds_per_sample: float
    noise: float | None
    floor: float
    floor_spread: float
    last: dict[str, Any]
    bias: dict[str, float] | None = None

    @property
    def biased(self) -> bool:
        """Whether the difference from the scene as it is exceeds its uncertainty."""
        return self.floor > self.floor_spread

    def seconds_to(self, target: float) -> float | None:
        """Seconds until noise is down to an NRMS of `target`; None where the noise is unknown."""
        if self.noise is None:
            return None
        return self.seconds_per_sample * (self.noise / target) ** 2

    def nrms_after(self, seconds: float) -> float | None:
        """Noise after a time; None where it is unknown."""
        if self.noise is None:
            return None
        return self.noise / math.sqrt(seconds / self.seconds_per_sample)


def rows(results: dict[str, Any]) -> list[Row]:
    """Summaries of all variants, the scene as it is first."""
    return [row(entry) for entry in results["measured"].values()]


def row(entry: dict[str, Any]) -> Row:
    """Summary of a variant's points."""
    last = entry["points"][-1]
    noise = floor = None
    if last["estimated"] is not None:
        noise = _noise(entry["kind"], last) * math.sqrt(last["samples"])
        floor = math.sqrt(max(last["measured"] ** 2 - last["estimated"] ** 2, 0.0))
    # d floor = measured / floor d measured, where the floor is above its own uncertainty
    spread = math.sqrt(max((last["measured"] + last["spread"]) ** 2 - last["measured"] ** 2, 0.0))
    return Row(
        entry["group"], entry["name"], entry["kind"], last["cpu_seconds"] / last["samples"], noise,
        last["measured"] if floor is None else floor, spread, last, entry.get("bias"),
    )  # fmt: skip


def _noise(kind: str, last: dict[str, Any]) -> float:
    """Noise of a picture: as measured where nothing else is in the difference and it is sure.

    The estimate of fewer than two batches of Sobol points is an upper one.
    """
    sure = kind in UNBIASED and last["spread"] < SURE * last["measured"]
    return last["measured"] if sure else last["estimated"]


def seconds(x: float | None) -> str:
    """Duration as people write it."""
    if x is None:
        return "–"
    if x < 1:
        return f"{x * 1000:.0f} ms"
    if x < 100:
        return f"{x:.1f} s"
    return f"{x / 60:.0f} min" if x < 6000 else f"{x / 3600:.1f} h"


def percent(x: float | None) -> str:
    """Error as people write it."""
    return "–" if x is None else f"{x:.1%}" if x >= 0.01 else f"{x:.2%}"


def markdown(results: dict[str, Any]) -> str:
    """Answers first, then one table for each group."""
    found = rows(results)
    base = found[0]
    width, height = results["size"]
    where = results["machine"]
    lines = [
        f"{width} x {height} pixels on {results['threads']} threads, {where['processor']}. "
        f"Reference: {results['reference']['samples']} samples, its own error "
        f"{percent(results['reference']['nrms'])}. Seconds are those of the processor over the "
        f"number of threads; {percent(share(results))} of the clock's.",
        "",
        f"- An error of 10 % costs {seconds(base.seconds_to(0.1))}, "
        f"1 % costs {seconds(base.seconds_to(0.01))}.",
        f"- One second gives an error of {percent(base.nrms_after(1.0))}.",
        "",
    ]
    for group in dict.fromkeys(row.group for row in found):
        members = [row for row in found if row.group == group]
        shaded = group == "occlusion"
        lines += _occlusion(members, results) if shaded else _table(group, members, base)
    for key, reason in results["refused"].items():
        lines += [f"Not measured: {key}: {reason}.", ""]
    if results["left_out"]:
        lines += ["Not measured, the time was over: " + "; ".join(results["left_out"]) + ".", ""]
    return "\n".join(lines)


def _table(group: str, members: list[Row], base: Row) -> list[str]:
    lines = [
        f"### {group}",
        "",
        "| | time per sample | to 10 % | to 1 % | time at equal error | difference left |",
        "|---|---|---|---|---|---|",
    ]
    for one in members:
        equal = one.seconds_to(0.01)
        known = base.seconds_to(0.01)
        ratio = f"{equal / known:.2f} x" if equal is not None and known else "–"
        left = f"{percent(one.floor)} ({one.kind})" if one.biased else "none seen"
        if one.kind == "other scene":
            ratio, left = "–", "–"
        lines.append(
            f"| {one.name} | {one.seconds_per_sample / base.seconds_per_sample:.2f} x "
            f"| {seconds(one.seconds_to(0.1))} | {seconds(one.seconds_to(0.01))} | {ratio} "
            f"| {left} |"
        )
    return [*lines, ""]


def _occlusion(members: list[Row], results: dict[str, Any]) -> list[str]:
    lines = [
        "### occlusion",
        "",
        "| | time | difference from the scene as it is (model) | at the best brightness | from the "
        "cone that it stands for (bias) | Monte Carlo of the cone with as much noise takes |",
        "|---|---|---|---|---|---|",
    ]
    for one in members:
        assert one.bias is not None
        known = cone_seconds(one, results)
        lines.append(
            f"| {one.name} | {seconds(one.seconds_per_sample)} | {percent(one.floor)} "
            f"| {percent(one.bias['matched'])} | {percent(one.bias['nrms'])} | {seconds(known)} |"
        )
    return [*lines, ""]


def cone_seconds(one: Row, results: dict[str, Any]) -> float | None:
    """Seconds until Monte Carlo of the cone has noise as large as the bias of occlusion."""
    assert one.bias is not None
    cone = results["cones"][f"{one.bias['half_angle']:g}"]
    if cone["nrms"] is None or not one.bias["nrms"]:
        return None
    return cone["seconds"] * (cone["nrms"] / one.bias["nrms"]) ** 2


def share(results: dict[str, Any]) -> float:
    """Processor seconds over those of the clock: below 1 where other work disturbed."""
    last = [entry["points"][-1] for entry in results["measured"].values()]
    return sum(p["cpu_seconds"] for p in last) / max(sum(p["seconds"] for p in last), 1e-9)
