"""vtkVolumeProperty -> look."""

from __future__ import annotations

from vtkmodules.vtkRenderingCore import vtkVolumeProperty

from .presets import Look
from .vtk_property import phase_of, surface_of, transfer_of


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
