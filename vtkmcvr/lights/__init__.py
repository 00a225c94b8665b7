"""Lights that the user describes. Radiance is linear RGB; one number means grey."""

from .area import AreaLight, BoxLight, CylinderLight, DiskLight, RectangleLight, SphereLight
from .attached import CameraLight, headlight
from .base import Light
from .distant import ConstantEnvironment, DirectionalLight, EnvironmentMap, GradientEnvironment
from .planck import blackbody
from .point import PointLight
from .texture import Texture, checkerboard, softbox
from .units import irradiance_at, power_of, with_irradiance, with_power, with_vtk_intensity

__all__ = [
    "AreaLight",
    "BoxLight",
    "CameraLight",
    "ConstantEnvironment",
    "CylinderLight",
    "DirectionalLight",
    "DiskLight",
    "EnvironmentMap",
    "GradientEnvironment",
    "Light",
    "PointLight",
    "RectangleLight",
    "SphereLight",
    "Texture",
    "blackbody",
    "checkerboard",
    "headlight",
    "irradiance_at",
    "power_of",
    "softbox",
    "with_irradiance",
    "with_power",
    "with_vtk_intensity",
]
