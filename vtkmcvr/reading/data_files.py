"""The data file that a detached header names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .errors import fail

if TYPE_CHECKING:
    from pathlib import Path


def check_data_file(source: Path, name: str) -> None:
    """Refuse a header `source` whose data file `name` does not lie beside it.

    Raises
    ------
    VolumeReadError
        If there is no such file.
    """
    if not (source.parent / name).is_file():
        fail(source, f"its data file {name[:80]!r} is missing; put it beside the header")
