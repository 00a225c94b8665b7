"""Compile ahead of time: the kernels of all looks, for the types of voxels that files have."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from . import checks
from .front import scene_of
from .pack import structure
from .phantom import head_phantom
from .plan import Plan, plan
from .presets import LOOKS
from .rendering import empty_film
from .scene import Volume
from .schedule import fill_up
from .voxels import NATIVE

# CT, MR and labels as most files store them
TYPES = ("int16", "uint8")
POINTS = 24

Report = Callable[[str, float], object]


def warm_up(
    types: Sequence[str] = TYPES,
    presets: Sequence[str] | None = None,
    *,
    aovs: Sequence[str] = (),
    report: Report | None = None,
) -> int:
    """Compile what pictures of looks need, into the on-disk cache.

    Parameters
    ----------
    types : sequence of {"uint8", "int16", "uint16", "float32"}
        Of voxels; all other types are converted to one of these.
    presets : sequence of str, optional
        Names of looks. Default: all of them; most share their kernels.
    aovs : sequence of {"albedo", "normal"}
        What else the pictures record.
    report : callable, optional
        Called with words for each set of kernels and the seconds that it took.

    Returns
    -------
    int
        Number of different sets of kernels.
    """
    done = set()
    for kind in types:
        checks.choice("type", kind, NATIVE)
        for name in LOOKS if presets is None else presets:
            for planned in _plans(kind, name, aovs):
                key = structure(planned.packed)
                if key not in done:
                    done.add(key)
                    seconds = _compile(planned)
                    if report is not None:
                        report(f"{name}, {kind}", seconds)
    return len(done)


def _plans(kind: str, look: str, aovs: Sequence[str]) -> Iterator[Plan]:
    """Plans of a look for small volumes of one type, with and without what CT looks leave out."""
    head = head_phantom(POINTS)
    values: NDArray = head.values
    if np.dtype(kind).kind == "u":
        values = np.interp(values, (values.min(), values.max()), (0, np.iinfo(kind).max))
    volume = Volume.from_grid(values.astype(kind), head.spacing, head.origin)
    for whole in (False, True):
        scene = scene_of(volume, preset=look, size=(8, 6), whole=whole, aovs=tuple(aovs)).scene
        yield plan(scene)


def _compile(planned: Plan) -> float:
    """Seconds to compile the kernels of a plan, or to load them from the cache."""
    start = time.perf_counter()
    film = empty_film(planned)
    fill_up(planned.packed, film, film.count, 0)
    return time.perf_counter() - start
