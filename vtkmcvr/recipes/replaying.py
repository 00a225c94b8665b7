"""Recipe -> the same picture again."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import __version__, backends, checks, schedule
from ..adaptive import Density, level_of
from ..emission_absorption import recipe as emission_absorption
from ..occlusion import recipe as occlusion
from ..pictures.noiseless import NoiselessPicture
from ..pictures.picture import Display, Picture
from ..plan import Plan, plan
from ..presets.recorded import recorded_arrays
from ..rendering import empty_film, with_note
from ..scene import Scene
from ..schedule import Progress, StopRules
from ..volume import Volume
from .content_hash import content_hash
from .deserialise import MissingArray, from_plain
from .files import read_recipe
from .recipe import FORMAT, counts_of, film_hash

NOISELESS: dict[str, Callable[..., NoiselessPicture]] = {
    "occlusion": occlusion.render_again,
    "emission-absorption": emission_absorption.render_again,
}


class Replayed(NamedTuple):
    """Result of `replay`.

    Attributes
    ----------
    picture : Picture or NoiselessPicture
    identical : bool
        Whether the film has the recorded one's bits.
    notes : tuple of str
        Why it may not.
    """

    picture: Picture | NoiselessPicture
    identical: bool
    notes: tuple[str, ...]


def replay(
    source: str | os.PathLike[str] | dict[str, Any],
    data: Any = (),
    *,
    threads: int | None = None,
    progress: Callable[[Progress], object] | None = None,
    abort: Callable[[], bool] | None = None,
) -> Replayed:
    """Make a saved picture again, with the same bits.

    They are the same for the same version on the same kind of processor.

    Parameters
    ----------
    source : path or dict
        Picture of any technique that `save` wrote, or its recipe.
    data : vtkImageData, Volume, numpy.ndarray, or a sequence of these
        What the recipe has only hashes of: the volume, labels on its grid, the pixels of an
        environment map. The synthetic head is made anew.
    threads, progress, abort : optional
        See `vtkmcvr.render_scene`.

    Returns
    -------
    Replayed

    Raises
    ------
    ValueError
        Where the file has no recipe, the recipe is none of this version, or data is missing or
        differs from what the picture was made of.
    """
    recipe = source if isinstance(source, dict) else read_recipe(source)
    part = _replay_part(recipe)
    scene = _scene(recipe, part, [_values(item) for item in _items(data)])
    noted = {name: value for name, value in recipe.items() if name not in ("measured", "replay")}
    if recipe.get("technique") in NOISELESS:
        render_again = NOISELESS[recipe["technique"]]
        again = render_again(scene, part, noted, threads, progress, abort)
        again = again.with_display(_display(part))
        backend = getattr(again, "backend", "cpu")
        return Replayed(again, *_verdict(occlusion.film_hash(again.planes), part, backend))
    planned = _planned(scene)
    seed = checks.whole("the recipe's seed", part.get("seed"), least=0)
    counts = counts_of(part.get("samples"), planned.scene.size)
    density = _density(part, planned.scene.size)
    threads = threads or schedule.default_threads()
    rules = StopRules(level_of(counts, density), None, abort)
    # Bits are those of the backend; the other one's picture is better than none
    backend = "auto" if part.get("backend") == "cuda" else "cpu"
    film = empty_film(planned)
    done = backends.run(
        backend, planned.packed, film, rules, seed, threads, progress, counts, density
    )
    picture = Picture(
        done.film, with_note(planned, done.note), Display(), done.seconds, done.stopped_by, seed,
        threads, noted, density, done.backend, done.device,
    )  # fmt: skip
    verdict = _verdict(film_hash(done.film), part, done.backend)
    return Replayed(_shown(picture, part), *verdict)


def _density(part: dict[str, Any], size: tuple[int, int]) -> Density | None:
    plain = part.get("density")
    if plain is None:
        return None
    density = counts_of(plain, size)
    if density.min() < 1:
        raise ValueError("the recipe has pixels that get no samples")
    return density


def _verdict(bits: str, part: dict[str, Any], backend: str = "cpu") -> tuple[bool, tuple[str, ...]]:
    identical = bits == part.get("film")
    notes = []
    if backend != part.get("backend", "cpu"):
        notes.append("made by CUDA, replayed by the CPU, whose roundings differ")
    if part.get("version") != __version__:
        notes.append(f"made by vtkmcvr {part.get('version')}, replayed by {__version__}")
    if not identical:
        notes.append("the film differs from the recorded one: another version or processor")
    return identical, tuple(notes)


def _replay_part(recipe: dict[str, Any]) -> dict[str, Any]:
    part = recipe.get("replay")
    if not isinstance(part, dict):
        raise ValueError("the recipe does not say how to replay the picture")
    if part.get("format") != FORMAT:
        raise ValueError(
            f"the recipe has format {part.get('format')!r} of vtkmcvr {part.get('version')!r}; "
            f"this is {__version__}, which reads format {FORMAT}"
        )
    if "impossible" in part:
        raise ValueError(f"this picture cannot be replayed: {part['impossible']}")
    technique = recipe.get("technique", "monte-carlo")
    if technique not in ("monte-carlo", *NOISELESS):
        raise ValueError(f"pictures of the technique {technique!r} cannot be replayed")
    return part


# Scene


def _scene(recipe: dict[str, Any], part: dict[str, Any], given: Sequence[NDArray[Any]]) -> Scene:
    arrays = {content_hash(array): array for array in given}
    try:
        scene = from_plain(part.get("scene"), arrays)
    except MissingArray as missing:
        arrays |= _phantom_like(missing)
        arrays |= recorded_arrays(recipe, part.get("scene") or {}, list(arrays.values()))
        try:
            scene = from_plain(part.get("scene"), arrays)
        except MissingArray as still:
            raise ValueError(_missing(still, given)) from None
    if not isinstance(scene, Scene):
        raise ValueError("the recipe holds no scene")
    return scene


def _planned(scene: Scene) -> Plan:
    try:
        return plan(scene)
    except (TypeError, AttributeError, IndexError) as error:
        raise ValueError(f"the recipe's scene is none of this version: {error}") from error


def _phantom_like(missing: MissingArray) -> dict[str, NDArray[Any]]:
    """Synthetic head of the missing array's size, by content hash; empty for other shapes."""
    from ..phantom import head_phantom

    shape = missing.form["shape"]
    if len(set(shape)) != 1 or len(shape) != 3 or not 16 <= shape[0] <= 1024:
        return {}
    values = head_phantom(shape[0]).values
    return {content_hash(values): values}


