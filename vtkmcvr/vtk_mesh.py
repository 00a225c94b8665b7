"""vtkPolyData -> receivers."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkTriangleFilter

from .receivers import MeshReceiver, Receiver
from .vtk_matrix import matrix_of


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
