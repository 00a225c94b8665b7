"""The optional parts of a simulation, each with its reason."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Effect:
    """One optional part of the simulation: whether it runs, and why."""

    name: str
    on: bool
    reason: str