def _missing(missing: MissingArray, given: Sequence[NDArray[Any]]) -> str:
    if not given:
        return f"the recipe has only a hash of its data; give what it was made of: {missing}"
    hashes = ", ".join(content_hash(array)[:12] for array in given)
    return f"the picture was made of other data ({missing}) than what was given (hash {hashes})"


def _items(data: Any) -> list[Any]:
    return list(data) if isinstance(data, (list, tuple)) else [data]


def _values(item: Any) -> NDArray[Any]:
    if isinstance(item, np.ndarray):
        return item
    if isinstance(item, Volume):
        return item.values
    from ..vtk_bridge.scene import volume_of

    return volume_of(item).values


# Display


def _display(part: dict[str, Any]) -> Display:
    try:
        return Display(**part.get("display", {}))
    except TypeError as error:
        raise ValueError(f"the recipe's display is none of this version: {error}") from None


def _shown(picture: Picture, part: dict[str, Any]) -> Picture:
    display = _display(part)
    how = part.get("denoised")
    if how is None:
        return picture.with_display(display)
    if not isinstance(how, dict):
        raise ValueError(f"the recipe's denoiser is none of this version: {how!r}")
    guided = picture.with_display(display, exposure=how.get("exposure", display.exposure))
    return guided.denoised(how.get("method", "")).with_display(display)
