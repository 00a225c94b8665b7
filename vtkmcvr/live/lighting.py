"""A renderer's lights and environment texture -> lights of a scene."""

from __future__ import annotations

from typing import Any, cast

from vtkmodules.vtkRenderingCore import vtkLight, vtkRenderer

from ..camera import Camera
from ..lights import Light
from ..scene import Volume
from ..studio import Studio, studio_lights
from ..vtk_bridge.environment import Environment, environment_key
from ..vtk_bridge.scene import default_headlight, lights_of


def lights_key(renderer: vtkRenderer) -> tuple[Any, ...]:
    """Everything about a renderer's light that decides a picture, as values to compare."""
    lights = renderer.GetLights()
    values = []
    for index in range(lights.GetNumberOfItems()):
        light = cast(vtkLight, lights.GetItemAsObject(index))
        values.append((
            light.GetSwitch(), light.GetLightType(), light.GetPositional(), light.GetIntensity(),
            *_ends(light), light.GetDiffuseColor(), light.GetConeAngle(), light.GetExponent(),
            light.GetAttenuationValues(),
        ))  # fmt: skip
    return tuple(values), environment_key(renderer)


def _ends(light: vtkLight) -> tuple[Any, ...]:
    """Position and focal point; those of camera lights are seen from the camera."""
    if light.LightTypeIsHeadlight():
        # Where the camera is: VTK puts it there as it draws
        return ()
    if light.LightTypeIsSceneLight():
        return light.GetTransformedPosition(), light.GetTransformedFocalPoint()
    return light.GetPosition(), light.GetFocalPoint()


def scene_lights(
    renderer: vtkRenderer, camera: Camera, volume: Volume, lighting: Any, environment: Environment
) -> tuple[Light, ...]:
    """Lights of a scene.

    Parameters
    ----------
    renderer : vtkRenderer
    camera : Camera
        Of the whole view.
    volume : Volume
        In the middle of a studio.
    lighting : {"scene", "studio"}, Studio or sequence of Light
        Whose lights.
    environment : Environment

    Returns
    -------
    tuple of Light
        The headlight that VTK adds where a scene has no light at all.
    """
    if lighting == "studio":
        lighting = Studio()
    if isinstance(lighting, Studio):
        return studio_lights(lighting, volume, camera)
    if lighting != "scene":
        return tuple(lighting)
    around = environment.of(renderer)
    found = lights_of(renderer.GetLights(), camera) + (() if around is None else (around,))
    return found or (default_headlight(camera),)
