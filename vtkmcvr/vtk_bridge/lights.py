"""vtkLight -> lights.

VTK lights a white surface that faces a light of intensity 1 to the value 1. A Lambert surface
reflects radiance 1 under irradiance pi: irradiance and intensity are pi times what VTK says, so
that scenes keep their brightness. The light's diffuse colour is its colour; its ambient and
specular colours have no physical counterpart.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray
from vtkmodules.vtkRenderingCore import vtkCamera, vtkLight, vtkLightCollection

from ..lights import DirectionalLight, Light, PointLight
from ..scene import Camera, Vector
from .camera import vtk_camera_of
from .matrix import matrix_of

# Half angle in degrees from which on VTK takes a positional light to shine all around
NO_CONE = 90.0


def light_of(light: vtkLight, camera: vtkCamera | Camera) -> Light | None:
    """Light of a vtkLight, which stays as it is.

    Parameters
    ----------
    light : vtkLight
        A headlight shines along the view of `camera`, a camera light moves with it, a scene light
        stays. Not positional: a `DirectionalLight`; positional: a `PointLight`, whose cone ends at
        the cone angle where that is below 90 degrees.
    camera : vtkCamera or Camera

    Returns
    -------
    DirectionalLight, PointLight or None
        None for a light that is switched off.

    Raises
    ------
    ValueError
        Where position and focal point coincide, or intensity or colour are negative.
    """
    if not light.GetSwitch():
        return None
    position, focal_point = _geometry(light, camera)
    red, green, blue = light.GetDiffuseColor()
    scale = math.pi * light.GetIntensity()
    power = (scale * red, scale * green, scale * blue)
    direction = _vector(np.subtract(focal_point, position))
    if not light.GetPositional():
        return DirectionalLight(direction, power)
    spot = light.GetConeAngle() < NO_CONE
    return PointLight(
        position,
        power,
        attenuation=light.GetAttenuationValues(),
        direction=direction,
        cone_angle=light.GetConeAngle() if spot else 180.0,
        exponent=light.GetExponent() if spot else 0.0,
    )


def lights_of(
    lights: vtkLightCollection | Iterable[vtkLight | Light], camera: vtkCamera | Camera
) -> tuple[Light, ...]:
    """Lights of a renderer's collection or any sequence, without those switched off.

    Parameters
    ----------
    lights : vtkLightCollection or iterable of vtkLight or Light
        Lights of a scene are passed on as they are.
    camera : vtkCamera or Camera
        For headlights and camera lights.

    Raises
    ------
    TypeError
        For anything else among them.
    ValueError
        As `light_of`.
    """
    converted = [
        light if isinstance(light, Light) else light_of(light, camera) for light in members(lights)
    ]
    return tuple(light for light in converted if light is not None)


def default_headlight(camera: vtkCamera | Camera) -> DirectionalLight:
    """Return the light that vtkRenderer adds to a scene without any: white, along the view."""
    light = vtkLight()
    light.SetLightTypeToHeadlight()
    result = light_of(light, camera)
    assert isinstance(result, DirectionalLight)
    return result


def members(
    lights: vtkLightCollection | Iterable[vtkLight | Light],
) -> tuple[vtkLight | Light, ...]:
    """Lights of a collection or sequence, as they are; a TypeError for anything else."""
    if isinstance(lights, vtkLightCollection):
        count = lights.GetNumberOfItems()
        return tuple(cast(vtkLight, lights.GetItemAsObject(i)) for i in range(count))
    result = tuple(lights)
    for light in result:
        if not isinstance(light, (vtkLight, Light)):
            raise TypeError(f"lights are vtkLight or vtkmcvr.lights.Light, got {light!r}")
    return result


def _geometry(light: vtkLight, camera: vtkCamera | Camera) -> tuple[Vector, Vector]:
    """Position and focal point in world coordinates."""
    if isinstance(camera, Camera):
        camera = vtk_camera_of(replace(camera, panorama=False))
    if light.LightTypeIsHeadlight():
        return camera.GetPosition(), camera.GetFocalPoint()
    if light.LightTypeIsSceneLight():
        return light.GetTransformedPosition(), light.GetTransformedFocalPoint()
    to_world = matrix_of(camera.GetCameraLightTransformMatrix())
    points = np.array([(*light.GetPosition(), 1.0), (*light.GetFocalPoint(), 1.0)])
    position, focal_point = points @ to_world.T
    return _vector(position), _vector(focal_point)


def _vector(v: NDArray[np.float64]) -> Vector:
    return float(v[0]), float(v[1]), float(v[2])
