"""Picture, or the grid of a volume -> vtkImageData."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

if TYPE_CHECKING:
    from ..pictures.noiseless import NoiselessPicture
    from ..pictures.picture import Picture
    from ..volume import Volume


def grid_image(volume: Volume) -> vtkImageData:
    """Image without values that has the grid of a volume."""
    image = vtkImageData()
    image.SetDimensions(*volume.shape)
    image.SetSpacing(*volume.spacing)
    image.SetOrigin(*volume.index_to_world[:3, 3])
    image.SetDirectionMatrix((volume.index_to_world[:3, :3] / volume.spacing).ravel())
    return image


def image_of_arrays(arrays: Mapping[str, NDArray]) -> vtkImageData:
    """Image with named point arrays.

    Parameters
    ----------
    arrays : mapping of numpy.ndarray
        (H, W) or (H, W, C), all of one size, row 0 on top. The first becomes the active scalars.

    Returns
    -------
    vtkImageData
        W x H x 1 points. The first row of a VTK image is the bottom one.
    """
    rows, columns = next(iter(arrays.values())).shape[:2]
    image = vtkImageData()
    image.SetDimensions(columns, rows, 1)
    for name, values in arrays.items():
        flat = np.ascontiguousarray(values[::-1]).reshape(rows * columns, -1)
        array = numpy_to_vtk(flat, deep=True)
        array.SetName(name)
        image.GetPointData().AddArray(array)
    image.GetPointData().SetActiveScalars(next(iter(arrays)))
    return image


def image_of_picture(picture: Picture | NoiselessPicture) -> vtkImageData:
    """Image with the measured arrays of a picture.

    Parameters
    ----------
    picture : Picture or NoiselessPicture

    Returns
    -------
    vtkImageData
        float32 point arrays "radiance" (active; linear RGB premultiplied by alpha, then alpha),
        "depth" (world units; inf where the volume is missed), "standard_error" (of RGB) where the
        technique has one, and "albedo" and "normal" where the scene asked for them. Field data:
        "samples" of a pixel, and "rejected_samples" of the picture, 0 unless something is wrong.
    """
    arrays = {
        "radiance": np.dstack([picture.radiance, picture.alpha]),
        "depth": picture.depth,
        "standard_error": picture.standard_error,
        "albedo": picture.albedo,
        "normal": picture.normal,
    }
    image = image_of_arrays({name: array for name, array in arrays.items() if array is not None})
    for name in ("samples", "rejected_samples"):
        value = numpy_to_vtk(np.array([getattr(picture, name)], np.int64), deep=True)
        value.SetName(name)
        image.GetFieldData().AddArray(value)
    return image


def image_of_radiance(radiance: NDArray, alpha: NDArray) -> vtkImageData:
    """Image of a film, (H, W, 3) and (H, W), with the float32 point array "radiance"."""
    return image_of_arrays({"radiance": np.dstack([radiance, alpha]).astype(np.float32)})


def array_of_image(image: vtkImageData, name: str) -> NDArray:
    """Point array of a flat image, the way back of `image_of_arrays`.

    Parameters
    ----------
    image : vtkImageData
        W x H x 1 points.
    name : str

    Returns
    -------
    numpy.ndarray
        (H, W, C), row 0 on top; shares memory with the image.

    Raises
    ------
    ValueError
        Where there is no such array or the image has several slices.
    """
    array = image.GetPointData().GetArray(name)
    if array is None:
        raise ValueError(f"the image has no point array {name!r}")
    columns, rows, slices = image.GetDimensions()
    if slices != 1:
        raise ValueError(f"a picture has one slice, this image has {slices}")
    return vtk_to_numpy(array).reshape(rows, columns, -1)[::-1]
