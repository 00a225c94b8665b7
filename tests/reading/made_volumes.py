"""Volumes made for the tests, the collection of real ones, and how to look at what was read."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import pyvista
import SimpleITK

from vtkmcvr.readers import VolumeReadError, read

REPOSITORY = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("VTKMCVR_DATA", REPOSITORY.parent / "shared" / "data"))
SECRET = "SECRET"

# Rows, columns and slices differ, so that swapped axes show.
SHAPE = (5, 6, 7)
VOXELS = np.arange(np.prod(SHAPE), dtype=np.int16).reshape(SHAPE) - 40
OBLIQUE = np.array([[0.8, 0.0, 0.6], [0.6, 0.0, -0.8], [0.0, 1.0, 0.0]])
SPACING = (0.7, 1.1, 2.5)
ORIGIN = (-12.5, 30.25, 101.0)


def real(name: str) -> Path:
    path = DATA / name
    if not path.exists():
        pytest.skip(f"needs the volume collection (VTKMCVR_DATA), which has no {name}")
    return path


def voxels(image: pyvista.ImageData) -> np.ndarray:
    """Voxels as [k, j, i] or [k, j, i, component]."""
    values = np.asarray(image.active_scalars)
    return values.reshape(*image.dimensions[::-1], *values.shape[1:])


def affine(image: pyvista.ImageData) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = image.direction_matrix @ np.diag(image.spacing)
    matrix[:3, 3] = image.origin
    return matrix


def error_of(path: Path, **options: object) -> str:
    with pytest.raises(VolumeReadError) as caught:
        read(path, **options)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert message.endswith(".")
    assert "\n" not in message
    assert SECRET not in message
    return message.removeprefix(str(path))


def itk_image(values: np.ndarray = VOXELS, *, vector: bool = False) -> SimpleITK.Image:
    image = SimpleITK.GetImageFromArray(values, isVector=vector)
    if image.GetDimension() == 3:
        image.SetSpacing(SPACING)
        image.SetOrigin(ORIGIN)
        image.SetDirection(OBLIQUE.ravel())
    return image


def save(
    path: Path, values: np.ndarray = VOXELS, *, vector: bool = False, gz: bool = False
) -> Path:
    SimpleITK.WriteImage(itk_image(values, vector=vector), str(path), gz)
    return path


def nrrd_text(**fields: str) -> bytes:
    header = {
        "type": "int16",
        "dimension": "3",
        "sizes": "7 6 5",
        "endian": "little",
        "encoding": "raw",
    } | {key.replace("_", " "): value for key, value in fields.items()}
    lines = [f"{key}: {value}" for key, value in header.items() if value]
    return ("NRRD0005\n# a comment: with colon\n" + "\n".join(lines) + "\n\n").encode()
