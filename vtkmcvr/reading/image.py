"""Turn voxels into a VTK image, after checking that they are a volume."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..volume_info import record_facts
from .volume import check_dimension, check_geometry, volume_notes

if TYPE_CHECKING:
    from pathlib import Path

    from vtkmodules.vtkCommonDataModel import vtkImageData

    from .volume import LoadedVolume

VALUES_NAME = "values"


def to_image(source: Path, volume: LoadedVolume) -> vtkImageData:
    """Return `volume` as an image with the point array "values" and the recorded facts.

    Raises
    ------
    VolumeReadError
        If it is not one regular 3-D volume.
    """
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    check_geometry(source, volume)
    depth, height, width = volume.values.shape[:3]
    check_dimension(source, (width, height, depth))
    flat = volume.values.reshape(width * height * depth, -1)
    array = numpy_to_vtk(np.ascontiguousarray(flat))
    array.SetName(VALUES_NAME)
    image = vtkImageData()
    image.SetDimensions(width, height, depth)
    image.SetSpacing(*volume.spacing)
    image.SetOrigin(*volume.origin)
    image.SetDirectionMatrix(volume.direction.ravel())
    image.GetPointData().SetScalars(array)
    record_facts(image, volume.notes + volume_notes(volume), volume.modality, volume.units)
    return image
