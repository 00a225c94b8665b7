"""What pixels keep, and how it is displayed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Vector


class Batches(NamedTuple):
    """Running moments of the means of batches of `BATCH` samples, [row, column], float64."""

    mean: NDArray[np.float64]  # (H, W, 3) mean of the batches that are complete
    m2: NDArray[np.float64]  # (H, W, 3) sum of squared deviations of their means


class Film(NamedTuple):
    """Running moments per pixel, [row, column], row 0 on top, float64."""

    count: NDArray[np.int64]  # type: ignore[assignment]  # (H, W) samples so far
    mean: NDArray[np.float64]  # (H, W, 3) radiance
    m2: NDArray[np.float64]  # (H, W, 3) sum of squared deviations
    hits: NDArray[np.int64]  # (H, W) samples that collided in the volume
    depth: NDArray[np.float64]  # (H, W) mean distance of the collisions
    rejected: NDArray[np.int64]  # (H, W) samples that were not finite, counted as zero
    violations: NDArray[np.int64]  # (H, W) those of them that met an extinction above its majorant
    # (H, W, 3) means over all samples of what the first collision met, 0 for a miss
    albedo: NDArray[np.float64] | None
    normal: NDArray[np.float64] | None  # world-space unit vectors toward the camera
    batches: Batches | None  # where samples of a batch depend on each other
    # (H, W, 4) mean of what backdrop and veils show, times what is left of it before the volume
    behind: NDArray[np.float64] | None
    cover: NDArray[np.float64] | None  # (H, W) mean of what veils leave of the hits


class FilmTotals(NamedTuple):
    """Sums over the pixels of a film; v is the variance of a mean, m the mean.

    While any pixel is unknown, the sums after that say nothing.
    """

    paths: float
    least: float  # fewest samples of a pixel
    bright: float  # means that are not 0
    unknown: float  # pixels whose variance is unknown
    noise: float  # v
    noise_squares: float  # square of the v of a pixel's three channels together
    squares: float  # m^2
    crossed: float  # m^2 v
    variance_squares: float  # v^2


class Screen(NamedTuple):
    """How a film is displayed; see `vtkmcvr.screen.Display`."""

    scale: np.float32  # of the radiance, before the curve
    film_like: np.bool_  # tone curve of Exposure Render; otherwise cut off at 1
    power: np.float32  # by which light is encoded; 0: sRGB
    window: NDArray[np.float32] | None  # weights of the film filter along an axis
    background: Vector | None  # linear display light
