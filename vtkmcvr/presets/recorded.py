"""Masks that a look made, made again from what a recipe says."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from numpy.typing import NDArray

from ..content_hash import content_hash
from ..deserialise import from_plain
from ..volume import Volume
from .body import DENSER_THAN, body_mask
from .catalogue import LOOKS


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
