"""A picture by directional occlusion."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from ..pictures.noiseless import NoiselessPicture
from .settings import Occlusion
from .sweep import Work


@dataclass(frozen=True, eq=False)
class OcclusionPicture(NoiselessPicture):
    """Result of `vtkmcvr.render(..., technique="occlusion")`.

    Attributes
    ----------
    settings : Occlusion
    work : Work
        Pixels times layers: all, looked up, and seen.
    backend, device : str
        "cpu" or "cuda", and the name of the CUDA device.
    """

    settings: Occlusion
    work: Work
    backend: str = "cpu"
    device: str = ""

    technique = "occlusion"

    @property
    def rendered_on(self) -> str:
        """What did the work, in words."""
        return f"{self.threads} threads" if self.backend == "cpu" else f"CUDA ({self.device})"

    def own_facts(self) -> dict[str, Any]:
        """Return what is of occlusion alone."""
        return {
            "backend": self.backend,
            "device": self.device,
            "mode": self.settings.mode,
            "half_angle": self.settings.half_angle,
            "fragments": self.work.naive,
            "fragments_looked_up": self.work.looked_up,
            "fragments_seen": self.work.seen,
        }

    def own_recipe(self) -> dict[str, Any]:
        """Return the settings, and what `vtkmcvr.replay` reads."""
        from .recipe import replay_part

        return {
            "occlusion": asdict(self.settings),
            "replay": replay_part(
                self.plan.scene, self.settings, self.display, self.planes, backend=self.backend
            ),
        }

    def __str__(self) -> str:
        width, height = self.size
        share = self.work.looked_up / max(self.work.naive, 1)
        return (
            f"{width} x {height}, directional occlusion ({self.settings.mode}) in "
            f"{self.seconds:.2f} s on {self.rendered_on}; looked up {share:.0%} of all "
            "fragments; biased, no error estimate"
        )
