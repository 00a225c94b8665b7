"""The optional parts of a simulation, each with its reason, and what it costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

# Effects of a plan that go together where one switch turns them off
TOGETHER = {
    "lights": ("area lights", "point and directional lights"),
    "environment": ("constant environment", "gradient environment", "environment map"),
    "cuts": ("clipping", "cropping", "mask"),
}
LEGEND = (
    "time: change of the time of a path where the effect is left out, measured; "
    "picture: NRMS difference that this makes"
)


@dataclass(frozen=True)
class Effect:
    """One optional part of the simulation: whether it runs, and why."""

    name: str
    on: bool
    reason: str


@dataclass(frozen=True)
class EffectCost:
    """The scene with something left out.

    Attributes
    ----------
    name : str
        Such as "no shadows".
    effect : str
        The effect of the plan that is left out, "shadows"; or one of `TOGETHER`.
    saved : float
        Change of the time per sample, -0.4: 40 % less.
    change : float
        NRMS difference from the picture with all effects.
    """

    name: str
    effect: str
    saved: float
    change: float


def table(effects: Sequence[Effect], costs: Sequence[EffectCost] = ()) -> list[str]:
    """Lines: effect, on or off, what leaving it out would change where that is known, why."""
    width = max(len(effect.name) for effect in effects)
    known = {name: cost for cost in costs for name in TOGETHER.get(cost.effect, (cost.effect,))}
    lines = []
    for effect in effects:
        cells = _cells(known.get(effect.name) if effect.on else None) if costs else ""
        state = "on " if effect.on else "off"
        lines.append(f"{effect.name:<{width}}  {state}  {cells}{effect.reason}")
    if costs:
        head = f"{'':<{width}}       {'time':>6}  {'picture':>7}  "
        return [head.rstrip(), *lines, LEGEND]
    return lines


def _cells(cost: EffectCost | None) -> str:
    if cost is None:
        return f"{'':>6}  {'':>7}  "
    return f"{cost.saved:>+6.0%}  {cost.change:>7.1%}  "
