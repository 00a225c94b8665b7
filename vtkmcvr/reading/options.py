"""What the caller asks of a reader beyond the path."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from numpy.typing import NDArray

IGNORABLE = {
    "damaged": "files that cannot be read",
    "duplicates": "all but the first slice at each position",
    "image types": "all image types but the most frequent one",
    "orientations": "all orientations but the most frequent one",
    "sizes": "all matrix and pixel sizes but the most frequent one",
    "unplaced": "slices without position, orientation or pixel spacing",
}
UNITS = ("suv",)


def no_progress(fraction: float, text: str) -> None:
    """Report nothing."""


@dataclass(frozen=True)
class ReadOptions:
    """Choices of the caller, checked.

    Attributes
    ----------
    series : str, int or None
        DICOM series: instance UID, number or part of the description.
    time : int or None
        Volume of a 4-D source, from 0.
    resample : bool
        Whether uneven, incomplete or sheared stacks become a box with even steps.
    ignore : frozenset of str
        What to leave out, keys of `IGNORABLE`.
    units : str or None
        "suv" for PET in standardised uptake values by body weight.
    spacing, origin, direction : ndarray or None
        Place in the world, in mm, instead of the file's.
    raw : mapping or None
        Layout of a file without header, see `raw.RawLayout`.
    threads : int or None
        Decoding threads; None takes one per CPU of the process.
    progress : callable
        Called with the share that is done, 0 to 1, and what is being done.
    """

    series: str | int | None = None
    time: int | None = None
    resample: bool = False
    ignore: frozenset[str] = frozenset()
    units: str | None = None
    spacing: NDArray[np.float64] | None = None
    origin: NDArray[np.float64] | None = None
    direction: NDArray[np.float64] | None = None
    raw: Mapping[str, Any] | None = None
    threads: int | None = None
    progress: Callable[[float, str], None] = field(default=no_progress)


def checked_options(**given: Any) -> ReadOptions:
    """Return `given` as options.

    Raises
    ------
    ValueError
        For a value that means nothing; the message lists what is allowed.
    TypeError
        For an unknown name.
    """
    given = {name: value for name, value in given.items() if value is not None}
    if "ignore" in given:
        given["ignore"] = _ignored(given["ignore"])
    for name, shape in (("spacing", (3,)), ("origin", (3,)), ("direction", (3, 3))):
        if name in given:
            given[name] = _numbers(name, given[name], shape)
    options = ReadOptions(**given)
    if options.units is not None and options.units not in UNITS:
        raise ValueError(f"units must be 'suv' or left out, got {options.units!r}")
    _check_index("time", options.time, 0)
    _check_index("threads", options.threads, 1)
    return options


def _check_index(name: str, value: Any, lowest: int) -> None:
    if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
        raise TypeError(f"{name} must be a whole number, got {value!r}")
    if value is not None and value < lowest:
        raise ValueError(f"{name} must be {lowest} or more, got {value}")


def _ignored(ignore: str | Iterable[str]) -> frozenset[str]:
    names = [ignore] if isinstance(ignore, str) else list(ignore)
    chosen = frozenset(name.strip().lower().replace("-", " ") for name in names)
    unknown = sorted(chosen - IGNORABLE.keys())
    if unknown:
        allowed = ", ".join(map(repr, IGNORABLE))
        raise ValueError(f"ignore must be among {allowed}, got {unknown[0]!r}")
    return chosen


def _numbers(name: str, value: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    numbers = np.asarray(value, dtype=np.float64)
    if shape == (3, 3) and numbers.shape == (9,):
        numbers = numbers.reshape(3, 3)
    if numbers.shape != shape or not np.isfinite(numbers).all():
        wanted = "3 x 3 finite numbers" if shape == (3, 3) else "3 finite numbers"
        raise ValueError(f"{name} must be {wanted}, got {value!r}")
    return numbers
