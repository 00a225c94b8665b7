"""VTK's ways to cut a volume -> clip shapes and cropping. Needs VTK and NumPy only."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from vtkmodules.vtkCommonDataModel import (
    vtkBox,
    vtkImageData,
    vtkPlane,
    vtkPlaneCollection,
    vtkPlanes,
    vtkSphere,
)
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from ..cutting import Box, Cropping, Plane, Shape, Sphere
from ..scene import Volume
from .matrix import matrix_of


def shapes_of(shape: Any, keep: str = "inside") -> tuple[Shape, ...]:
    """Clip shapes of VTK's implicit functions.

    Parameters
    ----------
    shape : vtkPlane, vtkPlanes, vtkPlaneCollection, vtkSphere, vtkBox, Shape or an iterable of them
        Planes keep the side to which their normals point, as the clipping planes of a VTK mapper.
    keep : {"inside", "outside"}
        What of spheres and boxes is kept.

    Returns
    -------
    tuple of Plane, Sphere or Box

    Raises
    ------
    TypeError
        For another kind of object.
    ValueError
        For a function whose transform is not a rotation with a translation.
    """
    if isinstance(shape, vtkPlanes | vtkPlaneCollection):
        return tuple(_plane_of(plane) for plane in _members(shape))
    for kind, translate in _TRANSLATORS.items():
        if isinstance(shape, kind):
            return (translate(shape, keep),)
    if isinstance(shape, Iterable):
        return tuple(part for item in shape for part in shapes_of(item, keep))
    raise TypeError(
        "clipping takes vtkPlane, vtkPlanes, vtkPlaneCollection, vtkSphere and vtkBox, got "
        f"{type(shape).__name__}"
    )


def _members(planes: vtkPlanes | vtkPlaneCollection) -> Iterator[vtkPlane]:
    if isinstance(planes, vtkPlaneCollection):
        for index in range(planes.GetNumberOfItems()):
            yield planes.GetItem(index)
        return
    _refuse_transform(planes)
    for index in range(planes.GetNumberOfPlanes()):
        plane = vtkPlane()
        planes.GetPlane(index, plane)
        yield plane


def _plane_of(plane: vtkPlane) -> Plane:
    _refuse_transform(plane)
    return Plane(plane.GetOrigin(), plane.GetNormal())


def _sphere_of(sphere: vtkSphere, keep: str) -> Sphere:
    _refuse_transform(sphere)
    return Sphere(sphere.GetCenter(), sphere.GetRadius(), keep)


def _refuse_transform(function: Any) -> None:
    if function.GetTransform() is not None:
        raise ValueError(
            f"a {function.GetClassName()} with a transform is not supported; move its centre "
            "and normal instead"
        )


def _box_of(box: vtkBox, keep: str) -> Box:
    low, high = [0.0] * 3, [0.0] * 3
    box.GetXMin(low)
    box.GetXMax(high)
    size = tuple(np.subtract(high, low).tolist())
    centre = np.add(low, high) / 2
    transform = box.GetTransform()
    if transform is None:
        return Box(tuple(centre.tolist()), size, keep=keep)
    # VTK's transform goes from the world to the box
    transform.Update()
    matrix = getattr(transform, "GetMatrix", lambda: np.zeros((4, 4)))()
    m = np.linalg.pinv(matrix_of(matrix)).astype(np.float64)
    if not np.allclose(m[:3, :3].T @ m[:3, :3], np.eye(3), atol=1e-6):
        raise ValueError("the transform of a vtkBox must be a rotation with a translation")
    return Box(tuple((m[:3, :3] @ centre + m[:3, 3]).tolist()), size, m[:3, :3], keep)


_TRANSLATORS: dict[Any, Callable[[Any, str], Shape]] = {
    Shape: lambda shape, keep: shape,
    vtkPlane: lambda plane, keep: _plane_of(plane),
    vtkSphere: _sphere_of,
    vtkBox: _box_of,
}


def clip_of(mapper: vtkVolumeMapper) -> tuple[Shape, ...]:
    """Clipping planes of a volume mapper."""
    planes = mapper.GetClippingPlanes()
    return () if planes is None else shapes_of(planes)


def cropping_of(mapper: vtkVolumeMapper, image: vtkImageData, volume: Volume) -> Cropping | None:
    """Cropping regions of a volume mapper, None where cropping is off.

    VTK gives the planes as origin + index * spacing along the volume's own axes; where the image
    has a direction matrix, they turn with it.

    Parameters
    ----------
    mapper : vtkVolumeMapper
    image : vtkImageData
    volume : Volume
        Of that image, by its points or by the centres of its cells.
    """
    if not mapper.GetCropping():
        return None
    bounds = np.array(mapper.GetCroppingRegionPlanes())
    on_cells = volume.shape != image.GetDimensions()
    start = np.array(image.GetExtent()[::2]) + (0.5 if on_cells else 0.0)
    ends = (bounds.reshape(3, 2).T - image.GetOrigin()) / image.GetSpacing() - start
    lower, upper = np.sort(ends, axis=0).tolist()
    return Cropping(tuple(lower), tuple(upper), mapper.GetCroppingRegionFlags())
