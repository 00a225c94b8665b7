"""Masks and label maps of VTK's GPU mapper -> masks and labels of a scene."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkRenderingCore import vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from .labels import Labels
from .scene import TransferFunction
from .vtk_property import RGB_CHANNELS
from .vtk_transfer import colour_curve, grey_curve, opacity_curve
from .vtk_volume import volume_of

BINARY = 0


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
