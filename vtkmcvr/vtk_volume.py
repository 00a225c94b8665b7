"""vtkImageData -> volume."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray
from vtkmodules.vtkCommonDataModel import (
    vtkDataSet,
    vtkDataSetAttributes,
    vtkFieldData,
    vtkImageData,
)
from vtkmodules.vtkCommonMath import vtkMatrix4x4

from .scene import Volume
from .vtk_matrix import matrix_of

GHOSTS = "vtkGhostType"


def volume_of(
    image: vtkImageData,
    *,
    scalars: str | None = None,
    user_matrix: vtkMatrix4x4 | ArrayLike | None = None,
) -> Volume:
    """Volume of an image, with its full index-to-world map: extent, origin, spacing, direction.

    Values share memory with the image where VTK stores them contiguously. What is computed from
    them is kept as long as the `Volume` object: keep that while the image is unchanged, see
    `VolumeCache`.

    Parameters
    ----------
    image : vtkImageData
        Three-dimensional, one component. Values of cells stand at the centres of the cells.
    scalars : str, optional
        Name of the array, of points before cells. Default: the active scalars, or the only array.
    user_matrix : vtkMatrix4x4 or array (4, 4), optional
        Applied after the image's own map, as vtkProp3D::SetUserMatrix.

    Returns
    -------
    Volume

    Raises
    ------
    TypeError
        Where `image` is no vtkImageData.
    ValueError
        Where there is no such array, it has several components, or the image is flat.
    """
    check_image(image)
    array, on_cells = _choose(image, scalars)
    matrix = _index_to_world(image, 0.5 if on_cells else 0.0)
    if user_matrix is not None:
        matrix = matrix_of(user_matrix) @ matrix
    return Volume(_grid(image, array, on_cells), matrix)


class VolumeCache:
    """Hands out the same `Volume` while the image is unchanged, going by modification times."""

    def __init__(self) -> None:
        self._key: tuple[Any, ...] | None = None
        self._volume: Volume | None = None

    def volume(self, image: vtkImageData, scalars: str | None = None) -> Volume:
        """Volume of the image, as `volume_of`; the last one where nothing has changed."""
        check_image(image)
        key = (image, image.GetMTime(), image.GetUpdateTime(), scalars)
        if self._volume is None or key != self._key:
            # First let go of the old one: two volumes may not fit into memory
            self._key = self._volume = None
            self._volume = volume_of(image, scalars=scalars)
            self._key = key
        return self._volume


def check_image(image: object) -> None:
    """Raise a TypeError that says what to do unless `image` is a vtkImageData."""
    if isinstance(image, vtkImageData):
        return
    if image is None:
        raise TypeError("a volume is a vtkImageData, got None: has its source been updated?")
    advice = ""
    if isinstance(image, vtkDataSet):
        advice = "; resample it onto a regular grid first, for instance with vtkResampleToImage"
    name = image.GetClassName() if hasattr(image, "GetClassName") else type(image).__name__
    raise TypeError(f"a volume is a vtkImageData, got {name}{advice}")


def _choose(image: vtkImageData, name: str | None) -> tuple[vtkDataArray, bool]:
    """Array to render, and whether it belongs to cells."""
    for attributes, on_cells in ((image.GetPointData(), False), (image.GetCellData(), True)):
        array = _default(attributes) if name is None else attributes.GetArray(name)
        if array is not None:
            return array, on_cells
    names = _names(image.GetPointData()) + _names(image.GetCellData())
    if not names:
        raise ValueError("the image has no scalars")
    listed = ", ".join(map(repr, names))
    if name is None:
        raise ValueError(f"the image has no active scalars; name one of its arrays: {listed}")
    raise ValueError(f"the image has no array {name!r}; it has {listed}")


def _default(attributes: vtkDataSetAttributes) -> vtkDataArray | None:
    """Active scalars, else the only array."""
    active = attributes.GetScalars()
    names = _names(attributes)
    if active is None and len(names) == 1:
        return attributes.GetArray(names[0])
    return active


def _names(attributes: vtkFieldData) -> list[str]:
    count = attributes.GetNumberOfArrays()
    arrays = [attributes.GetArray(i) for i in range(count)]
    return [a.GetName() for a in arrays if a is not None and a.GetName() not in (None, GHOSTS)]


def _grid(image: vtkImageData, array: vtkDataArray, on_cells: bool) -> NDArray:
    """Values as [k, j, i]."""
    components = array.GetNumberOfComponents()
    if components != 1:
        raise ValueError(
            f"{array.GetName()!r} has {components} components, a volume has one: pick one with "
            "vtkImageExtractComponents, or reduce them with vtkImageMagnitude or vtkImageLuminance"
        )
    i, j, k = (max(1, n - 1) if on_cells else n for n in image.GetDimensions())
    if array.GetNumberOfTuples() != i * j * k:
        raise ValueError(
            f"{array.GetName()!r} has {array.GetNumberOfTuples()} values for {i} x {j} x {k} places"
        )
    return vtk_to_numpy(array).reshape(k, j, i)


def _index_to_world(image: vtkImageData, shift: float) -> NDArray[np.float64]:
    """Map of indices that count from 0, whatever the extent; `shift` in index units."""
    matrix = matrix_of(image.GetIndexToPhysicalMatrix())
    start = np.array(image.GetExtent()[::2]) + shift
    matrix[:3, 3] += matrix[:3, :3] @ start
    return matrix
