"""Who sweeps the layers: the CPU, or a CUDA device."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from .. import backends, packed
from ..gpu.errors import CudaError
from .medium import Filling
from .raster import Raster
from .sweep import Light, Sweep, Work


class Parts(NamedTuple):
    """What a sweep takes; see `Sweep`."""

    raster: Raster
    filling: Filling
    light: Light
    shade: packed.Shade | None
    film: packed.OcclusionFilm


class Swept(NamedTuple):
    """Film of a sweep, and how it came about."""

    film: packed.OcclusionFilm
    work: Work
    ended: bool  # whether it came to the last layer
    backend: str  # "cpu" or "cuda"
    device: str  # name of the CUDA device; "" for the CPU
    note: str  # why the CPU did what CUDA was to do, or ""


def sweep(
    backend: str,
    parts: Parts,
    threads: int,
    progress: Callable[[float], object] | None = None,
    abort: Callable[[], bool] | None = None,
    openings: packed.Openings | None = None,
) -> Swept:
    """Sweep all layers; where "auto" takes CUDA and that fails, the CPU does it anew.

    `openings` are those of a backdrop, which is the CPU's.
    """
    if openings is not None and backend == "cuda":
        raise CudaError(
            "occlusion before the backdrop of another renderer is not on CUDA: use backend 'cpu' "
            "or 'auto'"
        )
    if backend == "auto" and (parts.raster.count == 0 or openings is not None):
        backend = "cpu"
    return backends.attempt(
        backend,
        lambda: _on_cuda(parts, progress, abort),
        lambda note: _on_cpu(parts, threads, progress, abort, note, openings),
    )


def _on_cuda(
    parts: Parts, progress: Callable[[float], object] | None, abort: Callable[[], bool] | None
) -> Swept:
    from ..gpu import sweeps
    from .tables import blocks_in, tables_of

    raster = parts.raster
    device = sweeps.SweepDevice()
    if raster.count == 0:
        return Swept(parts.film, Work(0), True, "cuda", device.name, "")
    tables = tables_of(*parts)
    film, counts, ended = sweeps.run(device, tables, blocks_in(raster), progress, abort)
    naive = raster.count * raster.rows * raster.columns
    work = Work(naive, int(counts[0]), int(counts[1]))
    return Swept(film, work, ended, "cuda", device.name, "")


def _on_cpu(
    parts: Parts,
    threads: int,
    progress: Callable[[float], object] | None,
    abort: Callable[[], bool] | None,
    note: str,
    openings: packed.Openings | None = None,
) -> Swept:
    swept = Sweep(*parts, openings)
    ended = swept.run(threads, progress, abort)
    return Swept(parts.film, swept.work, ended, "cpu", "", note)
