"""One film out of several independent ones of the same scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import packed
from .moments import copy_film

Plane = NDArray[np.float64]


def merge(first: packed.Film, *others: packed.Film) -> packed.Film:
    """Film of all samples of films that were rendered with different seeds.

    Moments are added up by pairs (Chan, Golub, LeVeque, "Updating formulae and a pairwise algorithm
    for computing sample variances", 1979): the order changes roundings only.

    Parameters
    ----------
    first, *others : vtkmcvr.packed.Film
        Of one size, with the same planes. Pixels may have any number of samples; with Sobol points,
        what is left over of batches of `vtkmcvr.packed.BATCH` must not fill another one: half a
        batch cannot be completed by that of another seed.

    Returns
    -------
    vtkmcvr.packed.Film
        With arrays of its own. It has no seed, so it cannot be continued.

    Raises
    ------
    ValueError
        Where sizes, planes or numbers of samples do not fit.
    """
    film = copy_film(first)
    for other in others:
        _check(film, other)
        _add(film, other)
    return film


def _check(film: packed.Film, other: packed.Film) -> None:
    if film.count.shape != other.count.shape:
        raise ValueError(
            "films of one size can be merged, got {1} x {0} and {3} x {2}".format(
                *film.count.shape, *other.count.shape
            )
        )
    for name in ("albedo", "normal", "batches", "behind", "cover"):
        if (getattr(film, name) is None) != (getattr(other, name) is None):
            raise ValueError(f"only one of the films to be merged has {name}")
    left = film.count % packed.BATCH + other.count % packed.BATCH
    if film.batches is not None and (left >= packed.BATCH).any():
        raise ValueError(
            f"films of Sobol points merge by whole batches of {packed.BATCH} samples, got pixels "
            f"with {int(left.max())} left over"
        )


def _add(film: packed.Film, other: packed.Film) -> None:
    """Add the samples of another film."""
    n, m = film.count, other.count
    _add_moments(film.mean, film.m2, n[..., None], other.mean, other.m2, m[..., None])
    if film.batches is not None and other.batches is not None:
        k, j = (count[..., None] // packed.BATCH for count in (n, m))
        _add_moments(*film.batches, k, *other.batches, j)
    for name in ("albedo", "normal", "behind"):
        mine, theirs = getattr(film, name), getattr(other, name)
        if mine is not None:
            mine += (theirs - mine) * _share(n, m)[..., None]
    if film.cover is not None and other.cover is not None:
        film.cover[:] += (other.cover - film.cover) * _share(n, m)
    film.depth[:] += (other.depth - film.depth) * _share(film.hits, other.hits)
    for name in ("count", "hits", "rejected", "violations"):
        getattr(film, name)[:] += getattr(other, name)


def _add_moments(
    mean: Plane, m2: Plane, n: NDArray, other_mean: Plane, other_m2: Plane, m: NDArray
) -> None:
    step = other_mean - mean
    m2 += other_m2 + step * step * (n * _share(n, m))
    mean += step * _share(n, m)


def _share(n: NDArray, m: NDArray) -> Plane:
    """Share m / (n + m), 0 without samples."""
    return m / np.maximum(n + m, 1)
