"""The recipe in a picture file: iTXt of PNG, header of EXR, field data of VTI, an array of npz."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from ..environment_files import import_openexr
from ..pictures.files import RECIPE, read_npz
from ..pictures.png_chunks import read_text


def read_recipe(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Read the recipe that `Picture.save` put into a picture.

    Parameters
    ----------
    path : path-like
        .png, .exr, .vti or .npz

    Returns
    -------
    dict
        As JSON holds it.

    Raises
    ------
    FileNotFoundError
        Where there is no such file.
    ValueError
        Where it is no such picture, or has no recipe.
    ImportError
        Where an .exr is to be read without the OpenEXR package.
    """
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"there is no picture {path}")
    readers = {".png": _of_png, ".exr": _of_exr, ".vti": _of_vti, ".npz": _of_npz}
    if path.suffix.lower() not in readers:
        raise ValueError(f"recipes are in {', '.join(readers)}; got {path.name}")
    text = readers[path.suffix.lower()](path)
    if text is None:
        raise ValueError(
            f"{path} holds no recipe: vtkmcvr did not save it, or a program that saved it again "
            "dropped what it did not know"
        )
    try:
        recipe = json.loads(text)
    except (ValueError, RecursionError):
        recipe = None
    if not isinstance(recipe, dict):
        raise ValueError(f"the recipe in {path} is damaged: it is no JSON object")
    return recipe


def _of_png(path: Path) -> str | None:
    try:
        return read_text(path.read_bytes()).get(RECIPE)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _of_exr(path: Path) -> str | None:
    OpenEXR = import_openexr("reading")
    try:
        with OpenEXR.File(str(path)) as file:
            return file.header().get(RECIPE)
    except RuntimeError as error:
        raise ValueError(f"{path} is not a complete OpenEXR image") from error


def _of_vti(path: Path) -> str | None:
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    reader: Any = vtkXMLImageDataReader()
    failures: list[Any] = []
    for speaker in (reader, reader.GetExecutive()):
        speaker.AddObserver("ErrorEvent", lambda *event: failures.append(event))
    if reader.CanReadFile(str(path)):
        reader.SetFileName(str(path))
        reader.Update()
    else:
        failures.append(path)
    if failures:
        raise ValueError(f"{path} is not a complete VTK image")
    note = reader.GetOutput().GetFieldData().GetAbstractArray(RECIPE)
    return None if note is None or not note.IsA("vtkStringArray") else note.GetValue(0)


def _of_npz(path: Path) -> str:
    return json.dumps(read_npz(path)[1])
