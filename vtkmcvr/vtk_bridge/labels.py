"""Masks and label maps of VTK's GPU mapper -> masks and labels of a scene."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from ..labels import Labels, whole_numbers
from ..scene import TransferFunction
from .property import RGB_CHANNELS
from .transfer import colour_curve, grey_curve, opacity_curve
from .volume import volume_of

BINARY = 0
# Labels are looked for below this
MOST_LABELS = 2**16


class MaskCache:
    """Hands out the same array while its image is unchanged, going by modification times."""

    def __init__(self) -> None:
        self._key: tuple[Any, ...] | None = None
        self._values: NDArray = np.empty(0)
        self._labels: list[int] = []

    def mask(
        self, image: vtkImageData, volume_property: vtkVolumeProperty, kind: str = "auto"
    ) -> tuple[NDArray | None, Labels | None]:
        """Mask or label map of an image: (mask, labels), at most one of them.

        Parameters
        ----------
        image : vtkImageData
            On the volume's grid. 0 hides a voxel of a mask.
        volume_property : vtkVolumeProperty
            With the labels' functions; without any, labels change nothing.
        kind : {"auto", "mask", "labels"}
            "auto": labels where the property has functions for some.
        """
        labelled = bool(volume_property.GetNumberOfLabels())
        if kind == "mask" or (kind == "auto" and not labelled):
            return self._of(image, binary=True), None
        if not labelled:
            return None, None
        values = self._of(image, binary=False)
        return None, Labels(values, label_transfers_of(volume_property, self._labels))

    def _of(self, image: vtkImageData, binary: bool) -> NDArray:
        key = (image, image.GetMTime(), image.GetUpdateTime(), binary)
        if key != self._key:
            values = volume_of(image).values
            if binary:
                self._values, self._labels = values > 0, []
            else:
                # Refuses fractions, and leaves what `Labels` need not turn into integers anew
                self._values = whole_numbers("labels", values)
                self._labels = np.unique(self._values).tolist()
            self._key = key
        return self._values


def mask_of(
    mapper: vtkVolumeMapper, volume_property: vtkVolumeProperty, cache: MaskCache | None = None
) -> tuple[NDArray | None, Labels | None]:
    """Mask or label map of a GPU mapper: (mask, labels), at most one of them.

    Parameters
    ----------
    mapper : vtkVolumeMapper
        Only vtkGPUVolumeRayCastMapper has a mask.
    volume_property : vtkVolumeProperty
        With the labels' functions.
    cache : MaskCache, optional

    Raises
    ------
    ValueError
        For a label map that is mixed with the volume's own colour.
    """
    image = getattr(mapper, "GetMaskInput", lambda: None)()
    if image is None:
        return None, None
    kind = "mask" if mapper.GetMaskType() == BINARY else "labels"  # type: ignore[attr-defined]
    if kind == "labels" and volume_property.GetNumberOfLabels():
        blend = mapper.GetMaskBlendFactor()  # type: ignore[attr-defined]
        if blend != 1.0:
            raise ValueError(
                f"the mapper's mask blend factor is {blend:g}; only 1 is supported: call "
                "SetMaskBlendFactor(1)"
            )
    return (cache or MaskCache()).mask(image, volume_property, kind)


class LabelTimes:
    """When functions of labels have changed last: a property's own time does not tell."""

    def __init__(self) -> None:
        self._key: tuple[int, int] | None = None
        self._functions: list[Any] = []

    def of(self, volume_property: vtkVolumeProperty) -> int:
        """Latest modification time of any label's function; 0 without any."""
        count = volume_property.GetNumberOfLabels()
        key = (volume_property.GetMTime(), count)
        if key != self._key:
            self._functions, self._key = _label_functions(volume_property, count), key
        return max((function.GetMTime() for function in self._functions), default=0)


def _label_functions(own: vtkVolumeProperty, count: int) -> list[Any]:
    """Functions of all labels, which VTK hands out by number only."""
    found, functions = 0, []
    for label in range(MOST_LABELS):
        if found == count:
            break
        all_three = (
            own.GetLabelColor(label), own.GetLabelScalarOpacity(label),
            own.GetLabelGradientOpacity(label),
        )  # fmt: skip
        there = [function for function in all_three if function is not None]
        found += bool(there)
        functions += there
    return functions


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
        if p.GetLabelGradientOpacity(label) is not None:
            raise ValueError(
                f"label {label} has a gradient opacity function, which is not supported yet; give "
                "it a scalar opacity function"
            )
        if opacity is None and colour is None:
            continue
        found[label] = TransferFunction(
            own_opacity if opacity is None else opacity_curve(opacity),
            own_colour if colour is None else colour_curve(colour),
            unit_distance=p.GetScalarOpacityUnitDistance(component),
        )
    return found
