"""A rendered picture: film, plan and how it came about. Arrays are [row, column], row 0 on top."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import film as films
from . import packed, picture_files
from .display import to_rgba8
from .plan import Plan
from .schedule import Progress

Colour = tuple[float, float, float]
SUFFIXES = (".png", ".exr", ".npz", ".vti")


@dataclass(frozen=True)
class Display:
    """How radiance becomes pixels; changing it traces no ray.

    Parameters
    ----------
    exposure : float
        Stops; +1 doubles the brightness before tone mapping.
    background : (r, g, b), optional
        sRGB colour from 0 to 1 behind the volume. None: transparent.
    """

    exposure: float = 0.0
    background: Colour | None = None


@dataclass(frozen=True, eq=False)
class Picture:
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
        What was asked for, enough to make the picture again.
    """

    film: packed.Film
    plan: Plan
    display: Display
    seconds: float
    stopped_by: str
    seed: int
    threads: int
    recipe: dict[str, Any] = field(default_factory=dict)

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
    def standard_error(self) -> NDArray[np.float32]:
        """Standard error of `radiance`, (H, W, 3); inf below two samples."""
        return films.standard_error(self.film)

    @property
    def nrms(self) -> float:
        """Estimated error: RMS over pixels and channels of the error over RMS of the radiance."""
        return films.nrms(self.film)

    @property
    def samples(self) -> int:
        """Samples per pixel that every pixel has."""
        return int(self.film.count.min())

    @property
    def rejected(self) -> int:
        """Samples that were not finite and count as black; 0 unless something is wrong."""
        return int(self.film.rejected.sum())

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
    def rgba(self) -> NDArray[np.uint8]:
        """Display picture, (H, W, 4): tone-mapped sRGB with straight alpha."""
        return self.show(self.display)

    def show(self, display: Display) -> NDArray[np.uint8]:
        """Display picture under another exposure or background, (H, W, 4) uint8."""
        seen = bool(self.plan.packed.environment_visible)
        return to_rgba8(
            self.radiance,
            None if seen else self.alpha,
            exposure=display.exposure,
            background=display.background,
        )

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
        from .rendering import continue_picture

        return continue_picture(self, samples, seconds, nrms, progress, abort)

    def arrays(self) -> dict[str, NDArray]:
        """All arrays by public name."""
        return {
            "rgba": self.rgba,
            "radiance": self.radiance,
            "alpha": self.alpha,
            "depth": self.depth,
            "standard_error": self.standard_error,
        }

    def facts(self) -> dict[str, Any]:
        """What was measured, as plain JSON values; an unknown NRMS is None."""
        return {
            "samples": self.samples,
            "seconds": self.seconds,
            "paths_per_second": self.paths_per_second,
            "nrms": self.nrms if np.isfinite(self.nrms) else None,
            "stopped_by": self.stopped_by,
            "effects": {e.name: {"on": e.on, "reason": e.reason} for e in self.plan.effects},
            "notes": list(self.plan.notes),
            "rejected": self.rejected,
            "seed": self.seed,
            "threads": self.threads,
            "size": list(self.size),
        }

    def save(self, path: str | os.PathLike) -> Path:
        """Write .png (display picture) or .exr, .npz, .vti (float radiance, AOVs, recipe)."""
        target = check_suffix(path)
        suffix = target.suffix.lower()
        if suffix == ".png":
            picture_files.write_png(target, self.rgba)
        elif suffix == ".npz":
            picture_files.write_npz(target, self.arrays(), self.recipe)
        elif suffix == ".vti":
            picture_files.write_vti(target, self.arrays(), self.recipe)
        else:
            picture_files.write_exr(target, self.arrays(), self.recipe)
        return target

    def _repr_png_(self) -> bytes:
        """Show itself in a notebook."""
        with tempfile.TemporaryDirectory() as folder:
            return self.save(Path(folder) / "picture.png").read_bytes()


def check_suffix(path: str | os.PathLike) -> Path:
    """Path to save a picture to, or a ValueError that lists the file types."""
    target = Path(path)
    if target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"a picture is saved as {', '.join(SUFFIXES)}; got {target.name!r}")
    return target
