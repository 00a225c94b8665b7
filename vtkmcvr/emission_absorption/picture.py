"""A picture by emission and absorption."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from ..pictures.noiseless import NoiselessPicture
from .settings import EmissionAbsorption


@dataclass(frozen=True)
class Steps:
    """Steps of all rays: of a loop over everything, and those in which the scalar was looked up."""

    naive: int
    looked_up: int


@dataclass(frozen=True, eq=False)
class EmissionAbsorptionPicture(NoiselessPicture):
    """Result of `vtkmcvr.render(..., technique="emission-absorption")`.

    Colours are numbers of the transfer function, composited and displayed as they are: `rgba` is
    what VTK shows.

    Attributes
    ----------
    settings : EmissionAbsorption
    work : Steps
    """

    settings: EmissionAbsorption
    work: Steps

    technique = "emission-absorption"

    def own_facts(self) -> dict[str, Any]:
        """Return what is of emission and absorption alone."""
        return {
            "step": self.settings.step,
            "sample_distance": self.settings.sample_distance,
            "rays": self.settings.rays,
            "steps": self.work.naive,
            "steps_looked_up": self.work.looked_up,
        }

    def own_recipe(self) -> dict[str, Any]:
        """Return the settings, and what `vtkmcvr.replay` reads."""
        from .recipe import replay_part

        return {
            "emission_absorption": asdict(self.settings),
            "replay": replay_part(self.plan.scene, self.settings, self.display, self.planes),
        }

    def __str__(self) -> str:
        width, height = self.size
        share = self.work.looked_up / max(self.work.naive, 1)
        return (
            f"{width} x {height}, emission and absorption in {self.seconds:.2f} s on "
            f"{self.threads} threads; looked up {share:.0%} of all steps; biased, no error estimate"
        )
