"""Physically based Monte Carlo volume rendering for VTK and PyVista.

    import vtkmcvr
    image = vtkmcvr.read("ct/")
    picture = vtkmcvr.render(image, preset="ct-bone", samples=64)
    picture.save("bone.png")

Importing this package loads nothing heavy; each name is imported when it is first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOME = {
    "read": "readers",
    "read_labels": "readers",
    "list_series": "readers",
    "time_steps": "readers",
    "override_pyvista_readers": "pyvista_readers",
    "render": "front",
    "scene_of": "front",
    "render_scene": "rendering",
    "estimate": "prediction",
    "study": "costs.study",
    "count_work": "work.count",
    "effect_costs": "costs.effects",
    "warm_up": "warming",
    "write_report": "report",
    "replay": "recipes.replaying",
    "read_recipe": "recipes.files",
    "EmissionAbsorption": "emission_absorption",
    "EmissionAbsorptionPicture": "emission_absorption",
    "render_emission_absorption": "emission_absorption",
    "Phong": "material",
    "Occlusion": "occlusion",
    "OcclusionPicture": "occlusion",
    "render_occlusion": "occlusion",
    "Picture": "pictures.picture",
    "DenoisedPicture": "pictures.denoised",
    "Display": "pictures.picture",
    "read_environment": "environment_files",
    "Scene": "scene",
    "Volume": "scene",
    "TransferFunction": "scene",
    "TransferTable": "scene",
    "Surface": "scene",
    "Isotropic": "scene",
    "HenyeyGreenstein": "scene",
    "Schlick": "scene",
    "Rayleigh": "scene",
    "Cone": "scene",
    "Camera": "scene",
    "Lens": "scene",
    "Stereo": "scene",
    "autofocus": "focus",
    "PixelFilter": "scene",
    "Curve": "curves",
    "ColourCurve": "curves",
    "Plane": "cutting",
    "Sphere": "cutting",
    "Box": "cutting",
    "Cropping": "cutting",
    "Labels": "labels",
    "Layer": "layers",
    "Segmentation": "segmentation",
    "Look": "presets",
    "read_look": "presets",
    "write_look": "presets",
    "look_of_property": "vtk_bridge.look",
    "property_of_look": "vtk_bridge.look",
    "PlaneReceiver": "receivers",
    "BoxReceiver": "receivers",
    "SphereReceiver": "receivers",
    "MeshReceiver": "receivers",
    "ConstantEnvironment": "lights",
    "EnvironmentMap": "lights",
    "RectangleLight": "lights",
    "DirectionalLight": "lights",
    "PointLight": "lights",
    "BoxLight": "lights",
    "CameraLight": "lights",
    "CylinderLight": "lights",
    "DiskLight": "lights",
    "GradientEnvironment": "lights",
    "SphereLight": "lights",
    "Texture": "lights",
    "blackbody": "lights",
    "headlight": "lights",
    "with_irradiance": "lights",
    "with_power": "lights",
    "with_vtk_intensity": "lights",
    "head_phantom": "phantom",
    "view_camera": "studio",
}

__all__ = ["__version__", *_HOME]

if TYPE_CHECKING:
    from .costs.effects import effect_costs
    from .costs.study import study
    from .curves import ColourCurve, Curve
    from .cutting import Box, Cropping, Plane, Sphere
    from .emission_absorption import (
        EmissionAbsorption,
        EmissionAbsorptionPicture,
        render_emission_absorption,
    )
    from .environment_files import read_environment
    from .focus import autofocus
    from .front import render, scene_of
    from .labels import Labels
    from .layers import Layer
    from .lights import (
        BoxLight,
        CameraLight,
        ConstantEnvironment,
        CylinderLight,
        DirectionalLight,
        DiskLight,
        EnvironmentMap,
        GradientEnvironment,
        PointLight,
        RectangleLight,
        SphereLight,
        Texture,
        blackbody,
        headlight,
        with_irradiance,
        with_power,
        with_vtk_intensity,
    )
    from .material import Phong
    from .occlusion import Occlusion, OcclusionPicture, render_occlusion
    from .phantom import head_phantom
    from .pictures.denoised import DenoisedPicture
    from .pictures.picture import Display, Picture
    from .prediction import estimate
    from .presets import Look, read_look, write_look
    from .pyvista_readers import override_pyvista_readers
    from .readers import list_series, read, read_labels, time_steps
    from .receivers import BoxReceiver, MeshReceiver, PlaneReceiver, SphereReceiver
    from .recipes.files import read_recipe
    from .recipes.replaying import replay
    from .rendering import render_scene
    from .report import write_report
    from .scene import (
        Camera,
        Cone,
        HenyeyGreenstein,
        Isotropic,
        Lens,
        PixelFilter,
        Rayleigh,
        Scene,
        Schlick,
        Stereo,
        Surface,
        TransferFunction,
        TransferTable,
        Volume,
    )
    from .segmentation import Segmentation
    from .studio import view_camera
    from .vtk_bridge.look import look_of_property, property_of_look
    from .warming import warm_up
    from .work.count import count_work


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
