"""Images of several components: volumes with looks of their own, or one with a colour by point."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkVolumeProperty

from ..scene import Surface, TransferFunction, Volume
from ..voxels import voxels_of
from .property import surface_of, transfer_of
from .volume import components_of, volume_of


class Look(NamedTuple):
    """Volume of one component, or of several dependent ones, and how it looks."""

    volume: Volume
    transfer: TransferFunction
    surface: Surface | None


def looks_of(
    image: vtkImageData,
    volume_property: vtkVolumeProperty,
    *,
    scalars: str | None = None,
    gradient_factor: float = 0.5,
    volume: Callable[..., Volume] = volume_of,
) -> tuple[Look, ...]:
    """Volumes of an image as VTK's volume mappers see its components.

    One component: one volume. Independent ones: one each, by the property's functions and weight of
    that component; their extinctions add, where VTK adds weighted opacities, and the albedo is the
    mean of theirs by extinction. Dependent ones (IndependentComponents off): one volume, see
    `volume_of`.

    Parameters
    ----------
    image : vtkImageData
    volume_property : vtkVolumeProperty
    scalars : str, optional
        Name of the array.
    gradient_factor : float
        Of surfaces, see `surface_of`.
    volume : callable
        `volume_of`, or `VolumeCache.volume`.
    """
    count = components_of(image, scalars)
    if count == 1:
        return (_look(volume(image, scalars=scalars), volume_property, 0, gradient_factor),)
    if volume_property.GetIndependentComponents():
        return tuple(
            _look(volume(image, scalars=scalars, component=c), volume_property, c, gradient_factor)
            for c in range(count)
        )
    colour = transfer_of(volume_property).colour if count == 2 else None
    whole = volume(image, scalars=scalars, dependent=True, colour=colour)
    return (_look(whole, volume_property, 0, gradient_factor),)


def _look(
    volume: Volume, volume_property: vtkVolumeProperty, component: int, gradient_factor: float
) -> Look:
    return Look(
        volume,
        transfer_of(volume_property, component, scalar_range(volume)),
        surface_of(volume_property, component, gradient_factor=gradient_factor),
    )


def scalar_range(volume: Volume) -> tuple[float, float]:
    """Smallest and largest finite scalar of a volume."""
    voxels = voxels_of(volume)
    low, high = (x * voxels.unit + voxels.offset for x in (voxels.lowest, voxels.highest))
    return low, high
