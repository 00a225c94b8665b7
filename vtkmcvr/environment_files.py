"""Environment maps as files: Radiance .hdr by VTK, OpenEXR by its own optional package."""

from __future__ import annotations

import os
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray


def read_environment(path: str | os.PathLike[str]) -> NDArray[np.float32]:
    """Read an environment map.

    Slightly negative pixels, as lossy compression leaves them, become 0. Colours are taken as
    linear Rec. 709; a file's own chromaticities and exposure are not applied.

    Parameters
    ----------
    path : path-like
        An equirectangular .hdr or .exr file.

    Returns
    -------
    numpy.ndarray
        float32 (H, W, 3) linear radiance, row 0 the zenith.

    Raises
    ------
    FileNotFoundError
        Where there is no such file.
    ImportError
        Where an .exr is to be read without the OpenEXR package.
    ValueError
        Where it is no such image, has pixels that are not finite, or is black everywhere.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"there is no environment map {path}")
    readers = {".hdr": _read_hdr, ".exr": _read_exr}
    if path.suffix.lower() not in readers:
        raise ValueError(f"an environment map must be a .hdr or .exr file, got {path.name}")
    light = readers[path.suffix.lower()](path)
    bad = np.count_nonzero(~np.isfinite(light).all(axis=2))
    if bad:
        raise ValueError(f"{path} has {bad} pixels that are not finite")
    light = np.maximum(light, 0)
    if not light.any():
        raise ValueError(f"{path} is black everywhere: it would light nothing")
    return light


def import_openexr(doing: str) -> ModuleType:
    """Return the OpenEXR package, or say what to install for what is being done."""
    try:
        import OpenEXR
    except ImportError as error:
        raise ImportError(
            f'{doing} .exr needs the OpenEXR package: pip install "vtkmcvr[exr]"'
        ) from error
    return OpenEXR


def _read_hdr(path: Path) -> NDArray[np.float32]:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkHDRReader

    reader: Any = vtkHDRReader()
    failures: list[Any] = []
    reader.AddObserver("ErrorEvent", lambda *event: failures.append(event))
    if reader.CanReadFile(str(path)):
        reader.SetFileName(str(path))
        reader.Update()
    scalars = reader.GetOutput().GetPointData().GetScalars()
    if failures or scalars is None or reader.GetErrorCode():
        # VTK 9.7 also fails on whole ones of less than 512 bytes
        raise ValueError(f"{path} is not a complete Radiance .hdr image")
    columns, rows, _ = reader.GetOutput().GetDimensions()
    pixels = vtk_to_numpy(scalars).reshape(rows, columns, 3)
    return np.ascontiguousarray(pixels[::-1], np.float32)


def _read_exr(path: Path) -> NDArray[np.float32]:
    OpenEXR = import_openexr("reading")
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: channel.pixels for name, channel in file.channels().items()}
    except RuntimeError as error:
        raise ValueError(f"{path} is not a complete OpenEXR image") from error
    names = "RGB" if {"R", "G", "B"} <= channels.keys() else "YYY"
    if names[0] not in channels:
        raise ValueError(f"{path} has neither R, G, B nor Y, only {', '.join(channels)}")
    return np.stack([channels[name].astype(np.float32) for name in names], axis=2)
