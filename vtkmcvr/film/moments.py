"""Film: running moments per pixel, and what they say about the error."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..accuracy import image_error
from . import error as film_error

Image = NDArray[np.float32]


def new_film(
    width: int,
    height: int,
    sobol: packed.Sobol | None = None,
    aovs: Collection[str] = (),
    behind: bool = False,
    veils: bool = False,
) -> packed.Film:
    """Empty film of width x height pixels, for samples drawn as `sobol` says.

    `aovs` names the planes to record, "albedo" and "normal"; `behind`: also that of the backdrop,
    `veils`: and what its veils leave of the volume.
    """
    plane, colour = (height, width), (height, width, 3)
    return packed.Film(
        count=np.zeros(plane, np.int64),
        mean=np.zeros(colour, np.float64),
        m2=np.zeros(colour, np.float64),
        hits=np.zeros(plane, np.int64),
        depth=np.zeros(plane, np.float64),
        rejected=np.zeros(plane, np.int64),
        violations=np.zeros(plane, np.int64),
        albedo=np.zeros(colour, np.float64) if "albedo" in aovs else None,
        normal=np.zeros(colour, np.float64) if "normal" in aovs else None,
        batches=None if sobol is None else _new_batches(colour),
        behind=np.zeros((height, width, 4), np.float64) if behind else None,
        cover=np.zeros(plane, np.float64) if veils else None,
    )


def _new_batches(colour: tuple[int, int, int]) -> packed.Batches:
    return packed.Batches(np.zeros(colour, np.float64), np.zeros(colour, np.float64))


def copy_film(film: packed.Film) -> packed.Film:
    """Film with arrays of its own."""
    return _copied(film)


def _copied(part: Any) -> Any:
    if isinstance(part, tuple):
        return type(part)(*map(_copied, part))
    return None if part is None else part.copy()


def alpha(film: packed.Film) -> Image:
    """Share of samples that collided in the volume, (H, W), [0, 1]; less what veils cover."""
    if film.cover is not None:
        return film.cover.astype(np.float32)
    return (film.hits / np.maximum(film.count, 1)).astype(np.float32)


def depth(film: packed.Film) -> Image:
    """Mean distance from camera to collision, (H, W); inf where no sample collided."""
    return np.where(film.hits > 0, film.depth, np.inf).astype(np.float32)


def standard_error(film: packed.Film) -> Image:
    """Standard error of the mean radiance, (H, W, 3); inf, unknown, below two samples.

    From variances of a pixel and its neighbourhood: `mean +- 1.96 standard_error` covers the truth
    in 95 % of the pixels, from eight samples on.
    """
    return np.sqrt(film_error.smooth_variance(film)).astype(np.float32)


def nrms(film: packed.Film) -> float:
    """Estimated NRMS error of the radiance; see `vtkmcvr.accuracy.image_error`."""
    return image_error(film).nrms
