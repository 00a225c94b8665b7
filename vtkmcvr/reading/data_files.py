"""The data file that a detached header names."""

from __future__ import annotations

from pathlib import Path, PurePosixPath, PureWindowsPath

from .errors import fail


def data_file(source: Path, name: str) -> Path:
    """Return the data file `name` of the header `source`, which must lie in or below its folder.

    Raises
    ------
    VolumeReadError
        If there is no such file, or the name leads out of the folder.
    """
    parts = {*PurePosixPath(name).parts, *PureWindowsPath(name).parts}
    absolute = PurePosixPath(name).is_absolute() or PureWindowsPath(name).anchor
    if absolute or ".." in parts or "\0" in name:
        fail(
            source,
            "its data file lies outside the folder of the header, which is not read; put it "
            "beside the header and correct the name",
        )
    path = source.parent / name
    if not path.is_file():
        fail(source, f"its data file {name[:80]!r} is missing; put it beside the header")
    return path
