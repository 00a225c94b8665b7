"""Film: running moments per pixel, and what they say about the error."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import film_error, packed
from .accuracy import image_error

Image = NDArray[np.float32]


def new_film(
    width: int, height: int, sobol: packed.Sobol | None = None, aovs: Collection[str] = ()
) -> packed.Film:
    """Empty film of width x height pixels, for samples drawn as `sobol` says.

    `aovs` names the planes to record, "albedo" and "normal".
    """
    plane, colour = (height, width), (height, width, 3)
    return packed.Film(
        count=np.zeros(plane, np.int64),
        mean=np.zeros(colour, np.float64),
        m2=np.zeros(colour, np.float64),
        hits=np.zeros(plane, np.int64),
        depth=np.zeros(plane, np.float64),
        rejected=np.zeros(plane, np.int64),
        albedo=np.zeros(colour, np.float64) if "albedo" in aovs else None,
        normal=np.zeros(colour, np.float64) if "normal" in aovs else None,
        batches=None if sobol is None else _new_batches(colour),
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
    """Share of samples that collided in the volume, (H, W), [0, 1]."""
    return (film.hits / np.maximum(film.count, 1)).astype(np.float32)


def depth(film: packed.Film) -> Image:
    """Mean distance from camera to collision, (H, W); inf where no sample collided."""
    return np.where(film.hits > 0, film.depth, np.inf).astype(np.float32)


def standard_error(film: packed.Film) -> Image:
    """Standard error of the mean radiance, (H, W, 3); inf, unknown, below two samples.

    From variances pooled over 5 x 5 pixels: `mean +- 1.96 standard_error` covers the truth in 95 %
    of the pixels, from eight samples on.
    """
    return np.sqrt(film_error.smooth_variance(film)).astype(np.float32)


def nrms(film: packed.Film) -> float:
    """Estimated NRMS error of the radiance; see `vtkmcvr.accuracy.image_error`."""
    return image_error(film).nrms


def merged(first: packed.Film, second: packed.Film) -> packed.Film:
    """Film of the samples of two films of the same scene, which share none of them.

    Pixels may have any number of samples in either (Chan, Golub, LeVeque 1979).

    Raises
    ------
    ValueError
        For films of other sizes or planes, and where what is left over of batches of Sobol points
        would fill another one.
    """
    _check_mergeable(first, second)
    n, more = first.count, second.count
    mean, m2 = _joined(n, first.mean, first.m2, more, second.mean, second.m2)
    hits = first.hits + second.hits
    batches = None
    if first.batches is not None and second.batches is not None:
        whole, others = n // packed.BATCH, more // packed.BATCH
        batches = packed.Batches(*_joined(whole, *first.batches, others, *second.batches))
    return packed.Film(
        count=n + more, mean=mean, m2=m2, hits=hits,
        depth=_weighted(first.hits, first.depth, second.hits, second.depth),
        rejected=first.rejected + second.rejected,
        albedo=_weighted_plane(n, first.albedo, more, second.albedo),
        normal=_weighted_plane(n, first.normal, more, second.normal),
        batches=batches,
    )  # fmt: skip


def _check_mergeable(first: packed.Film, second: packed.Film) -> None:
    if first.count.shape != second.count.shape:
        sizes = " and ".join("{1} x {0}".format(*f.count.shape) for f in (first, second))
        raise ValueError(f"films to merge are of one size, got {sizes}")
    for name in ("albedo", "normal", "batches"):
        if (getattr(first, name) is None) != (getattr(second, name) is None):
            raise ValueError(f"films to merge both have {name}, or neither")
    if first.batches is not None:
        left = first.count % packed.BATCH + second.count % packed.BATCH
        if (left >= packed.BATCH).any():
            raise ValueError(
                f"films of Sobol points merge by whole batches of {packed.BATCH} samples, got "
                f"pixels with {int(left.max())} left over"
            )


def _joined(n, mean, m2, more, other, other_m2):  # type: ignore[no-untyped-def]
    """Mean and squared deviations of n values and more others."""
    total = np.maximum(n + more, 1)[..., None]
    step = other - mean
    weight = (more[..., None] / total) * step
    return mean + weight, m2 + other_m2 + n[..., None] * weight * step


def _weighted(n, values, more, others):  # type: ignore[no-untyped-def]
    return values + more / np.maximum(n + more, 1) * (others - values)


def _weighted_plane(n, values, more, others):  # type: ignore[no-untyped-def]
    return None if values is None else _weighted(n[..., None], values, more[..., None], others)
