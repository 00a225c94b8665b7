"""What arrives at the ports of a filter that renders a scene."""

from __future__ import annotations

from typing import Any, NamedTuple

from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData

from .base import Port

VOLUME, MASK, ENVIRONMENT, MESHES = range(4)
PORTS = (
    Port("vtkImageData", repeatable=True),
    Port("vtkImageData", optional=True),
    Port("vtkImageData", optional=True),
    Port("vtkPolyData", optional=True, repeatable=True),
)


class Inputs(NamedTuple):
    """Data of all ports.

    Attributes
    ----------
    volumes : tuple of vtkImageData
        At least one.
    mask : vtkImageData, optional
        Mask or label map of the first volume.
    environment : vtkImageData, optional
        Panorama.
    meshes : tuple of vtkPolyData
    """

    volumes: tuple[vtkImageData, ...]
    mask: vtkImageData | None = None
    environment: vtkImageData | None = None
    meshes: tuple[vtkPolyData, ...] = ()


def inputs_of(vectors: Any) -> Inputs:
    """Inputs of the information vectors of a request."""

    def first(port: int) -> vtkImageData | None:
        count = vectors[port].GetNumberOfInformationObjects()
        return vtkImageData.GetData(vectors[port], 0) if count else None

    def every(kind: Any, port: int) -> tuple[Any, ...]:
        count = vectors[port].GetNumberOfInformationObjects()
        return tuple(kind.GetData(vectors[port], index) for index in range(count))

    return Inputs(
        every(vtkImageData, VOLUME), first(MASK), first(ENVIRONMENT), every(vtkPolyData, MESHES)
    )
