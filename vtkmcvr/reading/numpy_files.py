"""NumPy arrays, from memory or from .npy and .npz files."""

from __future__ import annotations

import math
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np

from .compact import compact_values
from .errors import VolumeReadError, fail
from .raw import NO_SPACING
from .source import VolumeSource
from .streams import check_promise
from .volume import LoadedVolume, check_dimension

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from .options import ReadOptions

PLACE = ("spacing", "origin", "direction")


def volume_from_array(source: Path, values: Any, options: ReadOptions) -> LoadedVolume:
    """Return an array as a volume; its axes are k, j, i and perhaps the component.

    Raises
    ------
    VolumeReadError
        If it is no array of numbers with 3 or 4 axes.
    """
    array = np.asanyarray(values)
    _check_array(source, array.dtype, array.shape)
    noted = ["read as NumPy array"]
    if options.spacing is None:
        noted.append(NO_SPACING)
    return LoadedVolume(
        values=compact_values(array, noted),
        spacing=np.ones(3),
        origin=np.zeros(3),
        direction=np.eye(3),
        notes=noted,
    )


def _check_array(source: Path, kind: np.dtype[Any], shape: tuple[int, ...]) -> None:
    if kind.kind not in "biuf" or kind.itemsize > 8:
        raise VolumeReadError(f"{source}: an array of {kind} is not one of numbers; convert it.")
    components = shape[3] if len(shape) == 4 else 1
    if len(shape) not in (3, 4) or not 1 <= components <= 4:
        raise VolumeReadError(
            f"{source}: an array of shape {shape} is no volume; give (k, j, i), or "
            "(k, j, i, component) with 1 to 4 components."
        )
    check_dimension(source, shape[2::-1])


def open_numpy(source: Path, options: ReadOptions) -> VolumeSource:
    """Judge a .npy or .npz file; the latter may hold spacing, origin and direction as well.

    Raises
    ------
    VolumeReadError
        If there is no array of numbers with 3 or 4 axes.
    """
    if source.suffix.lower() == ".npy":
        with source.open("rb") as stream:
            shape, kind = _header(source, stream)
        name = ""
    else:
        name, shape, kind = _largest(source)
    _check_array(source, kind, shape)
    promised = math.prod(shape) * kind.itemsize
    check_promise(source, [source], "gzip" if name else "raw", promised)

    def load(_: int) -> LoadedVolume:
        try:
            loaded = np.load(source, allow_pickle=False)
            if not name:
                return volume_from_array(source, loaded, options)
            with loaded:
                volume = volume_from_array(source, loaded[name], options)
                _place(source, volume, loaded)
            return volume
        except (ValueError, EOFError, zipfile.BadZipFile, KeyError) as error:
            if isinstance(error, VolumeReadError):
                raise
            fail(source, "damaged or truncated; write the array again")

    return VolumeSource(size=shape[2::-1], memory=3 * promised, load=load)


def _header(source: Path, stream: Any) -> tuple[tuple[int, ...], np.dtype[Any]]:
    try:
        version = np.lib.format.read_magic(stream)
        reader = {
            (1, 0): np.lib.format.read_array_header_1_0,
            (2, 0): np.lib.format.read_array_header_2_0,
        }[version]
        shape, _, kind = reader(stream)
    except Exception:
        # NumPy evaluates the header as Python, with as many kinds of error.
        fail(source, "not a NumPy file, or its header is damaged; write the array again")
    return shape, kind


def _largest(source: Path) -> tuple[str, tuple[int, ...], np.dtype[Any]]:
    """Return name, shape and type of the array with the most numbers among those with 3+ axes."""
    found = []
    try:
        with zipfile.ZipFile(source) as archive:
            for entry in archive.namelist():
                if entry.endswith(".npy"):
                    with archive.open(entry) as stream:
                        found.append((entry.removesuffix(".npy"), *_header(source, stream)))
    except (zipfile.BadZipFile, OSError, NotImplementedError, RuntimeError):
        fail(source, "not a NumPy file, or it is damaged; write the arrays again")
    volumes = [item for item in found if len(item[1]) >= 3]
    if not volumes:
        fail(source, "holds no array with 3 axes; save one under any name")
    return max(volumes, key=lambda item: math.prod(item[1]))


def _place(source: Path, volume: LoadedVolume, arrays: Any) -> None:
    shapes: dict[str, tuple[int, ...]] = {"spacing": (3,), "origin": (3,), "direction": (3, 3)}
    for name in PLACE:
        if name in arrays:
            given: NDArray[Any] = arrays[name]
            if given.shape != shapes[name] or given.dtype.kind not in "iuf":
                fail(source, f"its array {name!r} must have the shape {shapes[name]}; correct it")
            setattr(volume, name, given.astype(np.float64))
    if "spacing" in arrays and NO_SPACING in volume.notes:
        volume.notes.remove(NO_SPACING)
