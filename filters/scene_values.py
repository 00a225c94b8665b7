"""What decides a picture, as values to compare."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from vtkmcvr.cutting import Box
from vtkmcvr.labels import Labels
from vtkmcvr.layers import Layer
from vtkmcvr.material import TransferFunction, TransferTable
from vtkmcvr.scene import Scene


class Same:
    """Equal to another one where both hold the same object, which lives as long."""

    def __init__(self, value: Any) -> None:
        self.value = value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and self.value is other.value

    __hash__ = None  # type: ignore[assignment]


def value_of(part: Any) -> Any:
    """Part of a scene as a value: small arrays by content, those of the grids by identity."""
    if isinstance(part, tuple):
        return tuple(map(value_of, part))
    if isinstance(part, Mapping):
        return {key: value_of(value) for key, value in part.items()}
    if isinstance(part, np.ndarray):
        return Same(part)
    if isinstance(part, Box | TransferTable):
        return type(part), tuple(map(_content_of, dataclasses.astuple(part)))
    if isinstance(part, Scene | Layer | Labels | TransferFunction):
        names = [field.name for field in dataclasses.fields(part)]
        return type(part), tuple(value_of(getattr(part, name)) for name in names)
    return part


def _content_of(value: Any) -> Any:
    return (value.shape, value.tobytes()) if isinstance(value, np.ndarray) else value
