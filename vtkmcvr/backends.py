"""CPU or CUDA: who does the work, and what becomes of it where CUDA cannot."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import checks, packed, schedule
from .adaptive import Density
from .gpu.available import missing
from .gpu.errors import CudaError, CudaUnavailable
from .schedule import Progress, StopRules
from .sight import nothing_seen

logger = logging.getLogger("vtkmcvr")

BACKENDS = ("auto", "cpu", "cuda")
T = TypeVar("T")


class Rendered(NamedTuple):
    """Film of a run, and how it came about."""

    film: packed.Film
    stopped_by: str
    seconds: float
    backend: str  # "cpu" or "cuda"
    device: str  # name of the CUDA device; "" for the CPU
    note: str  # why the CPU did what CUDA was to do, or ""


def checked(backend: object) -> str:
    """Return the name of a backend, or say which there are."""
    return checks.choice("backend", backend, BACKENDS)


def check_unused(backend: object, technique: str) -> None:
    """Refuse CUDA by name where a technique is the CPU's alone."""
    if checked(backend) == "cuda":
        raise ValueError(
            f"technique {technique} runs on the CPU only: leave backend out, or say backend='cpu'"
        )


def run(
    backend: str,
    scene: packed.Scene,
    film: packed.Film,
    rules: StopRules,
    seed: int,
    threads: int,
    progress: Callable[[Progress], object] | None = None,
    counts: NDArray[np.int64] | None = None,
    density: Density | None = None,
) -> Rendered:
    """Add samples to a film until a rule is met.

    Parameters
    ----------
    backend : {"auto", "cpu", "cuda"}
        "auto" takes CUDA where it can be used, and goes over to the CPU, with a line in the log,
        where CUDA then fails.
    scene, film, rules, seed, threads, progress, density
        See `vtkmcvr.schedule.run`; the film may be changed or not.
    counts : array (H, W), optional
        Samples of each pixel to go on to where the rule was "samples".

    Raises
    ------
    CudaError
        Where "cuda" was asked for by name and cannot be used, or fails.
    """
    if checked(backend) == "auto" and nothing_seen(scene):
        backend = "cpu"
    return attempt(
        backend,
        lambda: _on_cuda(scene, film, rules, seed, progress, counts, density),
        lambda note: _on_cpu(scene, film, rules, seed, threads, progress, counts, density, note),
    )


def attempt(backend: str, on_cuda: Callable[[], T], on_cpu: Callable[[str], T]) -> T:
    """Do some work on CUDA where that can be, else on the CPU, which is told why not.

    Parameters
    ----------
    backend : {"auto", "cpu", "cuda"}
    on_cuda, on_cpu : callable
        The latter takes a note, "" where there is nothing to say.

    Raises
    ------
    CudaError
        Where "cuda" was asked for by name and cannot be used, or fails.
    """
    note = ""
    if checked(backend) != "cpu":
        absent = missing()
        if absent is None:
            try:
                return on_cuda()
            except CudaError as error:
                if backend == "cuda":
                    raise
                note = f"rendered on the CPU: {error}"
                logger.warning(note)
        elif backend == "cuda":
            raise CudaUnavailable(absent)
    return on_cpu(note)


def _on_cuda(
    scene: packed.Scene,
    film: packed.Film,
    rules: StopRules,
    seed: int,
    progress: Callable[[Progress], object] | None,
    counts: NDArray[np.int64] | None,
    density: Density | None,
) -> Rendered:
    from .gpu import launches, several

    device = several.opened()
    film, stopped_by, seconds = launches.run(
        device, scene, film, rules, seed, progress, counts, density
    )
    return Rendered(film, stopped_by, seconds, "cuda", device.name, "")


def _on_cpu(
    scene: packed.Scene,
    film: packed.Film,
    rules: StopRules,
    seed: int,
    threads: int,
    progress: Callable[[Progress], object] | None,
    counts: NDArray[np.int64] | None,
    density: Density | None,
    note: str,
) -> Rendered:
    stopped_by, seconds = schedule.run(scene, film, rules, seed, threads, progress, density)
    if counts is not None and stopped_by == "samples":
        start = time.perf_counter()
        schedule.fill_up(scene, film, counts, seed)
        seconds += time.perf_counter() - start
    return Rendered(film, stopped_by, seconds, "cpu", "", note)
