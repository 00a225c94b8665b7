"""The first estimate of a new view, made within a frame: as many pixels as there is time for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from .. import schedule
from ..backdrop import Backdrop
from ..emission_absorption import EmissionAbsorption
from ..noiseless import render_noiseless
from ..occlusion import Occlusion
from ..plan import Plan, plan
from ..rendering import empty_film
from ..scene import Scene
from .job import Estimate
from .settings import LiveSettings
from .shown import noiseless_picture_of, picture_of
from .work import Look, on_device, work_of

COARSEST = 8
# The same without noise; the time of occlusion depends little on the number of pixels
NOISELESS_SCALE, OCCLUSION_DETAIL, STEP = 3, 0.35, 1.0
# Camera paths per second, before any have been traced
GUESS = 5e5


class Preview:
    """One sample in each pixel of a film that is coarser than the window's where it must be."""

    def __init__(self) -> None:
        self._rate = GUESS

    def estimate(self, planned: Plan, settings: LiveSettings) -> Estimate:
        """First estimate of a planned scene."""
        scene = planned.scene
        if settings.noiseless:
            return _noiseless(coarsened(scene, NOISELESS_SCALE), settings)
        if on_device(planned, settings):
            return _by_device(planned, settings)
        scale = self._scale(scene.size, settings.preview)
        coarse = plan(coarsened(scene, scale), planned) if scale > 1 else planned
        film = empty_film(coarse)
        threads = settings.threads or schedule.default_threads()
        rules = schedule.StopRules(1, None, None)
        _, seconds = schedule.run(coarse.packed, film, rules, settings.seed, threads)
        paths = film.count.size
        self._rate = 0.5 * self._rate + 0.5 * paths / max(seconds, 1e-4)
        backdrop = coarse.scene.backdrop
        shown = picture_of(
            film, settings.exposure_of(scene), veiled=None if backdrop is None else backdrop.veiled
        )
        return Estimate(shown, 1 if scale == 1 else 0, math.inf, False)

    def _scale(self, size: tuple[int, int], seconds: float) -> int:
        """Edge of a pixel of the estimate, in the window's pixels."""
        need = math.sqrt(size[0] * size[1] / max(self._rate * seconds, 1.0))
        return int(np.clip(math.ceil(need), 1, COARSEST))


def _by_device(planned: Plan, settings: LiveSettings) -> Estimate:
    """One sample in each pixel of the window, by a device that has compiled the kernels."""
    work, backdrop = work_of(planned, settings), planned.scene.backdrop
    work.advance(schedule.StopRules(1, None, None))
    veiled = None if backdrop is None else backdrop.veiled
    shown = work.shown(Look(settings.exposure_of(planned.scene), None, veiled))
    return Estimate(shown, 1, math.inf, False)


def _noiseless(scene: Scene, settings: LiveSettings) -> Estimate:
    # A device compiles longer than a frame may take
    picture = render_noiseless(
        settings.technique, scene, _quick(settings), settings.exposure,
        settings.exposure_of(scene), threads=settings.threads, backend="cpu",
    )  # fmt: skip
    return Estimate(noiseless_picture_of(picture), 0, math.nan, False, settings.technique)


def _quick(settings: LiveSettings) -> Occlusion | EmissionAbsorption:
    """What is asked for, coarser."""
    if settings.technique == "occlusion":
        own = settings.occlusion or Occlusion()
        return Occlusion(half_angle=own.half_angle, mode="fast", detail=OCCLUSION_DETAIL)
    shading = (settings.emission_absorption or EmissionAbsorption()).shading
    return EmissionAbsorption(STEP, shading=shading)


def coarsened(scene: Scene, scale: int) -> Scene:
    """Scene on a film of larger pixels."""
    width, height = (max(1, round(n / scale)) for n in scene.size)
    backdrop = scene.backdrop
    if backdrop is not None:
        rows = np.minimum(np.arange(height) * scale + scale // 2, scene.size[1] - 1)
        columns = np.minimum(np.arange(width) * scale + scale // 2, scene.size[0] - 1)
        there = np.ix_(np.zeros(1, int), rows, columns)
        entries = np.arange(backdrop.depth.size).reshape(backdrop.depth.shape)[there].ravel()
        backdrop = Backdrop(
            backdrop.depth[there], backdrop.colour[there], backdrop.offsets[:1],
            None if backdrop.veils is None else backdrop.veils.at(entries),
        )  # fmt: skip
    return replace(scene, size=(width, height), backdrop=backdrop)
