"""vtkVolumeProperty -> transfer function, surface, phase function.

Interpolation is always linear, whatever the property says: a new vtkVolumeProperty says nearest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from vtkmodules.vtkRenderingCore import vtkVolumeProperty
from vtkmodules.vtkRenderingVolume import vtkVolumeMapper

from ..curves import Curve
from ..material import Phong
from ..phases import MOST_FORWARD, HenyeyGreenstein, Isotropic, Phase
from ..scene import Surface, TransferFunction
from .transfer import colour_curve, grey_curve, opacity_curve, transfer_table

RGB_CHANNELS = 3
COMPOSITE = 0


def transfer_of(
    volume_property: vtkVolumeProperty,
    component: int = 0,
    scalar_range: tuple[float, float] | None = None,
) -> TransferFunction:
    """Transfer function of a property: scalar opacity, colour, unit distance, gradient opacity.

    The weight of the component scales its density. Gradient opacity is a factor on the extinction;
    as in VTK it is a function of the scalar's change over the mean spacing of the voxels. A 2-D
    function spans `scalar_range` and gradient magnitudes from 0 to a quarter of that range, as in
    VTK; unlike there its opacities are per unit distance, so that no sample distance matters.

    A function that was never set is VTK's default, which VTK creates when asked: the property's
    modification time then goes up once.

    Parameters
    ----------
    volume_property : vtkVolumeProperty
    component : int
        Which of the property's components.
    scalar_range : (low, high), optional
        Of the volume; needed for a 2-D function.

    Raises
    ------
    ValueError
        Where the property has what is not supported yet, or a function has no nodes.
    """
    unit_distance = volume_property.GetScalarOpacityUnitDistance(component)
    weight = volume_property.GetComponentWeight(component)
    if volume_property.GetTransferFunctionMode() == vtkVolumeProperty.TF_2D:
        function = volume_property.GetTransferFunction2D(component)
        table = transfer_table(function, scalar_range)
        return TransferFunction(table=table, unit_distance=unit_distance, density_scale=weight)
    # Asking for the other kind of colour would switch the property to it
    if volume_property.GetColorChannels(component) == RGB_CHANNELS:
        colour = colour_curve(volume_property.GetRGBTransferFunction(component))
    else:
        colour = grey_curve(volume_property.GetGrayTransferFunction(component))
    return TransferFunction(
        opacity_curve(volume_property.GetScalarOpacity(component)),
        colour,
        unit_distance=unit_distance,
        density_scale=weight,
        gradient_opacity=_gradient_opacity(volume_property, component),
    )


def surface_of(
    volume_property: vtkVolumeProperty, component: int = 0, *, gradient_factor: float = 0.5
) -> Surface | None:
    """Surface of a property, where shading is on.

    VTK adds a Phong highlight s (r.v)^p; the coat has Blinn's (n.h)^e, as wide for e = 4 p. Its
    reflectance is 8 s / (e + 2), at most 1: then the highlight is as bright as VTK's in the middle.
    VTK's default s = 0.2, p = 10 becomes 0.038, about that of glass or wet tissue. The ambient and
    diffuse coefficients are for technique "emission-absorption" alone, as `phong`: in light
    transport the colour is the albedo, and ambient light comes from lights.

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
    phong = Phong(
        volume_property.GetAmbient(component), volume_property.GetDiffuse(component),
        volume_property.GetSpecular(component), volume_property.GetSpecularPower(component),
    )  # fmt: skip
    return Surface(gradient_factor, specular=specular, exponent=exponent, phong=phong)


def phase_of(volume_property: vtkVolumeProperty) -> Phase:
    """Phase function of Henyey and Greenstein with the property's scattering anisotropy.

    VTK allows -1 and 1, where nothing scatters sideways; the nearest number allowed is taken.
    """
    g = float(volume_property.GetScatteringAnisotropy())
    return HenyeyGreenstein(float(np.clip(g, -MOST_FORWARD, MOST_FORWARD))) if g else Isotropic()


def one_phase_of(properties: Sequence[vtkVolumeProperty]) -> Phase:
    """Phase function that several volumes share.

    Raises
    ------
    ValueError
        Where they differ: a scene has one phase function.
    """
    found = [float(own.GetScatteringAnisotropy()) for own in properties]
    if len(set(found)) > 1:
        raise ValueError(
            f"the volumes' scattering anisotropies are {', '.join(f'{g:g}' for g in found)}, but a "
            "scene has one phase function: call SetScatteringAnisotropy with one number on all"
        )
    return phase_of(properties[0])


def refuse_mapper_features(mapper: vtkVolumeMapper) -> None:
    """Raise a ValueError where a volume mapper blends in a way not supported yet.

    Parameters
    ----------
    mapper : vtkVolumeMapper
        Of a vtkVolume that is to be rendered.
    """
    features = {
        "a blend mode other than composite": (
            mapper.GetBlendMode() != COMPOSITE, "call SetBlendModeToComposite()"
        ),
    }  # fmt: skip
    _refuse(mapper.GetClassName(), features)


def _gradient_opacity(volume_property: vtkVolumeProperty, component: int) -> Curve | None:
    """Stored gradient opacity, where it is not disabled and not VTK's default, 1 everywhere."""
    if volume_property.GetDisableGradientOpacity(component):
        return None
    if not volume_property.HasGradientOpacity(component):
        return None
    function = volume_property.GetStoredGradientOpacity(component)
    if not function.GetSize():
        return None
    curve = opacity_curve(function)
    flat = curve.clamp and all(node[1] == 1.0 for node in curve.nodes)
    return None if flat else curve


def _refuse(owner: str, features: Mapping[str, tuple[object, str]]) -> None:
    for name, (used, advice) in features.items():
        if used:
            raise ValueError(f"{owner} has {name}, which is not supported yet; {advice}")
