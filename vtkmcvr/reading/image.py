"""Turn voxels into a VTK image, after checking that they are a volume."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..recorded_facts import record_facts
from .volume import check_dimension, check_geometry, volume_notes

if TYPE_CHECKING:
    from pathlib import Path

    from vtkmodules.vtkCommonDataModel import vtkImageData

    from .options import ReadOptions
    from .volume import LoadedVolume

VALUES_NAME = "values"
PLACE = ("spacing", "origin", "direction")


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
    noted = volume.notes + volume_notes(volume)
    record_facts(image, noted, volume.modality, volume.units, volume.segments)
    return image


def place_volume(volume: LoadedVolume, options: ReadOptions) -> None:
    """Give a volume the place that the caller wants."""
    for name in PLACE:
        given = getattr(options, name)
        if given is not None:
            setattr(volume, name, given)
            volume.notes.append(f"{name} given by the caller, not by the file")


def place_image(image: vtkImageData, options: ReadOptions) -> None:
    """Give an image the place that the caller wants."""
    if options.spacing is not None:
        image.SetSpacing(*options.spacing)
    if options.origin is not None:
        image.SetOrigin(*options.origin)
    if options.direction is not None:
        image.SetDirectionMatrix(options.direction.ravel())
