"""What a saved picture says of how it was made: enough to make the same bits again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from numpy.typing import NDArray

from ..occlusion.recipe import replay_part as noted
from ..recipes.deserialise import from_plain
from ..scene import Scene
from ..schedule import Progress
from ..screen import Display
from .picture import EmissionAbsorptionPicture
from .rendering import render_emission_absorption
from .settings import EmissionAbsorption

NAME = "emission_absorption"


def replay_part(
    scene: Scene, settings: EmissionAbsorption, display: Display, planes: Mapping[str, NDArray]
) -> dict[str, Any]:
    """What `vtkmcvr.replay` reads, as plain JSON values; of voxels there are hashes only."""
    return noted(scene, settings, display, planes, NAME)


def render_again(
    scene: Scene,
    part: Mapping[str, Any],
    recipe: dict[str, Any],
    threads: int | None,
    progress: Callable[[Progress], object] | None,
    abort: Callable[[], bool] | None,
) -> EmissionAbsorptionPicture:
    """Picture of a recipe's scene by its settings."""
    settings = from_plain(part.get(NAME), {}, NAME)
    if not isinstance(settings, EmissionAbsorption):
        raise ValueError("the recipe does not say how emission and absorption was computed")
    return render_emission_absorption(
        scene, settings, threads=threads, progress=progress, abort=abort, recipe=recipe
    )
