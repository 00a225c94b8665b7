"""Plain JSON values -> frozen dataclasses of this package: what `serialise` wrote, and no more.

Files come from anywhere: nothing that they name is run or opened, and all that they hold is checked
by the classes themselves.
"""

from __future__ import annotations

import base64
import dataclasses
import importlib
import re
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .serialise import ARRAY, FLOAT, MAPPING, OUTSIDE, PACKAGE, TYPE, type_name

# Bytes of the largest array that is read
LARGEST = 2**26
# Anything deeper is no scene
DEEPEST = 32

Arrays = Mapping[str, NDArray[Any]]


class MissingArray(LookupError):
    """A form stands for an array that was not brought."""

    def __init__(self, place: str, form: Mapping[str, Any]) -> None:
        self.place, self.form = place, form
        shape = " x ".join(map(str, form["shape"]))
        super().__init__(f"{place}: array of {shape} {form['dtype']}, hash {form['sha256'][:12]}")


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
    if kind == MAPPING:
        return _mapping(form, arrays, place, depth)
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
        packed = base64.b64decode(form.get("zlib", ""), validate=True)
        values = zlib.decompressobj().decompress(packed, LARGEST)
        return np.frombuffer(values, dtype).reshape(shape).copy()
    except (TypeError, ValueError, zlib.error) as error:
        raise ValueError(f"{place} is no array of shape {shape}: {error}") from None


def _mapping(form: Mapping[str, Any], arrays: Arrays, place: str, depth: int) -> dict[Any, Any]:
    try:
        return dict(from_plain(form.get("items"), arrays, place, depth + 1))
    except TypeError as error:
        raise ValueError(f"{place} is no mapping: {error}") from None


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


def _type_named(name: Any, place: str) -> type:
    """Dataclass of this package; nothing else that a file may name is touched."""
    if isinstance(name, str) and re.fullmatch(r"[a-z]\w*(\.[a-z]\w*)*\.[A-Z]\w*", name):
        module, _, attribute = name.rpartition(".")
        try:
            cls = getattr(importlib.import_module(f"{PACKAGE}.{module}"), attribute, None)
        except ImportError:
            cls = None
        if isinstance(cls, type) and dataclasses.is_dataclass(cls) and type_name(cls) == name:
            return cls
    raise ValueError(f"{place} is of the unknown type {name!r}")
