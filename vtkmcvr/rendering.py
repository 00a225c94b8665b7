"""Scene -> picture."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from . import backends, checks, packed, schedule
from .adaptive import PILOT_SAMPLES, PILOT_SHARE, Density, density_of, pilot_seed
from .film.moments import copy_film, new_film
from .pictures.picture import Display, Picture
from .plan import Plan, plan
from .scene import Scene
from .schedule import Progress, StopRules

logger = logging.getLogger("vtkmcvr")

DEFAULT_SAMPLES = 64


def render_scene(
    scene: Scene | Plan,
    *,
    samples: int | None = None,
    seconds: float | None = None,
    nrms: float | None = None,
    adaptive: bool = False,
    seed: int = 0,
    threads: int | None = None,
    backend: str = "auto",
    display: Display | None = None,
    progress: Callable[[Progress], object] | None = None,
    abort: Callable[[], bool] | None = None,
    recipe: dict[str, Any] | None = None,
) -> Picture:
    """Render a scene until the first stop rule is met.

    Parameters
    ----------
    scene : Scene or Plan
    samples : int, optional
        Samples per pixel, >= 1. Default: 64, or unlimited with `seconds` or `nrms`.
    seconds : float, optional
        Time to render, > 0; compilation is not counted.
    nrms : float, optional
        Error to reach, > 0, with 95 % confidence. Whichever rule is met first ends the render.
    adaptive : bool
        Samples go where a short pilot sees noise, and `samples` counts those of the mean pixel;
        see `vtkmcvr.adaptive`. The pilot counts for `seconds`. Where it does not end within a
        quarter of them, samples are spread evenly, and the log says so.
    seed : int
        >= 0. The same seed gives the same bits for any number of threads.
    threads : int, optional
        >= 1. Default: all CPUs that the process may use.
    backend : {"auto", "cpu", "cuda"}
        "auto": a CUDA device where there is one and numba-cuda is installed, else the CPU. Their
        pictures differ by roundings.
    display : Display, optional
        Exposure and background of the display picture.
    progress : callable, optional
        Called with a `Progress` from the calling thread, a few dozen times a second.
    abort : callable, optional
        Asked as often; True ends the render with a valid picture.
    recipe : dict, optional
        Kept with the picture.

    Returns
    -------
    Picture
    """
    rules = _rules(samples, seconds, nrms, abort)
    checks.whole("seed", seed, least=0)
    if seed >= 2**63:
        raise ValueError(f"seed must be below 2^63, got {seed}")
    threads = (
        schedule.default_threads() if threads is None else checks.whole("threads", threads, least=1)
    )
    planned = scene if isinstance(scene, Plan) else plan(scene)
    density, piloted = _pilot(backend, planned, rules, seed, threads) if adaptive else (None, 0.0)
    if rules.seconds is not None:
        rules = replace(rules, seconds=max(rules.seconds - piloted, 0.0))
    film = empty_film(planned)
    done = _run(backend, planned, film, rules, seed, threads, progress, density)
    return Picture(
        done.film, with_note(planned, done.note), display or Display(), piloted + done.seconds,
        done.stopped_by, seed, threads, recipe or {}, density, done.backend, done.device,
    )  # fmt: skip


def _pilot(
    backend: str, planned: Plan, rules: StopRules, seed: int, threads: int
) -> tuple[Density | None, float]:
    """Where samples should go, None where a short pilot could not tell in time; its seconds."""
    seconds = None if rules.seconds is None else PILOT_SHARE * rules.seconds
    short = StopRules(PILOT_SAMPLES, seconds, rules.abort)
    film = empty_film(planned)
    done = backends.run(backend, planned.packed, film, short, pilot_seed(seed), threads)
    if done.stopped_by == "samples":
        return density_of(done.film), done.seconds
    if done.stopped_by == "seconds":
        logger.warning("too little time for a pilot: samples are spread evenly")
    return None, done.seconds


def with_note(planned: Plan, note: str) -> Plan:
    """Plan with one more note, where there is any."""
    return replace(planned, notes=(*planned.notes, note)) if note else planned


def empty_film(planned: Plan) -> packed.Film:
    """Film without samples, with all that the scene asks for."""
    scene, backdrop = planned.scene, planned.scene.backdrop
    return new_film(
        *scene.size, planned.packed.sobol, scene.aovs, behind=backdrop is not None,
        veils=backdrop is not None and backdrop.veils is not None,
    )  # fmt: skip


def continue_picture(
    picture: Picture,
    samples: int | None,
    seconds: float | None,
    nrms: float | None,
    progress: Callable[[Progress], object] | None,
    abort: Callable[[], bool] | None,
) -> Picture:
    """A picture with more samples; the one given stays as it is."""
    rules = _rules(samples, seconds, nrms, abort)
    film = copy_film(picture.film)
    backend = "auto" if picture.backend == "cuda" else "cpu"
    done = _run(
        backend, picture.plan, film, rules, picture.seed, picture.threads, progress, picture.density
    )
    return Picture(
        done.film, with_note(picture.plan, done.note), picture.display,
        picture.seconds + done.seconds, done.stopped_by, picture.seed, picture.threads,
        picture.recipe, picture.density, done.backend, done.device,
    )  # fmt: skip


def _run(
    backend: str,
    planned: Plan,
    film: packed.Film,
    rules: StopRules,
    seed: int,
    threads: int,
    progress: Callable[[Progress], object] | None,
    density: Density | None,
) -> backends.Rendered:
    """`backends.run`, which says so where samples had to be rejected."""
    before = int(film.rejected.sum())
    done = backends.run(
        backend, planned.packed, film, rules, seed, threads, progress, density=density
    )
    film = done.film
    rejected = int(film.rejected.sum()) - before
    if rejected:
        logger.warning(
            "%d of %d samples were not finite and count as black (%d of them met an extinction "
            "above its bound): please report this scene",
            rejected, film.count.sum(), film.violations.sum(),
        )  # fmt: skip
    return done


def _rules(
    samples: int | None,
    seconds: float | None,
    nrms: float | None,
    abort: Callable[[], bool] | None,
) -> StopRules:
    if samples is not None:
        checks.whole("samples", samples, least=1)
    elif seconds is None and nrms is None:
        samples = DEFAULT_SAMPLES
    if seconds is not None:
        checks.number("seconds", seconds, above=0.0)
    if nrms is not None:
        checks.number("nrms", nrms, above=0.0)
    return StopRules(samples, seconds, abort, nrms)
