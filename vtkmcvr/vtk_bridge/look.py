"""vtkVolumeProperty -> look, and back for an image."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction, vtkVolumeProperty

from ..material import Surface, TransferFunction
from ..presets import Look, look_named
from ..presets.fit import fit_look
from ..recorded_facts import units
from .property import phase_of, surface_of, transfer_of
from .single import single_volume


def look_of_property(
    volume_property: vtkVolumeProperty, name: str = "vtk", *, component: int = 0
) -> Look:
    """Look of a volume property, in the data's own values.

    Parameters
    ----------
    volume_property : vtkVolumeProperty
        With opacity and colour by the scalar; numbers of its colours are linear RGB.
    name : str
    component : int
        Which of the property's components.

    Returns
    -------
    Look
        Lights, exposure and view are the usual ones. `vtkmcvr.presets.write_look` exports it.

    Raises
    ------
    ValueError
        For a 2-D transfer function or a component of a weight other than 1.
    """
    if volume_property.GetTransferFunctionMode() == vtkVolumeProperty.TF_2D:
        raise ValueError("a look has opacity and colour by the scalar: this property is 2-D")
    transfer = transfer_of(volume_property, component)
    if transfer.density_scale != 1.0:
        raise ValueError(f"a look has no component weight, got {transfer.density_scale:g}")
    assert transfer.opacity is not None
    assert transfer.colour is not None
    gradient = transfer.gradient_opacity
    return Look(
        name,
        "taken from a vtkVolumeProperty",
        "data",
        transfer.opacity.nodes,
        transfer.colour.nodes,
        unit_distance=transfer.unit_distance,
        surface=surface_of(volume_property, component),
        phase=phase_of(volume_property),
        gradient_opacity=None if gradient is None else gradient.nodes,
    )


def property_of_look(look: Look | str, image: vtkImageData) -> vtkVolumeProperty:
    """Volume property of a look fitted to an image, for `vtkmcvr.filters` and VTK's own mappers.

    Opacity, colour, unit distance, gradient opacity, shading and highlight; a property has no
    emission, lights or exposure.

    Parameters
    ----------
    look : Look or str
    image : vtkImageData
        Whose values the nodes are placed in.
    """
    chosen = look_named(look) if isinstance(look, str) else look
    volume, _ = single_volume(image)
    fit = fit_look(chosen, volume, units(image))
    transfer = chosen.transfer(fit.shift, fit.factor, float(volume.spacing.min()))
    return property_of_transfer(transfer, chosen.surface)


def property_of_transfer(transfer: TransferFunction, surface: Surface | None) -> vtkVolumeProperty:
    """Volume property of opacity and colour curves, with shading where there is a surface."""
    assert transfer.opacity is not None
    assert transfer.colour is not None
    made = vtkVolumeProperty()
    made.SetInterpolationTypeToLinear()
    made.SetScalarOpacity(_function(transfer.opacity.nodes))
    made.SetScalarOpacityUnitDistance(transfer.unit_distance)
    if transfer.gradient_opacity is not None:
        made.SetGradientOpacity(_function(transfer.gradient_opacity.nodes))
    colour = vtkColorTransferFunction()
    for node in transfer.colour.nodes:
        colour.AddRGBPoint(*node)
    made.SetColor(colour)
    if surface is not None:
        # As `surface_of`, the other way round
        power = surface.exponent / 4
        made.ShadeOn()
        made.SetSpecularPower(power)
        made.SetSpecular(min(1.0, float(np.max(surface.specular)) * (4 * power + 2) / 8))
    return made


def _function(nodes: tuple[tuple[float, ...], ...]) -> vtkPiecewiseFunction:
    made = vtkPiecewiseFunction()
    for node in nodes:
        made.AddPoint(*node)
    return made
