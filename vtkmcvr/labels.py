"""Label maps and masks: which voxels have a transfer function of their own, or none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .material import TransferFunction

MOST_LABELS = 65533


@dataclass(frozen=True, eq=False)
class Labels:
    """Label map with transfer functions by label.

    A point has the label of the nearest voxel, as in VTK; its scalar is interpolated.

    Parameters
    ----------
    values : array (k, j, i)
        Whole numbers, one for each point of the volume.
    transfers : mapping of int to TransferFunction or None
        None hides a label. Labels without an entry have the volume's own transfer function.
    """

    values: NDArray
    transfers: Mapping[int, TransferFunction | None]

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", whole_numbers("labels", self.values))
        transfers = dict(self.transfers)
        if len(transfers) > MOST_LABELS:
            raise ValueError(f"at most {MOST_LABELS} labels can differ, got {len(transfers)}")
        for label, transfer in transfers.items():
            if isinstance(label, bool) or not isinstance(label, (int, np.integer)):
                raise ValueError(f"a label is a whole number, got {label!r}")
            if not isinstance(transfer, TransferFunction | None):
                raise TypeError(f"label {label} needs a TransferFunction, got {transfer!r}")
        object.__setattr__(self, "transfers", transfers)


def whole_numbers(name: str, values: object) -> NDArray:
    """Return an array (k, j, i) of integers or bools, or say what is wrong with it.

    Floats are taken where all of them are whole, as files often store them.
    """
    array = np.asarray(values)
    if array.ndim != 3:
        raise ValueError(f"{name} has one value per voxel, shape (k, j, i); got {array.shape}")
    if array.dtype.kind == "f":
        if not np.array_equal(array, np.trunc(array)) or not (np.abs(array) < 2.0**31).all():
            raise ValueError(f"{name} must be whole numbers, got {array.dtype} with fractions")
        return array.astype(np.int32)
    if array.dtype.kind not in "iub":
        raise ValueError(f"{name} must be whole numbers, got type {array.dtype}")
    return array


def check_grid(name: str, array: NDArray | None, shape: tuple[int, ...]) -> None:
    """Raise unless the array has a value for each point of a volume of shape (k, j, i)."""
    if array is not None and array.shape != shape:
        raise ValueError(
            f"{name} must have the volume's grid of {' x '.join(map(str, shape[::-1]))} points, "
            f"got {' x '.join(map(str, array.shape[::-1]))}; resample it first"
        )
