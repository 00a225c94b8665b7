"""Any vtkImageData -> one volume to look at, whatever its components."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData

from ..scene import Volume
from .volume import components_of, volume_of

# Luminance of linear Rec. 709 light
LUMINANCE = (0.2126, 0.7152, 0.0722)


def single_volume(image: vtkImageData) -> tuple[Volume, tuple[str, ...]]:
    """Volume of an image, and notes on what its components were taken for.

    Four components of bytes are red, green, blue and opacity; three of bytes are a colour, whose
    luminance becomes the scalar; two or three of another type are a vector, whose length does.

    Raises
    ------
    ValueError
        As `volume_of`, and for other numbers of components.
    """
    count = components_of(image)
    if count == 1:
        return volume_of(image), ()
    parts = [volume_of(image, component=c) for c in range(min(count, 4))]
    matrix, kind = parts[0].index_to_world, parts[0].values.dtype
    if kind == np.uint8 and count == 4:
        return volume_of(image, dependent=True), ("components are red, green, blue and opacity",)
    values = np.stack([part.values for part in parts], axis=-1)
    if kind == np.uint8 and count == 3:
        note = "components are red, green and blue; what is bright is opaque"
        return Volume((values @ np.array(LUMINANCE)).astype(np.float32), matrix, values), (note,)
    if count <= 3:
        length = np.sqrt(np.sum(values.astype(np.float64) ** 2, axis=-1)).astype(np.float32)
        return Volume(length, matrix), (f"{count} components: their length is shown",)
    raise ValueError(
        f"the image has {count} components of {kind}, which are no colour and no vector; pick one, "
        "for instance with vtkImageExtractComponents"
    )
