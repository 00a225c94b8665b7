"""Properties of a filter: `filter.film_size` and its VTK twins SetFilmSize and GetFilmSize."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol


class Parameterized(Protocol):
    """What has parameters: keeps their values and learns of changes."""

    _values: dict[str, Any]

    def parameter_changed(self, name: str) -> None:
        """Learn that a parameter got another value."""


class Parameter:
    """Value of a filter that is checked when set, and modifies the filter when it changes.

    Parameters
    ----------
    default : object
        Value before any is set.
    check : callable
        Takes a value; returns it in its lasting form or raises ValueError or TypeError.
    doc : str
        What it means, with unit and range.
    """

    def __init__(self, default: Any, check: Callable[[Any], Any], doc: str) -> None:
        self.default, self.check, self.__doc__ = default, check, doc

    def __set_name__(self, owner: type, name: str) -> None:
        """Add the twins in VTK's style; SetX takes several numbers as one tuple."""
        self.name = name
        camel = "".join(word.capitalize() for word in name.split("_"))

        def setter(filter: Parameterized, *value: Any) -> None:
            setattr(filter, name, value[0] if len(value) == 1 else value)

        def getter(filter: Parameterized) -> Any:
            return getattr(filter, name)

        for prefix, twin in (("Set", setter), ("Get", getter)):
            twin.__name__ = prefix + camel
            twin.__doc__ = f"{prefix} `{name}`: {self.__doc__}"
            setattr(owner, prefix + camel, twin)

    def __get__(self, filter: Parameterized | None, owner: type | None = None) -> Any:
        """Return the value."""
        if filter is None:
            return self
        return filter._values.get(self.name, self.default)

    def __set__(self, filter: Parameterized, value: Any) -> None:
        """Check the value; keep it and tell the filter if it is another one."""
        value = self.check(value)
        if value == self.__get__(filter):
            return
        filter._values[self.name] = value
        filter.parameter_changed(self.name)


def optional(check: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return a check that also lets None pass."""
    return lambda value: None if value is None else check(value)


def one_of(name: str, *kinds: type) -> Callable[[Any], Any]:
    """Return a check for instances of the given types."""

    def check(value: Any) -> Any:
        if not isinstance(value, kinds):
            wanted = " or ".join(kind.__name__ for kind in kinds)
            raise TypeError(f"{name} must be a {wanted}, got {value!r}")
        return value

    return check


def sequence_of(name: str, kind: type) -> Callable[[Any], tuple[Any, ...]]:
    """Return a check for one object of a type, or a sequence of them, as a tuple."""

    def check(value: Any) -> tuple[Any, ...]:
        found = (value,) if isinstance(value, kind) else tuple(value)
        for item in found:
            if not isinstance(item, kind):
                raise TypeError(f"{name} are {kind.__name__} objects, got {item!r}")
        return found

    return check
