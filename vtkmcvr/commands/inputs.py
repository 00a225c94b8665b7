"""Volumes named on the command line."""

from __future__ import annotations

from typing import Any


def read_input(path: str, series: str | None) -> Any:
    """Volume of a path; `series` is a UID or a number."""
    from ..readers import read_vtk

    number = int(series) if series is not None and series.isdigit() else series
    return read_vtk(path, series=number)
