"""vtkVolumeProperty -> transfer function, surface, phase function.

Interpolation is always linear, whatever the property says: a new vtkVolumeProperty says nearest.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from vtkmodules.vtkRenderingCore import vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from .phases import MOST_FORWARD, HenyeyGreenstein, Isotropic, Phase
from .scene import Surface, TransferFunction
from .vtk_transfer import colour_curve, grey_curve, opacity_curve

RGB_CHANNELS = 3
COMPOSITE = 0


def transfer_of(volume_property: vtkVolumeProperty, component: int = 0) -> TransferFunction:
    """Transfer function of a property: scalar opacity, colour and unit distance.

    A function that was never set is VTK's default, which VTK creates when asked: the property's
    modification time then goes up once.

    Parameters
    ----------
    volume_property : vtkVolumeProperty
    component : int
        Which of the property's components.

    Raises
    ------
    ValueError
        Where the property has what is not supported yet, or a function has no nodes.
    """
    _refuse_unsupported(volume_property, component)
    # Asking for the other kind of colour would switch the property to it
    if volume_property.GetColorChannels(component) == RGB_CHANNELS:
        colour = colour_curve(volume_property.GetRGBTransferFunction(component))
    else:
        colour = grey_curve(volume_property.GetGrayTransferFunction(component))
    return TransferFunction(
        opacity_curve(volume_property.GetScalarOpacity(component)),
        colour,
        unit_distance=volume_property.GetScalarOpacityUnitDistance(component),
    )


def surface_of(
    volume_property: vtkVolumeProperty, component: int = 0, *, gradient_factor: float = 0.5
) -> Surface | None:
    """Surface of a property, where shading is on.

    VTK adds a Phong highlight s (r.v)^p; the coat has Blinn's (n.h)^e, as wide for e = 4 p. Its
    reflectance is 8 s / (e + 2), at most 1: then the highlight is as bright as VTK's in the middle.
    VTK's default s = 0.2, p = 10 becomes 0.038, about that of glass or wet tissue. The ambient and
    diffuse coefficients are not used: the colour is the albedo, ambient light comes from lights.

    Parameters
    ----------
    volume_property : vtkVolumeProperty
    component : int
        Which of the property's components.
    gradient_factor : float
        As in `Surface`, [0, 1].

    Returns
    -------
    Surface or None
        None where shading is off.
    """
    if not volume_property.GetShade(component):
        return None
    exponent = 4.0 * volume_property.GetSpecularPower(component)
    highlight = 8.0 * volume_property.GetSpecular(component) / (exponent + 2.0)
    specular = float(np.clip(highlight, 0.0, 1.0))
    return Surface(gradient_factor, specular=specular, exponent=exponent)


def phase_of(volume_property: vtkVolumeProperty) -> Phase:
    """Phase function of Henyey and Greenstein with the property's scattering anisotropy.

    VTK allows -1 and 1, where nothing scatters sideways; the nearest number allowed is taken.
    """
    g = float(volume_property.GetScatteringAnisotropy())
    return HenyeyGreenstein(float(np.clip(g, -MOST_FORWARD, MOST_FORWARD))) if g else Isotropic()


def refuse_mapper_features(mapper: vtkVolumeMapper) -> None:
    """Raise a ValueError where a volume mapper cuts, masks or blends in a way not supported yet.

    Parameters
    ----------
    mapper : vtkVolumeMapper
        Of a vtkVolume that is to be rendered.
    """
    planes = mapper.GetClippingPlanes()
    features = {
        "cropping": (mapper.GetCropping(), "call CroppingOff()"),
        "clipping planes": (
            planes is not None and planes.GetNumberOfItems(), "call RemoveAllClippingPlanes()"
        ),
        "a mask": (
            getattr(mapper, "GetMaskInput", lambda: None)() is not None, "call SetMaskInput(None)"
        ),
        "a blend mode other than composite": (
            mapper.GetBlendMode() != COMPOSITE, "call SetBlendModeToComposite()"
        ),
    }  # fmt: skip
    _refuse(mapper.GetClassName(), features)


def _refuse_unsupported(volume_property: vtkVolumeProperty, component: int) -> None:
    features = {
        "a 2-D transfer function": (
            volume_property.GetTransferFunctionMode() == vtkVolumeProperty.TF_2D,
            "call SetTransferFunctionModeTo1D()",
        ),
        "gradient opacity": (
            _has_gradient_opacity(volume_property, component), "call DisableGradientOpacityOn()"
        ),
        "a label map": (volume_property.GetNumberOfLabels() > 0, "remove the labels' functions"),
    }  # fmt: skip
    _refuse("the volume property", features)


def _has_gradient_opacity(volume_property: vtkVolumeProperty, component: int) -> bool:
    """Whether a stored gradient opacity changes anything; VTK's default is 1 everywhere."""
    if volume_property.GetDisableGradientOpacity(component):
        return False
    if not volume_property.HasGradientOpacity(component):
        return False
    function = volume_property.GetStoredGradientOpacity(component)
    node = np.empty(4)
    for index in range(function.GetSize()):
        function.GetNodeValue(index, node)
        if node[1] != 1.0:
            return True
    return not function.GetClamping()


def _refuse(owner: str, features: Mapping[str, tuple[object, str]]) -> None:
    for name, (used, advice) in features.items():
        if used:
            raise ValueError(f"{owner} has {name}, which is not supported yet; {advice}")
