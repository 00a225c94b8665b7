"""A picture by a technique without noise: what `Picture` offers, but biased."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar, NoReturn

import numpy as np
from numpy.typing import NDArray

from ..plan import Plan
from ..screen import Display, shown
from .displayed import Displayed


@dataclass(frozen=True, eq=False)
class NoiselessPicture(Displayed):
    """Picture by a technique whose rays meet no chance; a subclass says which.

    Attributes
    ----------
    planes : dict of arrays
        "radiance", "alpha", "depth" and, if asked for, "albedo" and "normal", as the properties
        give them.
    plan : Plan
        Effects with reasons, and the scene.
    settings : object
        Of the technique.
    display : Display
        Exposure and background of `rgba`.
    seconds : float
        Rendering time, compilation not counted.
    stopped_by : str
        "end" or "user".
    threads : int
    work : object
        What the picture took.
    recipe : dict
        What was asked for.
    behind : array (H, W, 4), optional
        What the scene's backdrop shows through the volume at its edges and veils, premultiplied.
    """

    planes: dict[str, NDArray[np.float32]]
    plan: Plan
    settings: Any
    display: Display
    seconds: float
    stopped_by: str
    threads: int
    work: Any
    seed: int = 0
    recipe: dict[str, Any] = field(default_factory=dict)
    behind: NDArray[np.float64] | None = None

    technique: ClassVar[str]
    # Biased and deterministic: there is no standard error to give, and no noise to reduce
    standard_error = None
    denoiser = None
    nrms = float("inf")
    biased = True
    samples = 1

    @property
    def radiance(self) -> NDArray[np.float32]:
        """Linear RGB, (H, W, 3), premultiplied by alpha where the volume covers part of a pixel."""
        return self.planes["radiance"]

    @property
    def alpha(self) -> NDArray[np.float32]:
        """Opacity of the volume, (H, W), [0, 1]."""
        return self.planes["alpha"]

    @property
    def depth(self) -> NDArray[np.float32]:
        """Mean distance from camera to first collision, (H, W), world units; inf: none."""
        return self.planes["depth"]

    @property
    def albedo(self) -> NDArray[np.float32] | None:
        """Mean albedo of what is seen, (H, W, 3), times alpha; None: not asked for."""
        return self.planes.get("albedo")

    @property
    def normal(self) -> NDArray[np.float32] | None:
        """Mean world normal toward the viewer, (H, W, 3), times alpha; None: not asked for."""
        return self.planes.get("normal")

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)."""
        height, width = self.alpha.shape
        return width, height

    @property
    def rejected_samples(self) -> int:
        """Pixels that are not finite; 0 unless something is wrong."""
        return int(self.radiance.size // 3 - np.isfinite(self.radiance).all(axis=-1).sum())

    def show(self, display: Display, bits: int = 8) -> NDArray[Any]:
        """Display picture under another display, (H, W, 4), uint8, or uint16 for 16 bits."""
        return shown(self.radiance, self.alpha, display, bits)

    def denoised(self, method: str = "knn") -> NoReturn:
        """Refuse: there is no noise."""
        raise ValueError(f"technique {self.technique} has no noise for {method} to reduce")

    def arrays(self) -> dict[str, NDArray]:
        """All arrays by public name."""
        return {"rgba": self.rgba, **self.planes}

    def facts(self) -> dict[str, Any]:
        """What was measured, as plain JSON values."""
        return {
            "technique": self.technique,
            "biased": True,
            **self.own_facts(),
            "seconds": self.seconds,
            "nrms": None,
            "stopped_by": self.stopped_by,
            "rejected_samples": self.rejected_samples,
            "effects": {e.name: {"on": e.on, "reason": e.reason} for e in self.plan.effects},
            "notes": list(self.plan.notes),
            "threads": self.threads,
            "size": list(self.size),
        }

    def own_facts(self) -> dict[str, Any]:
        """Facts of the technique; implemented by subclasses."""
        raise NotImplementedError

    def own_recipe(self) -> dict[str, Any]:
        """Settings of the technique, and what `vtkmcvr.replay` reads; by subclasses."""
        raise NotImplementedError

    def saved_recipe(self) -> dict[str, Any]:
        """What the front door noted, what came out, and what the technique adds."""
        return {
            **self.recipe,
            "technique": self.technique,
            "exposure": self.display.exposure,
            "background": self.display.background,
            "measured": {
                "seconds": self.seconds, "nrms": None, "stopped_by": self.stopped_by,
                "rejected_samples": self.rejected_samples,
            },
            **self.own_recipe(),
        }  # fmt: skip
