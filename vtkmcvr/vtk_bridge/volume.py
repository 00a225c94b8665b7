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

from ..curves import ColourCurve
from ..scene import Volume
from .matrix import matrix_of

GHOSTS = "vtkGhostType"


def volume_of(
    image: vtkImageData,
    *,
    scalars: str | None = None,
    user_matrix: vtkMatrix4x4 | ArrayLike | None = None,
    component: int | None = None,
    dependent: bool = False,
    colour: ColourCurve | None = None,
) -> Volume:
    """Volume of an image, with its full index-to-world map: extent, origin, spacing, direction.

    Values share memory with the image where VTK stores them contiguously. What is computed from
    them is kept as long as the `Volume` object: keep that while the image is unchanged, see
    `VolumeCache`.

    Parameters
    ----------
    image : vtkImageData
        Three-dimensional. Values of cells stand at the centres of the cells.
    scalars : str, optional
        Name of the array, of points before cells. Default: the active scalars, or the only array.
    user_matrix : vtkMatrix4x4 or array (4, 4), optional
        Applied after the image's own map, as vtkProp3D::SetUserMatrix.
    component : int, optional
        Which of several components; needed where there are several that are not dependent.
    dependent : bool
        Several components make one value, as VTK has them where IndependentComponents is off: the
        last is the scalar; the first three of four are its colour (bytes, or linear RGB from 0 to
        1), the first of two has its colour by `colour`.
    colour : ColourCurve, optional
        Of the first of two dependent components; looked up at the points, linear between them.

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
    grid = _grid(image, array, on_cells)
    if dependent and grid.shape[3] > 1:
        return Volume(grid[..., -1], matrix, _dependent_colours(grid, colour))
    return Volume(_one_component(grid, array, component), matrix)


def components_of(image: vtkImageData, scalars: str | None = None) -> int:
    """Number of components of the array that `volume_of` takes."""
    check_image(image)
    return int(_choose(image, scalars)[0].GetNumberOfComponents())


def scalars_of(mapper: Any) -> str | None:
    """Name of the array that a volume mapper takes; None: the active one."""
    named = mapper.GetArrayAccessMode() == 1 and mapper.GetScalarMode() in (3, 4)
    return mapper.GetArrayName() or None if named else None


class VolumeCache:
    """Hands out the same `Volume` while the image is unchanged, going by modification times."""

    def __init__(self) -> None:
        self._key: tuple[Any, ...] | None = None
        self._volumes: dict[tuple[Any, ...], Volume] = {}

    def volume(
        self,
        image: vtkImageData,
        scalars: str | None = None,
        component: int | None = None,
        dependent: bool = False,
        colour: ColourCurve | None = None,
    ) -> Volume:
        """Volume of the image, as `volume_of`; the last one where nothing has changed."""
        check_image(image)
        key = (image, image.GetMTime(), image.GetUpdateTime(), scalars)
        if key != self._key:
            # First let go of the old ones: two volumes may not fit into memory
            self._volumes.clear()
            self._key = key
        part = (component, dependent, colour)
        if part not in self._volumes:
            self._volumes[part] = volume_of(
                image, scalars=scalars, component=component, dependent=dependent, colour=colour
            )
        return self._volumes[part]


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
    """Values as [k, j, i, component]."""
    i, j, k = (max(1, n - 1) if on_cells else n for n in image.GetDimensions())
    if array.GetNumberOfTuples() != i * j * k:
        raise ValueError(
            f"{array.GetName()!r} has {array.GetNumberOfTuples()} values for {i} x {j} x {k} places"
        )
    return vtk_to_numpy(array).reshape(k, j, i, -1)


def _one_component(grid: NDArray, array: vtkDataArray, component: int | None) -> NDArray:
    count = grid.shape[3]
    if component is None and count == 1:
        component = 0
    if component is None or not 0 <= component < count:
        asked = "" if component is None else f", there is no {component}"
        raise ValueError(
            f"{array.GetName()!r} has {count} components, a volume has one{asked}: pick one "
            "(`component`, or vtkImageExtractComponents), take the last as scalar and the others "
            "as colour (`dependent`), or reduce them with vtkImageMagnitude or vtkImageLuminance"
        )
    return grid[..., component]


def _dependent_colours(grid: NDArray, colour: ColourCurve | None) -> NDArray:
    count = grid.shape[3]
    if count == 4:
        return grid[..., :3]
    if count != 2 or colour is None:
        raise ValueError(
            "dependent components are four (red, green, blue, scalar), or two (colour by a colour "
            f"function, scalar); got {count}" + (" without a function" if count == 2 else "")
        )
    return colour(grid[..., 0])


def _index_to_world(image: vtkImageData, shift: float) -> NDArray[np.float64]:
    """Map of indices that count from 0, whatever the extent; `shift` in index units."""
    matrix = matrix_of(image.GetIndexToPhysicalMatrix())
    start = np.array(image.GetExtent()[::2]) + shift
    matrix[:3, 3] += matrix[:3, :3] @ start
    return matrix
