"""Frozen dataclasses of this package as plain JSON values, and back.

A dataclass becomes {"type": "lights.PointLight", field: value, ...}; what a field is called and
holds decides the form, so that a new kind of light or shape needs no line here. Large arrays
(voxels, environment maps, textures) are not written: their content hash and shape stand for them,
and who reads the form back must bring the array itself. A picture thus carries no patient's data.
"""

from __future__ import annotations

import base64
import dataclasses
import importlib
import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .content_hash import content, content_hash, little_endian

PACKAGE = __name__.rpartition(".")[0]
TYPE, ARRAY, OUTSIDE, FLOAT = "type", "array", "outside array", "float"
# Elements of the largest array that is written; voxels and pixels, three axes or more, never are
LARGEST_INSIDE = 256
# Anything deeper is no scene
DEEPEST = 32

Arrays = Mapping[str, NDArray[Any]]


class NotSerialisable(TypeError):
    """A value has no plain form; the message says where and why."""


class MissingArray(LookupError):
    """A form stands for an array that was not brought."""

    def __init__(self, place: str, form: Mapping[str, Any]) -> None:
        self.place, self.form = place, form
        shape = " x ".join(map(str, form["shape"]))
        super().__init__(f"{place}: array of {shape} {form['dtype']}, hash {form['sha256'][:12]}")


# Writing


def to_plain(value: Any, place: str = "scene") -> Any:
    """Return the plain form of a value.

    Parameters
    ----------
    value : object
        Frozen dataclass of this package, tuple, list, array, number, string, bool or None.
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
    if dataclasses.is_dataclass(value) and _is_ours(type(value)):
        fields = [field.name for field in dataclasses.fields(value) if field.init]
        form = {name: to_plain(getattr(value, name), f"{place}.{name}") for name in fields}
        return {TYPE: _type_name(type(value)), **form}
    raise NotSerialisable(f"{place} is a {type(value).__name__}, which a recipe cannot hold")


def _plain_number(value: Any) -> Any:
    number = value.item() if isinstance(value, np.generic) else value
    if isinstance(number, float) and not math.isfinite(number):
        return {TYPE: FLOAT, "value": repr(number)}
    return number


def _plain_array(array: NDArray[Any]) -> dict[str, Any]:
    form = {"shape": list(array.shape), "dtype": little_endian(array.dtype).str}
    if array.size > LARGEST_INSIDE or array.ndim > 2:
        return {TYPE: OUTSIDE, **form, "sha256": content_hash(array)}
    return {TYPE: ARRAY, **form, "base64": base64.b64encode(content(array)).decode("ascii")}


# Reading


def from_plain(form: Any, arrays: Arrays, place: str = "scene", depth: int = 0) -> Any:
    """Return the value of a plain form; lists become tuples.

    Parameters
    ----------
    form : object
        What `to_plain` returned, after JSON.
    arrays : mapping of str to numpy.ndarray
        Arrays that the form only stands for, by content hash.
    place : str
        What to call it in an error message.
    depth : int
        Levels above.

    Raises
    ------
    MissingArray
        Where an array is not among `arrays`.
    ValueError
        Where the form is none of this version: unknown types or fields, values out of range.
    """
    if depth > DEEPEST:
        raise ValueError(f"{place} is nested too deep")
    if isinstance(form, list):
        return tuple(
            from_plain(item, arrays, f"{place}[{i}]", depth + 1) for i, item in enumerate(form)
        )
    if not isinstance(form, dict):
        return form
    kind = form.get(TYPE)
    if kind == FLOAT:
        return _float(form, place)
    if kind == ARRAY:
        return _array(form, place)
    if kind == OUTSIDE:
        return _outside(form, arrays, place)
    return _dataclass(form, kind, arrays, place, depth)


def _float(form: Mapping[str, Any], place: str) -> float:
    if form.get("value") not in ("inf", "-inf", "nan"):
        raise ValueError(f"{place} is no number")
    return float(form["value"])


def _header(form: Mapping[str, Any], place: str) -> tuple[tuple[int, ...], np.dtype]:
    shape, dtype = form.get("shape"), form.get("dtype")
    known = isinstance(dtype, str) and re.fullmatch(r"[<|][biuf][1248]", dtype)
    if not known or not isinstance(shape, list) or not all(_is_length(n) for n in shape):
        raise ValueError(f"{place} is no array: shape {shape!r}, type {dtype!r}")
    return tuple(shape), np.dtype(dtype)


def _is_length(value: Any) -> bool:
    return type(value) is int and value >= 0


def _array(form: Mapping[str, Any], place: str) -> NDArray[Any]:
    shape, dtype = _header(form, place)
    try:
        content = base64.b64decode(form.get("base64", ""), validate=True)
        return np.frombuffer(content, dtype).reshape(shape).copy()
    except (TypeError, ValueError) as error:
        raise ValueError(f"{place} is no array of shape {shape}: {error}") from None


def _outside(form: Mapping[str, Any], arrays: Arrays, place: str) -> NDArray[Any]:
    _header(form, place)
    if not isinstance(form.get("sha256"), str):
        raise ValueError(f"{place} has no content hash")
    if form["sha256"] not in arrays:
        raise MissingArray(place, form)
    return arrays[form["sha256"]]


def _dataclass(form: dict[str, Any], kind: Any, arrays: Arrays, place: str, depth: int) -> Any:
    cls = _type_named(kind, place)
    known = {field.name for field in dataclasses.fields(cls) if field.init}
    unknown = [name for name in form if name != TYPE and name not in known]
    if unknown:
        raise ValueError(f"{place} has the field {unknown[0]!r}, which {kind} does not have here")
    values = {
        name: from_plain(value, arrays, f"{place}.{name}", depth + 1)
        for name, value in form.items()
        if name != TYPE
    }
    try:
        made = cls(**values)
    except (TypeError, ValueError, AttributeError, IndexError) as error:
        raise ValueError(f"{place} is no {kind}: {error}") from error
    _keep_bits(made, values)
    return made


def _keep_bits(made: Any, values: Mapping[str, Any]) -> None:
    """Undo rounding: a unit vector that is normalised again may differ in its last bits."""
    for name, value in values.items():
        now = getattr(made, name)
        numbers = isinstance(value, tuple) and all(isinstance(x, float) for x in value)
        if numbers and now != value and np.allclose(now, value, rtol=1e-12, atol=0):
            object.__setattr__(made, name, value)


def _type_name(cls: type) -> str:
    return f"{cls.__module__.removeprefix(PACKAGE + '.')}.{cls.__name__}"


def _is_ours(cls: type) -> bool:
    return cls.__module__.startswith(PACKAGE + ".")


def _type_named(name: Any, place: str) -> type:
    """Dataclass of this package; nothing else that a file may name is touched."""
    if isinstance(name, str) and re.fullmatch(r"[a-z]\w*(\.[a-z]\w*)*\.[A-Z]\w*", name):
        module, _, attribute = name.rpartition(".")
        try:
            cls = getattr(importlib.import_module(f"{PACKAGE}.{module}"), attribute, None)
        except ImportError:
            cls = None
        if isinstance(cls, type) and dataclasses.is_dataclass(cls) and _type_name(cls) == name:
            return cls
    raise ValueError(f"{place} is of the unknown type {name!r}")
