"""Masks and solids that a look made, made again from what a recipe says."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..recipes.content_hash import content_hash
from ..recipes.deserialise import from_plain
from ..segmentation import Segmentation, solid_arrays, without
from ..volume import Volume
from .body import DENSER_THAN, body_mask
from .catalogue import LOOKS


def chosen_labels(segmentation: Segmentation | None) -> dict[str, list[int]] | None:
    """What a recipe says of a segmentation: numbers of labels, no names."""
    if segmentation is None:
        return None
    solid = () if segmentation.only_hides else segmentation.shown
    return {"solid": list(solid), "gone": list(segmentation.gone)}


def recorded_arrays(
    recipe: Mapping[str, Any], scene: Mapping[str, Any], given: Sequence[NDArray[Any]]
) -> dict[str, NDArray[Any]]:
    """Arrays, by content hash, that a recipe's look and segmentation make of those at hand.

    Parameters
    ----------
    recipe : mapping
        Its "preset" names the look, its "segmentation" the labels that are solid or left out.
    scene : mapping
        The recipe's scene as JSON values.
    given : sequence of arrays
        Voxels and labels that were brought.
    """
    masks = recorded_masks(recipe, scene, given)
    return masks | _recorded_solids(recipe.get("segmentation"), given, list(masks.values()))


def _recorded_solids(
    chosen: Any, given: Sequence[NDArray[Any]], masks: Sequence[NDArray[Any]]
) -> dict[str, NDArray[Any]]:
    if not isinstance(chosen, Mapping):
        return {}
    solid, gone = (
        [n for n in chosen.get(part) or () if isinstance(n, int)] for part in ("solid", "gone")
    )
    found: list[NDArray[Any]] = []
    for labels in given:
        if labels.ndim == 3 and labels.dtype.kind in "iu" and np.isin(solid + gone, labels).any():
            left = without(labels, gone)
            found += [left, *(left * (m != 0) for m in masks if m.shape == left.shape)]
            found += solid_arrays(labels, solid) if solid else ()
    return {content_hash(array): array for array in found}


def recorded_masks(
    recipe: Mapping[str, Any], scene: Mapping[str, Any], given: Iterable[NDArray[Any]]
) -> dict[str, NDArray[Any]]:
    """Masks of the body, by content hash, that the look of a recipe gives the volumes at hand.

    Parameters
    ----------
    recipe : mapping
        Its "preset" names the look.
    scene : mapping
        The recipe's scene as JSON values.
    given : iterable of arrays
        Voxels that were brought.
    """
    look = LOOKS.get(str(recipe.get("preset")))
    if look is None or look.body is None:
        return {}
    try:
        transfer = from_plain(scene["transfer"], {}, "transfer")
        matrix = from_plain(scene["volume"]["index_to_world"], {}, "index_to_world")
        (x0, *_), *_, (x1, *_) = transfer.opacity.nodes
    except (LookupError, TypeError, ValueError, AttributeError):
        return {}
    first, last = look.opacity[0][0], look.opacity[-1][0]
    factor = (x1 - x0) / (last - first)
    level = x0 + factor * (DENSER_THAN - first)
    found = {}
    for values in given:
        mask = body_mask(Volume(values, matrix), level, look.body) if values.ndim == 3 else None
        if mask is not None:
            found[content_hash(mask)] = mask
    return found
