"""Further volumes in the same place, and what each volume of a scene can have of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from .cutting import Cropping, Shape, shapes
from .labels import Labels, check_grid, whole_numbers
from .material import Surface, TransferFunction
from .volume import Volume


@dataclass(frozen=True, eq=False)
class Layer:
    """Another volume in a scene; where volumes overlap, their extinctions add.

    Parameters
    ----------
    volume, transfer
        With a grid, a place in the world and a look of its own.
    surface : Surface, optional
        None: volume scattering only.
    clip, crop, mask, labels
        As in `Scene`, for this volume alone.
    """

    volume: Volume
    transfer: TransferFunction
    surface: Surface | None = None
    clip: tuple[Shape, ...] = ()
    crop: Cropping | None = None
    mask: NDArray | None = None
    labels: Labels | None = None

    def __post_init__(self) -> None:
        check_parts(self)


def check_parts(owner: Any) -> None:
    """Validate the cuts, mask and labels of a Scene or Layer against its volume."""
    object.__setattr__(owner, "clip", shapes(owner.clip))
    if not isinstance(owner.crop, Cropping | None):
        raise TypeError(f"crop takes a Cropping, got {type(owner.crop).__name__}")
    if not isinstance(owner.labels, Labels | None):
        raise TypeError(f"labels takes Labels, got {type(owner.labels).__name__}")
    shape = owner.volume.values.shape
    if owner.mask is not None:
        object.__setattr__(owner, "mask", whole_numbers("mask", owner.mask))
        check_grid("mask", owner.mask, shape)
    if owner.labels is not None:
        check_grid("labels", owner.labels.values, shape)


def layers(value: object) -> tuple[Layer, ...]:
    """Return a tuple of layers; one layer stands for itself."""
    found = (value,) if isinstance(value, Layer) else tuple(value)  # type: ignore[arg-type]
    for layer in found:
        if not isinstance(layer, Layer):
            raise TypeError(f"layers takes Layer objects, got {type(layer).__name__}")
    return found
