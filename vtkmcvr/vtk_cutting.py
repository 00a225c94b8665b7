"""VTK's ways to cut a volume, and meshes -> parts of a scene. Needs VTK and NumPy only."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import (
    vtkBox,
    vtkImageData,
    vtkPlane,
    vtkPlaneCollection,
    vtkPlanes,
    vtkPolyData,
    vtkSphere,
)
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkRenderingCore import vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from .cutting import Box, Cropping, Plane, Shape, Sphere
from .labels import Labels
from .receivers import MeshReceiver, Receiver
from .scene import TransferFunction, Volume
from .vtk_matrix import matrix_of
from .vtk_property import RGB_CHANNELS
from .vtk_transfer import colour_curve, grey_curve, opacity_curve
from .vtk_volume import volume_of

BINARY, LABEL_MAP = 0, 1


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


def cropping_of(
    mapper: vtkVolumeMapper, image: vtkImageData, volume: Volume
) -> Cropping | None:
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


def mask_of(
    mapper: vtkVolumeMapper, volume_property: vtkVolumeProperty
) -> tuple[NDArray | None, Labels | None]:
    """Mask or label map of a GPU mapper: (mask, labels), at most one of them.

    Parameters
    ----------
    mapper : vtkVolumeMapper
        Only vtkGPUVolumeRayCastMapper has a mask.
    volume_property : vtkVolumeProperty
        With the labels' functions.

    Raises
    ------
    ValueError
        For a label map that is mixed with the volume's own colour.
    """
    image = getattr(mapper, "GetMaskInput", lambda: None)()
    if image is None:
        return None, None
    values = volume_of(image).values
    if mapper.GetMaskType() == BINARY:  # type: ignore[attr-defined]
        return values > 0, None
    if not volume_property.GetNumberOfLabels():
        return None, None
    blend = mapper.GetMaskBlendFactor()  # type: ignore[attr-defined]
    if blend != 1.0:
        raise ValueError(
            f"the mapper's mask blend factor is {blend:g}; only 1 is supported: call "
            "SetMaskBlendFactor(1)"
        )
    return None, Labels(values, label_transfers_of(volume_property, np.unique(values).tolist()))


def label_transfers_of(
    volume_property: vtkVolumeProperty, labels: Iterable[int], component: int = 0
) -> dict[int, TransferFunction | None]:
    """Transfer functions of labels; where a label lacks opacity or colour, it has the volume's own.

    Parameters
    ----------
    volume_property : vtkVolumeProperty
    labels : iterable of int
        Those to ask for; labels without functions are left out.
    component : int
        Whose functions a label falls back on.
    """
    p = volume_property
    own_opacity = opacity_curve(p.GetScalarOpacity(component))
    if p.GetColorChannels(component) == RGB_CHANNELS:
        own_colour = colour_curve(p.GetRGBTransferFunction(component))
    else:
        own_colour = grey_curve(p.GetGrayTransferFunction(component))
    found: dict[int, TransferFunction | None] = {}
    if not p.GetNumberOfLabels():
        return found
    for label in map(int, labels):
        opacity, colour = p.GetLabelScalarOpacity(label), p.GetLabelColor(label)
        if opacity is None and colour is None:
            continue
        found[label] = TransferFunction(
            own_opacity if opacity is None else opacity_curve(opacity),
            own_colour if colour is None else colour_curve(colour),
            unit_distance=p.GetScalarOpacityUnitDistance(component),
        )
    return found


def mesh_of(
    data: vtkPolyData,
    *,
    user_matrix: vtkMatrix4x4 | ArrayLike | None = None,
    smooth: bool = True,
    **look: Any,
) -> MeshReceiver:
    """Receiver of a surface mesh; its polygons and strips are made triangles.

    Parameters
    ----------
    data : vtkPolyData
    user_matrix : vtkMatrix4x4 or array (4, 4), optional
        Applied to the points, as vtkProp3D::SetUserMatrix.
    smooth : bool
        Whether shading follows the point normals, where the mesh has any.
    **look
        `colour`, `specular`, `exponent` of `vtkmcvr.receivers.Receiver`.

    Raises
    ------
    TypeError
        Where `data` is no vtkPolyData.
    ValueError
        Where it has no polygon.
    """
    if not isinstance(data, vtkPolyData):
        raise TypeError(f"a mesh is a vtkPolyData, got {type(data).__name__}")
    triangles = vtkTriangleFilter()
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    triangles.SetInputData(data)
    triangles.Update()
    mesh = triangles.GetOutput()
    if not mesh.GetNumberOfPolys():
        raise ValueError("the mesh has no polygon; a receiver needs a surface")
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(np.float64)
    corners = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    array = mesh.GetPointData().GetNormals() if smooth else None
    normals = None if array is None else vtk_to_numpy(array).astype(np.float64)
    if user_matrix is not None:
        m = matrix_of(user_matrix)
        points = points @ m[:3, :3].T + m[:3, 3]
        normals = None if normals is None else normals @ np.linalg.inv(m[:3, :3])
    return MeshReceiver(points, corners, normals, **look)


class MeshCache:
    """Hands out the same `MeshReceiver` while its vtkPolyData is unchanged."""

    def __init__(self) -> None:
        self._known: list[tuple[vtkPolyData, int, MeshReceiver]] = []

    def receivers(self, items: Iterable[vtkPolyData | Receiver]) -> tuple[Receiver, ...]:
        """Receivers of meshes and receivers; forgets meshes that are not among them."""
        known, found = [], []
        for item in items:
            if isinstance(item, Receiver):
                found.append(item)
                continue
            time = item.GetMTime()
            same = [mesh for data, then, mesh in self._known if data is item and then == time]
            known.append((item, time, same[0] if same else mesh_of(item)))
            found.append(known[-1][2])
        self._known = known
        return tuple(found)
