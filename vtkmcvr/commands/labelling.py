"""Label maps on the command line: `--labels`, `--show`, `--hide`, `--highlight`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..segmentation import Segmentation, paint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..labels import Labels
    from ..recorded_facts import Segment
    from ..scene import TransferFunction, Volume


def labelled(
    data: Any, volume: Volume, stored: Volume, path: str | None, chosen: dict[str, Any],
    options: dict[str, Any],
) -> dict[str, Any]:  # fmt: skip
    """Options of `scene_of` for a label map beside the volume, or for a volume that is one.

    Parameters
    ----------
    data : vtkImageData or Volume
    volume : Volume
        The same, in its place.
    stored : Volume
        The same as the file has it, without `--flip`.
    path : str, optional
        The label map; None: the volume itself.
    chosen : dict
        Text of `show`, `hide` and `highlight`.
    options : dict
        Of `scene_of`, so far.
    """
    from ..front import scene_of
    from ..readers import read_labels
    from ..recorded_facts import segments
    from ..scene import Volume
    from ..vtk_bridge.image import grid_image
    from ..vtk_bridge.scene import volume_of

    parts = {part: _names(text) for part, text in chosen.items() if text}
    if path is None:
        found = () if isinstance(data, Volume) else tuple(segments(data))
        return {"segmentation": Segmentation(volume, found, **parts)}
    image = read_labels(path, like=grid_image(stored))
    values = volume_of(image).values
    if any(chosen.values()):
        beside = Volume(values, volume.index_to_world)
        return {"segmentation": Segmentation(beside, tuple(segments(image)), **parts)}
    transfer = scene_of(data, **options).scene.transfer
    return {"labels": coloured_labels(values, transfer, segments(image))}


def coloured_labels(
    values: NDArray, transfer: TransferFunction, named: Sequence[Segment] = ()
) -> Labels:
    """Labels other than 0 in their colours, their opacity that of the look."""
    from dataclasses import replace

    import numpy as np

    from ..curves import ColourCurve
    from ..labels import Labels, whole_numbers
    from ..reading.colours import spread_colour

    colours = {segment.value: segment.colour for segment in named}
    painted: dict[tuple[float, ...], TransferFunction] = {}
    transfers: dict[int, TransferFunction | None] = {}
    for label in (int(n) for n in np.unique(whole_numbers("labels", values)) if n):
        colour = paint(colours.get(label) or spread_colour(label))
        if colour not in painted:
            painted[colour] = replace(transfer, colour=ColourCurve(((0.0, *colour),)))
        transfers[label] = painted[colour]
    return Labels(values, transfers)


def _names(text: str) -> tuple[str, ...]:
    return ("*",) if text == "all" else tuple(n.strip() for n in text.split(",") if n.strip())
