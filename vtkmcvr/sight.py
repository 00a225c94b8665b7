"""Whether camera paths of a scene can meet anything at all."""

from __future__ import annotations

import numpy as np

from . import packed
from .adaptive import Density, goals
from .planning.medium import NOWHERE

# Of a picture without light that was given no number of samples
SAMPLES = 16


def dark_around(scene: packed.Scene) -> bool:
    """Whether camera paths that meet no volume are all black."""
    lights = scene.area_lights
    return not (
        scene.environment_visible
        or scene.receivers is not None
        or scene.backdrop is not None
        or (lights is not None and lights.seen is not None)
    )


def nothing_seen(scene: packed.Scene) -> bool:
    """Whether every path is black: all volumes transparent, and nothing beside or behind them."""
    media = [scene.medium, *(layer.medium for layer in scene.more or ())]
    return dark_around(scene) and all(medium.active_hi[0] <= NOWHERE for medium in media)


def fill_black(film: packed.Film, samples: int | None, density: Density | None) -> str:
    """Bring a film up to its samples, all of them black. Returns what ended it."""
    enough = goals(SAMPLES if samples is None else samples, film.count.shape, density)
    np.maximum(film.count, enough, out=film.count)
    return "dark" if samples is None else "samples"
