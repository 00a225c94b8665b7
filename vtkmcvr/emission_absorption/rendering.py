"""Scene -> picture by emission and absorption."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import checks, packed
from ..kernels.absorption import absorb_rows
from ..kernels.absorption_rays import RAY_COLUMNS
from ..occlusion.medium import OPAQUE, Filled, volumes_of
from ..openings import Openings, openings_of
from ..pack import f32, f64, matrix, matrix64, vector64
from ..phases import Isotropic
from ..plan import Plan, plan
from ..planning.volume import PackedVolume
from ..scene import Scene
from ..schedule import Progress, compiling, default_threads
from ..screen import Display
from .explain import effects_of
from .picture import EmissionAbsorptionPicture, Steps
from .settings import EmissionAbsorption
from .shading import shaded_scene

# Rows of a strip: what a thread takes at a time
ROWS = 4
# Steps through the whole of a scene that a sample distance may ask for
MOST_STEPS = 10_000_000
# Parts of a scene that only light transport has
PLAIN: dict[str, Any] = {"scattering": "single", "max_scatterings": None, "aovs": ()}
# VTK displays composited colours as they are
AS_VTK = Display(gamma=1.0, curve="none")
# Renders rows from one to before another; returns steps in all, and those looked up
Rows = Callable[[int, int], tuple[int, int]]


def render_emission_absorption(
    scene: Scene,
    settings: EmissionAbsorption | None = None,
    *,
    threads: int | None = None,
    display: Display | None = None,
    progress: Callable[[Progress], object] | None = None,
    abort: Callable[[], bool] | None = None,
    recipe: dict[str, Any] | None = None,
) -> EmissionAbsorptionPicture:
    """Render a scene by emission and absorption, as VTK's volume mappers do.

    Parameters
    ----------
    scene : Scene
        Volumes, transfer functions, cuts, masks, labels, camera, film, `aovs`; its lights and lens
        do not count.
    settings : EmissionAbsorption, optional
    threads : int, optional
        >= 1; changes no bit. Default: all CPUs that the process may use.
    display : Display, optional
        Default: numbers as they are, as VTK shows them.
    progress, abort : callable, optional
        As for `vtkmcvr.render_scene`, after each strip of rows.
    recipe : dict, optional
        Kept with the picture.

    Returns
    -------
    EmissionAbsorptionPicture

    Raises
    ------
    ValueError
        For receivers, which are surfaces that only light transport knows; for a sample distance
        that makes more than ten million steps through the scene.
    """
    settings = settings or EmissionAbsorption()
    threads = default_threads() if threads is None else checks.whole("threads", threads, least=1)
    _check_parts(scene)
    planned = plan(_bare(scene, settings))
    _check_distance(planned, settings)
    film = _film(scene)
    openings = None
    if scene.backdrop is not None:
        openings = openings_of(scene.backdrop, scene.camera.frame[2])
    rows = _rows(planned, settings, film, openings)
    begin = perf_counter()
    steps, ended = _run(rows, film, threads, progress, abort)
    effects, notes = effects_of(scene, planned, settings)
    return EmissionAbsorptionPicture(
        _planes(film), replace(planned, scene=scene, effects=effects, notes=notes), settings,
        display or AS_VTK, perf_counter() - begin, "end" if ended else "user", threads, steps,
        recipe=recipe or {}, behind=None if openings is None else openings.behind(),
    )  # fmt: skip


def _check_parts(scene: Scene) -> None:
    if scene.receivers:
        raise ValueError(
            "technique emission-absorption does not know receivers: leave them out, or use "
            "technique monte-carlo"
        )


def _check_distance(planned: Plan, settings: EmissionAbsorption) -> None:
    """Refuse a sample distance that would take for ever."""
    if settings.sample_distance is None or planned.empty:
        return
    longest = float(np.linalg.norm(np.ptp(planned.corners, axis=0)))
    if longest / settings.sample_distance > MOST_STEPS:
        raise ValueError(
            f"a sample_distance of {settings.sample_distance:g} makes more than {MOST_STEPS} steps "
            f"through a scene of {longest:g} world units: give at least "
            f"{longest / MOST_STEPS:.2g}, or step=... in voxels"
        )


def _bare(scene: Scene, settings: EmissionAbsorption) -> Scene:
    """What counts of a scene."""
    shaded = shaded_scene(scene, settings)
    camera = replace(scene.camera, lens=None)
    return replace(shaded, camera=camera, lights=(), phase=Isotropic(), **PLAIN)


def _film(scene: Scene) -> packed.RayFilm:
    width, height = scene.size
    shape, colour = (height, width), (height, width, 3)
    return packed.RayFilm(
        np.zeros(colour, f32), np.zeros(shape, f32), np.zeros(shape, f32),
        np.zeros(colour, f32) if "albedo" in scene.aovs else None,
        np.zeros(colour, f32) if "normal" in scene.aovs else None,
    )  # fmt: skip


def _absorbers(planned: Plan, normals: bool) -> tuple[packed.Absorber, ...]:
    """All volumes as kernels take them; with gradients where they are shaded or recorded."""
    # Empty ones are left out, but the first
    return tuple(
        _absorber(filled, volume, normals)
        for filled, volume in zip(volumes_of(planned), planned.volumes, strict=True)
    )


def _absorber(filled: Filled, volume: PackedVolume, normals: bool) -> packed.Absorber:
    to_world = np.linalg.inv(volume.index_to_world[:3, :3]).T
    wanted = normals or volume.phong is not None
    return packed.Absorber(
        filled.medium, filled.transfer, filled.integrals, volume.phong,
        matrix(to_world) if wanted else None,
        matrix64(filled.index_from_world), vector64(filled.index_of_centre),
    )  # fmt: skip


def _march(settings: EmissionAbsorption) -> packed.March:
    distance = settings.sample_distance
    return packed.March(
        f64(1 / settings.step if distance is None else 0),
        f64(0 if distance is None else 1 / distance),
        f32(OPAQUE if settings.skip else 0), np.bool_(settings.skip), np.int64(settings.rays),
    )  # fmt: skip


def _rows(
    planned: Plan, settings: EmissionAbsorption, film: packed.RayFilm, openings: Openings | None
) -> Rows:
    """Return what renders some rows, compiled; they are left empty where all of the scene is."""
    scene = planned.packed
    volumes = _absorbers(planned, film.normal is not None)
    march, edges = _march(settings), None if openings is None else openings.packed

    def rows(first: int, end: int) -> tuple[int, int]:
        if planned.empty:
            if edges is not None:
                edges.through[:] = 1
            return 0, 0
        rays = np.zeros((len(volumes), RAY_COLUMNS), f32)
        return absorb_rows(volumes, scene.camera, edges, march, rays, film, first, end)

    compiling(lambda: rows(0, 0))
    return rows


def _run(
    rows: Rows,
    film: packed.RayFilm,
    threads: int,
    progress: Callable[[Progress], object] | None,
    abort: Callable[[], bool] | None,
) -> tuple[Steps, bool]:
    """Render strip by strip. Returns the steps that it took, and whether it came to the end."""
    begin = perf_counter()
    height = len(film.alpha)
    steps, done, stopped = Steps(0, 0), 0, False

    def strip(first: int) -> tuple[int, int]:
        return (0, 0) if stopped else rows(first, min(first + ROWS, height))

    with ThreadPoolExecutor(threads, thread_name_prefix="vtkmcvr") as pool:
        for naive, looked_up in pool.map(strip, range(0, height, ROWS)):
            steps = Steps(steps.naive + naive, steps.looked_up + looked_up)
            done = min(done + ROWS, height)
            if progress is not None and not stopped:
                progress(Progress(done / height, 1, perf_counter() - begin))
            stopped = stopped or (done < height and abort is not None and abort())
    return steps, not stopped


def _planes(film: packed.RayFilm) -> dict[str, NDArray[np.float32]]:
    """Arrays of the picture by public name."""
    seen = film.alpha > 0
    depth = np.where(seen, film.depth / np.where(seen, film.alpha, f32(1)), f32(math.inf))
    planes = {"radiance": film.radiance, "alpha": film.alpha, "depth": depth.astype(f32)}
    found = {"albedo": film.albedo, "normal": film.normal}
    return planes | {name: plane for name, plane in found.items() if plane is not None}
