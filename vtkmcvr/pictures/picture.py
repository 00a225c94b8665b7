"""A rendered picture: film, plan and how it came about. Arrays are [row, column], row 0 on top."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..adaptive import Density, level_of
from ..film import moments as films
from ..plan import Plan
from ..recipes.recipe import recipe_of
from ..schedule import Progress
from ..screen import Display, shown
from .displayed import Displayed, check_suffix

__all__ = ["Display", "Picture", "check_suffix"]

if TYPE_CHECKING:
    from .denoised import DenoisedPicture


@dataclass(frozen=True, eq=False)
class Picture(Displayed):
    """Result of `vtkmcvr.render`.

    Attributes
    ----------
    film : vtkmcvr.packed.Film
        Running moments.
    plan : Plan
        Effects with reasons, and the scene.
    display : Display
        Exposure and background of `rgba`.
    seconds : float
        Rendering time, compilation not counted, over all runs that made this picture.
    stopped_by : str
        "samples", "seconds", "nrms", "dark" (no path has found light) or "user".
    recipe : dict
        What the front door was asked for. A saved picture says more: see `vtkmcvr.recipe`.
    backend : str
        "cpu" or "cuda".
    device : str
        Name of the CUDA device; "" for the CPU.
    density : array (H, W), optional
        Of adaptive samples: how many a pixel gets for four of the mean pixel.
    """

    film: packed.Film
    plan: Plan
    display: Display
    seconds: float
    stopped_by: str
    seed: int
    threads: int
    recipe: dict[str, Any] = field(default_factory=dict)
    density: Density | None = None
    backend: str = "cpu"
    device: str = ""

    technique = "monte-carlo"

    @property
    def radiance(self) -> NDArray[np.float32]:
        """Linear RGB, (H, W, 3), premultiplied by alpha where the volume covers part of a pixel."""
        return self.film.mean.astype(np.float32)

    @property
    def alpha(self) -> NDArray[np.float32]:
        """Opacity of the volume, (H, W), [0, 1]."""
        return films.alpha(self.film)

    @property
    def depth(self) -> NDArray[np.float32]:
        """Mean distance from camera to first collision, (H, W), world units; inf: none."""
        return films.depth(self.film)

    @property
    def albedo(self) -> NDArray[np.float32] | None:
        """Albedo at the first collision, (H, W, 3), mean over all samples; None: not asked for.

        A sample that misses counts as 0, so it is premultiplied as `radiance` is.
        """
        return None if self.film.albedo is None else self.film.albedo.astype(np.float32)

    @property
    def normal(self) -> NDArray[np.float32] | None:
        """Unit normal at the first collision, (H, W, 3), mean over all samples; or None.

        In world coordinates, toward the camera, along the gradient; 0 for a sample that misses or
        finds no gradient. Where samples disagree it is shorter than 1.
        """
        return None if self.film.normal is None else self.film.normal.astype(np.float32)

    @property
    def standard_error(self) -> NDArray[np.float32]:
        """Standard error of `radiance`, (H, W, 3); inf below two samples."""
        return films.standard_error(self.film)

    @property
    def nrms(self) -> float:
        """Estimated error: RMS over pixels and channels of the error over RMS of the radiance."""
        return films.nrms(self.film)

    @property
    def samples(self) -> int:
        """Samples per pixel that every pixel has; of the mean pixel where they are adaptive."""
        return level_of(self.film.count, self.density)

    @property
    def rejected_samples(self) -> int:
        """Samples that were not finite and count as black; 0 unless something is wrong."""
        return int(self.film.rejected.sum())

    @property
    def majorant_violations(self) -> int:
        """Rejected samples that met more extinction than its bound; 0 unless something is wrong."""
        return int(self.film.violations.sum())

    @property
    def size(self) -> tuple[int, int]:
        """(width, height)."""
        height, width = self.film.count.shape
        return width, height

    @property
    def paths_per_second(self) -> float:
        """Camera paths per second of rendering."""
        return float(self.film.count.sum()) / self.seconds if self.seconds > 0 else 0.0

    @property
    def rendered_on(self) -> str:
        """CPU threads or device, in words."""
        return f"{self.threads} threads" if self.backend == "cpu" else f"CUDA ({self.device})"

    @property
    def denoiser(self) -> dict[str, Any] | None:
        """How noise was reduced, as plain JSON values; None: not at all."""
        return None

    def show(self, display: Display, bits: int = 8) -> NDArray[Any]:
        """Display picture under another display, (H, W, 4), uint8, or uint16 for 16 bits."""
        opaque = bool(self.plan.packed.environment_visible)
        return shown(self.radiance, None if opaque else self.alpha, display, bits)

    def denoised(self, method: str = "knn") -> DenoisedPicture:
        """Picture with less noise, and a bias; traces no ray. This one stays as measured.

        Parameters
        ----------
        method : {"knn", "oidn"}
            See `vtkmcvr.denoise`. "oidn" is better where the scene asked for the `aovs` albedo and
            normal.
        """
        from .denoised import denoised

        return denoised(self, method)

    def refine(
        self,
        samples: int | None = None,
        seconds: float | None = None,
        nrms: float | None = None,
        *,
        progress: Callable[[Progress], object] | None = None,
        abort: Callable[[], bool] | None = None,
    ) -> Picture:
        """Continue up to `samples` in all, for `seconds` more, or down to an error of `nrms`.

        The bits are those of a run that was never interrupted.
        """
        from ..rendering import continue_picture

        return continue_picture(self, samples, seconds, nrms, progress, abort)

    def arrays(self) -> dict[str, NDArray]:
        """All arrays by public name; AOVs where the film has them."""
        arrays: dict[str, NDArray | None] = {
            "rgba": self.rgba,
            "radiance": self.radiance,
            "alpha": self.alpha,
            "depth": self.depth,
            "standard_error": self.standard_error,
            "albedo": self.albedo,
            "normal": self.normal,
        }
        return {name: array for name, array in arrays.items() if array is not None}

    def facts(self) -> dict[str, Any]:
        """What was measured, as plain JSON values; an unknown NRMS is None."""
        return {
            "samples": self.samples,
            "adaptive": self.density is not None,
            "seconds": self.seconds,
            "paths_per_second": self.paths_per_second,
            "nrms": self.nrms if np.isfinite(self.nrms) else None,
            "denoised": self.denoiser,
            "stopped_by": self.stopped_by,
            "effects": {e.name: {"on": e.on, "reason": e.reason} for e in self.plan.effects},
            "notes": list(self.plan.notes),
            "rejected_samples": self.rejected_samples,
            "majorant_violations": self.majorant_violations,
            "seed": self.seed,
            "threads": self.threads,
            "backend": self.backend,
            "device": self.device,
            "size": list(self.size),
        }

    def saved_recipe(self) -> dict[str, Any]:
        """What a file of it says about how it was made; see `vtkmcvr.recipe`."""
        return recipe_of(self)
