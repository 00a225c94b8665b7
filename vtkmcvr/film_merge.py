"""One film out of several independent ones of the same scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import packed
from .film import copy_film

Plane = NDArray[np.float64]


def merge(first: packed.Film, *others: packed.Film) -> packed.Film:
    """Film of all samples of films that were rendered with different seeds.

    Moments are added up by pairs (Chan, Golub, LeVeque, "Updating formulae and a pairwise algorithm
    for computing sample variances", 1979): the order changes roundings only.

    Parameters
    ----------
    first, *others : vtkmcvr.packed.Film
        Of one size, with the same planes. With Sobol points, numbers of samples are multiples of
        `vtkmcvr.packed.BATCH`: half a batch cannot be completed by that of another seed.

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
            f"films of one size can be merged, got {film.count.shape[::-1]} and "
            f"{other.count.shape[::-1]}"
        )
    for name in ("albedo", "normal", "batches"):
        if (getattr(film, name) is None) != (getattr(other, name) is None):
            raise ValueError(f"only one of the films to be merged has {name}")
    if film.batches is not None and any((f.count % packed.BATCH).any() for f in (film, other)):
        raise ValueError(
            f"films of Sobol points can be merged after multiples of {packed.BATCH} samples"
        )


def _add(film: packed.Film, other: packed.Film) -> None:
    """Add the samples of another film."""
    n, m = film.count, other.count
    _add_moments(film.mean, film.m2, n[..., None], other.mean, other.m2, m[..., None])
    if film.batches is not None and other.batches is not None:
        k, j = (count[..., None] // packed.BATCH for count in (n, m))
        _add_moments(*film.batches, k, *other.batches, j)
    for mine, theirs in ((film.albedo, other.albedo), (film.normal, other.normal)):
        if mine is not None and theirs is not None:
            mine += (theirs - mine) * _share(n, m)[..., None]
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
