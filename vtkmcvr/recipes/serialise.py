"""Frozen dataclasses of this package as plain JSON values; `deserialise` is the way back.

A dataclass becomes {"type": "lights.PointLight", field: value, ...}; what a field is called and
holds decides the form, so that a new kind of light or shape needs no line here. Large arrays
(voxels, masks, environment maps) are not written: their content hash and shape stand for them, and
who reads the form back must bring the array itself. A picture thus carries no patient's data. A
field with the metadata `content_hash.INSIDE` can hold none and is written whatever its size.
"""

from __future__ import annotations

import base64
import dataclasses
import math
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .content_hash import INSIDE, content, content_hash, little_endian

PACKAGE = __name__.partition(".")[0]
TYPE, ARRAY, OUTSIDE, FLOAT, MAPPING = "type", "array", "outside array", "float", "mapping"
# Elements of the largest array that is written; voxels and pixels, three axes or more, never are
LARGEST_INSIDE = 256


class NotSerialisable(TypeError):
    """A value has no plain form; the message says where and why."""


def to_plain(value: Any, place: str = "scene") -> Any:
    """Return the plain form of a value.

    Parameters
    ----------
    value : object
        Frozen dataclass of this package, tuple, list, mapping, array, number, string, bool or None.
    place : str
        What to call it in an error message.

    Raises
    ------
    NotSerialisable
        For anything else, such as a function.
    """
    if value is None or isinstance(value, (str, bool)):
        return value
    if isinstance(value, np.ndarray):
        return _plain_array(value)
    if isinstance(value, (int, float, np.number, np.bool_)):
        return _plain_number(value)
    if isinstance(value, (tuple, list)):
        return [to_plain(item, f"{place}[{i}]") for i, item in enumerate(value)]
    if isinstance(value, Mapping):
        return {TYPE: MAPPING, "items": to_plain(list(value.items()), place)}
    if dataclasses.is_dataclass(value) and _is_ours(type(value)):
        return _plain_dataclass(value, place)
    raise NotSerialisable(f"{place} is a {type(value).__name__}, which a recipe cannot hold")


def _plain_dataclass(value: Any, place: str) -> dict[str, Any]:
    form: dict[str, Any] = {TYPE: type_name(type(value))}
    for field in dataclasses.fields(value):
        item = getattr(value, field.name)
        if isinstance(item, np.ndarray) and field.metadata == INSIDE:
            form[field.name] = _inside(item)
        elif field.init:
            form[field.name] = to_plain(item, f"{place}.{field.name}")
    return form


def _plain_number(value: Any) -> Any:
    number = value.item() if isinstance(value, np.generic) else value
    if isinstance(number, float) and not math.isfinite(number):
        return {TYPE: FLOAT, "value": repr(number)}
    return number


def _plain_array(array: NDArray[Any]) -> dict[str, Any]:
    if array.size <= LARGEST_INSIDE and array.ndim <= 2:
        return _inside(array)
    return {TYPE: OUTSIDE, **_shape_and_type(array), "sha256": content_hash(array)}


def _inside(array: NDArray[Any]) -> dict[str, Any]:
    text = base64.b64encode(zlib.compress(content(array), 9)).decode("ascii")
    return {TYPE: ARRAY, **_shape_and_type(array), "zlib": text}


def _shape_and_type(array: NDArray[Any]) -> dict[str, Any]:
    return {"shape": list(array.shape), "dtype": little_endian(array.dtype).str}


def type_name(cls: type) -> str:
    """Name of a class within this package: "lights.PointLight"."""
    return f"{cls.__module__.removeprefix(PACKAGE + '.')}.{cls.__name__}"


def _is_ours(cls: type) -> bool:
    return cls.__module__.startswith(PACKAGE + ".")
