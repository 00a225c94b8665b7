"""Pictures as files: plain arrays in, plain arrays out.

In an array row 0 is the top of the picture. VTK images have their first row at the bottom, so
rows are flipped where VTK reads or writes; EXR keeps ours.

Every writer raises ValueError where the arrays do not fit the format or the path has another
ending, and OSError where the file cannot be written; then nothing half-written is left.
"""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vtkmcvr.environment_files import import_openexr, read_environment
from vtkmcvr.safe_files import replacing, write_vtk

from .png_chunks import with_text

__all__ = ["read_environment", "read_npz", "write_exr", "write_npz", "write_png", "write_vti"]

Arrays = Mapping[str, NDArray[Any]]
Recipe = Mapping[str, Any]

RECIPE = "recipe"
_EXR_NAMES = {"radiance": ["R", "G", "B"], "alpha": ["A"], "depth": ["Z"]}
_EXR_LAYERS = {"normal": "XYZ"}


def write_png(
    path: str | os.PathLike[str],
    rgba: NDArray[Any],
    text: Mapping[str, str] | None = None,
) -> None:
    """Write a picture of 8 or 16 bits.

    Parameters
    ----------
    path : path-like
        Where to, ending in .png.
    rgba : numpy.ndarray
        uint8 or uint16 (H, W, 3) or (H, W, 4) sRGB, straight alpha, row 0 on top.
    text : mapping of str, optional
        iTXt chunks, for instance the recipe as JSON.
    """
    from vtkmodules.vtkIOImage import vtkPNGWriter

    if rgba.dtype not in (np.uint8, np.uint16) or rgba.ndim != 3 or rgba.shape[2] not in (3, 4):
        raise ValueError(
            f"a PNG needs uint8 or uint16 (rows, columns, 3 or 4), got {rgba.dtype} {rgba.shape}"
        )
    writer = vtkPNGWriter()
    writer.SetInputData(_vtk_image({"rgba": rgba}))
    with replacing(path, ".png") as temporary:
        write_vtk(writer, temporary)
        if text:
            temporary.write_bytes(with_text(temporary.read_bytes(), text))


def write_npz(path: str | os.PathLike[str], arrays: Arrays, recipe: Recipe) -> None:
    """Write arrays as they are and the recipe as the JSON string array "recipe".

    Not compressed: noise hardly shrinks, and reading stays fast.

    Parameters
    ----------
    path : path-like
        Where to, ending in .npz.
    arrays : mapping of numpy.ndarray
        By name; "recipe" is taken.
    recipe : mapping
        What JSON and NumPy scalars and arrays can express.
    """
    if RECIPE in arrays:
        raise ValueError('an array cannot be named "recipe": that is where the recipe goes')
    for name, array in arrays.items():
        if array.dtype.hasobject:
            raise ValueError(f"{name} holds Python objects, not numbers")
    content: dict[str, Any] = {**arrays, RECIPE: np.array(recipe_json(recipe))}
    with replacing(path, ".npz") as temporary, temporary.open("wb") as file:
        np.savez(file, **content)


def read_npz(path: str | os.PathLike[str]) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """Read what `write_npz` wrote.

    Returns
    -------
    arrays : dict of numpy.ndarray
        By name.
    recipe : dict
        As JSON holds it: tuples have become lists.

    Raises
    ------
    FileNotFoundError
        Where there is no such file.
    ValueError
        Where it is no .npz file or holds no recipe.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"there is no file {path}")
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        recipe = json.loads(arrays.pop(RECIPE).item())
    except (AttributeError, KeyError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise ValueError(f"{path} is not a picture that vtkmcvr wrote") from error
    return arrays, recipe


def write_vti(path: str | os.PathLike[str], arrays: Arrays, recipe: Recipe) -> None:
    """Write arrays as the point data of a vtkImageData, the recipe as its field data.

    Parameters
    ----------
    path : path-like
        Where to, ending in .vti.
    arrays : mapping of numpy.ndarray
        (H, W) or (H, W, C), float32 or uint8, all of one size. Row 0 (top) becomes the last row
        of the image, as VTK has it: y points up.
    recipe : mapping
        Stored as JSON in the string array "recipe".
    """
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

    for name, array in arrays.items():
        if array.dtype not in (np.float32, np.uint8):
            raise ValueError(f"{name} must be float32 or uint8, got {array.dtype}")
    image = _vtk_image(arrays)
    note = vtkStringArray()
    note.SetName(RECIPE)
    note.InsertNextValue(recipe_json(recipe))
    image.GetFieldData().AddArray(note)
    writer = vtkXMLImageDataWriter()
    writer.SetInputData(image)
    with replacing(path, ".vti") as temporary:
        write_vtk(writer, temporary)


def write_exr(path: str | os.PathLike[str], arrays: Arrays, recipe: Recipe) -> None:
    """Write arrays as the float32 channels of an OpenEXR file, losslessly compressed.

    Parameters
    ----------
    path : path-like
        Where to, ending in .exr.
    arrays : mapping of numpy.ndarray
        (H, W) or (H, W, 1 to 4), all of one size. "radiance" becomes R, G, B, "alpha" A and
        "depth" Z; any other becomes a layer: "normal.X", "standard_error.R", "samples".
    recipe : mapping
        Stored as JSON in the string attribute "recipe".

    Raises
    ------
    ImportError
        Where the OpenEXR package is missing.
    """
    OpenEXR = import_openexr("writing")
    _common_size(arrays)
    channels: dict[str, NDArray[np.float32]] = {}
    for name, array in arrays.items():
        channels |= _exr_channels(name, array)
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        RECIPE: recipe_json(recipe),
    }
    with replacing(path, ".exr") as temporary:
        try:
            OpenEXR.File(header, channels).write(str(temporary))
        except RuntimeError as error:
            raise OSError(str(error)) from error


def recipe_json(recipe: Recipe) -> str:
    """Return a recipe as JSON; NumPy scalars and arrays become numbers and lists."""
    return json.dumps(recipe, default=_plain, allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"a recipe cannot hold {value!r} ({type(value).__name__})")


def _common_size(arrays: Arrays) -> tuple[int, int]:
    sizes = {name: array.shape[:2] for name, array in arrays.items() if array.ndim in (2, 3)}
    if len(sizes) != len(arrays) or len(set(sizes.values())) != 1:
        shapes = {name: array.shape for name, array in arrays.items()}
        raise ValueError(f"arrays must be (rows, columns[, channels]) of one size, got {shapes}")
    rows, columns = next(iter(sizes.values()))
    return rows, columns


def _vtk_image(arrays: Arrays) -> Any:
    from ..vtk_bridge.image import image_of_arrays

    _common_size(arrays)
    return image_of_arrays(arrays)


def _exr_channels(name: str, array: NDArray[Any]) -> dict[str, NDArray[np.float32]]:
    planes = np.atleast_3d(array).astype(np.float32)
    count = planes.shape[2]
    if name in _EXR_NAMES:
        names = _EXR_NAMES[name]
    elif count == 1:
        names = [name]
    else:
        names = [f"{name}.{letter}" for letter in _EXR_LAYERS.get(name, "RGBA")[:count]]
    if len(names) != count:
        raise ValueError(f"{name} has {count} channels, an .exr has {len(names)} for it")
    return {n: np.ascontiguousarray(planes[..., c]) for c, n in enumerate(names)}
