"""Picture -> pyvista.ImageData."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pyvista as pv

from ..vtk_bridge.image import grid_image, image_of_arrays

if TYPE_CHECKING:
    from ..pictures.noiseless import NoiselessPicture
    from ..pictures.picture import Picture
    from ..volume import Volume


def to_pyvista(picture: Picture | NoiselessPicture) -> pv.ImageData:
    """Image of W x H x 1 points with a picture's arrays; the bottom row of the picture comes first.

    `image.plot(scalars="rgba", rgba=True, cpos="xy")` shows it.
    """
    image = pv.ImageData()
    image.ShallowCopy(image_of_arrays(picture.arrays()))
    return image


def image_of_volume(volume: Volume) -> pv.ImageData:
    """Image of a volume's scalars, with its place in the world."""
    image = pv.ImageData()
    image.ShallowCopy(grid_image(volume))
    image["scalars"] = volume.values.ravel()
    return image
