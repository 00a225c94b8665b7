"""What a saved picture says of how it was made: enough to make the same bits again."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Mapping
from typing import Any

from numpy.typing import NDArray

from .. import __version__
from ..recipes.content_hash import content
from ..recipes.deserialise import from_plain
from ..recipes.recipe import FORMAT
from ..recipes.serialise import NotSerialisable, to_plain
from ..scene import Scene
from ..schedule import Progress
from ..screen import Display
from .picture import OcclusionPicture
from .rendering import render_occlusion
from .settings import Occlusion


def film_hash(planes: Mapping[str, NDArray]) -> str:
    """SHA-256 of the radiance and the opacity, in hexadecimal."""
    digest = hashlib.sha256(content(planes["radiance"]))
    digest.update(content(planes["alpha"]))
    return digest.hexdigest()


def replay_part(
    scene: Scene,
    settings: Any,
    display: Display,
    planes: Mapping[str, NDArray],
    name: str = "occlusion",
    backend: str = "cpu",
) -> dict[str, Any]:
    """What `vtkmcvr.replay` reads, as plain JSON values; of voxels there are hashes only.

    `name` is where the settings stand, `backend` the one that made the planes.
    """
    part = {"format": FORMAT, "version": __version__}
    try:
        plain = to_plain(scene)
    except NotSerialisable as error:
        return {**part, "impossible": str(error)}
    return {
        **part,
        "scene": plain,
        name: to_plain(settings, name),
        "display": dataclasses.asdict(display),
        "film": film_hash(planes),
        "backend": backend,
    }


def render_again(
    scene: Scene,
    part: Mapping[str, Any],
    recipe: dict[str, Any],
    threads: int | None,
    progress: Callable[[Progress], object] | None,
    abort: Callable[[], bool] | None,
) -> OcclusionPicture:
    """Picture of a recipe's scene by its settings."""
    settings = from_plain(part.get("occlusion"), {}, "occlusion")
    if not isinstance(settings, Occlusion):
        raise ValueError("the recipe does not say how occlusion was computed")
    # Bits are those of the backend; the other one's picture is better than none
    backend = "auto" if part.get("backend") == "cuda" else "cpu"
    return render_occlusion(
        scene, settings, threads=threads, backend=backend, progress=progress, abort=abort,
        recipe=recipe,
    )  # fmt: skip
