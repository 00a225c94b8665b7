"""vtkPolyData -> receivers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkRenderingCore import vtkActor

from ..pictures.display import srgb_decode
from ..receivers import MeshReceiver, Receiver
from .matrix import matrix_of


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


def look_of_actor(actor: vtkActor) -> dict[str, Any]:
    """Place, smoothness and colour of an actor, as `mesh_of` takes them."""
    look = actor.GetProperty()
    colour = srgb_decode(np.array(look.GetDiffuseColor()))
    return {
        "user_matrix": matrix_of(actor.GetMatrix()),
        "smooth": look.GetInterpolation() > 0,
        "colour": tuple(colour.tolist()),
    }


class MeshCache:
    """Hands out the same `MeshReceiver` while its vtkPolyData and its look are unchanged."""

    def __init__(self) -> None:
        self._known: list[tuple[vtkPolyData, tuple[Any, ...], MeshReceiver]] = []

    def receivers(
        self,
        items: Iterable[vtkPolyData | Receiver],
        looks: Mapping[int, Mapping[str, Any]] | None = None,
    ) -> tuple[Receiver, ...]:
        """Receivers of meshes and receivers; forgets meshes that are not among them.

        Parameters
        ----------
        items : iterable of vtkPolyData or Receiver
        looks : mapping of int, optional
            Options of `mesh_of` for some of the meshes, by position.
        """
        known, found = [], []
        for index, item in enumerate(items):
            if isinstance(item, Receiver):
                found.append(item)
                continue
            look = (looks or {}).get(index, {})
            key = (item.GetMTime(), *((k, np.array(v).tobytes()) for k, v in look.items()))
            same = [mesh for data, then, mesh in self._known if data is item and then == key]
            known.append((item, key, same[0] if same else mesh_of(item, **look)))
            found.append(known[-1][2])
        self._known = known
        return tuple(found)
