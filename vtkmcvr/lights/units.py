"""One light in another unit: radiant power, irradiance at a place, intensity as in VTK."""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from .. import checks
from .area import AreaLight
from .base import Light, Vector
from .distant import ConstantEnvironment, DirectionalLight
from .point import PointLight

L = TypeVar("L", bound=Light)


def power_of(light: Light) -> NDArray[np.float64]:
    """Radiant power of an area light or point light, linear RGB.

    Parameters
    ----------
    light : AreaLight or PointLight
        Lambertian surfaces emit pi times radiance times area; a spot emits 2 pi I (1 - cos^(e+1)) /
        (e+1) with the cosine of its cone and the exponent e of its falloff.

    Raises
    ------
    ValueError
        For other lights, and for points whose light does not fall off with the square of the
        distance: their power is not finite.
    """
    of_unit = _power_of_unit(light)
    return of_unit * light.brightness


def with_power(light: L, power: Any) -> L:
    """Light of this radiant power, a number or linear RGB; see `power_of`."""
    return _given(light, checks.colour("power", power), _power_of_unit(light))


def irradiance_at(light: Light, place: Any, normal: Any = None) -> NDArray[np.float64]:
    """Irradiance on a surface when nothing is in the way, linear RGB.

    Parameters
    ----------
    light : Light
        Area lights are integrated over 64 x 64 points a patch, without their texture's pattern but
        with its mean.
    place : 3 floats
        World coordinates.
    normal : 3 floats, optional
        Normal of the surface. Default: it faces the middle of the light.
    """
    place = np.array(checks.vector("place", place))
    of_unit = _irradiance_of_unit(light, place, normal)
    return of_unit * light.brightness


def with_irradiance(light: L, irradiance: Any, place: Any, normal: Any = None) -> L:
    """Light of this irradiance at a place; see `irradiance_at`."""
    place = np.array(checks.vector("place", place))
    wanted = checks.colour("irradiance", irradiance)
    return _given(light, wanted, _irradiance_of_unit(light, place, normal))


def with_vtk_intensity(light: L, intensity: Any, place: Any = None) -> L:
    """Light as bright as a vtkLight of this intensity.

    A vtkLight of intensity 1 gives a white surface that faces it the value 1. A Lambert surface
    reflects radiance 1 under irradiance pi, so the irradiance is pi times the intensity.

    Parameters
    ----------
    light : Light
        Of point lights, pi times the intensity is their intensity: their attenuation acts as VTK's.
    intensity : colour
        Intensity times colour of the vtkLight.
    place : 3 floats, optional
        Where area lights shine with that irradiance.
    """
    wanted = np.multiply(math.pi, checks.colour("intensity", intensity))
    if isinstance(light, (PointLight, DirectionalLight)):
        return light.with_brightness(wanted)
    if place is None:
        raise ValueError("an area light or environment has a VTK intensity at a place: give one")
    return with_irradiance(light, wanted, place)


def _given(light: L, wanted: Vector, of_unit: NDArray) -> L:
    if not (of_unit > 0).all():
        raise ValueError(f"{type(light).__name__} sends no light there, however bright it is")
    return light.with_brightness(np.divide(wanted, of_unit))


def _texture_mean(light: Light) -> NDArray[np.float64]:
    texture = getattr(light, "texture", None)
    return np.ones(3) if texture is None else texture.mean


def _power_of_unit(light: Light) -> NDArray[np.float64]:
    if isinstance(light, AreaLight):
        return math.pi * light.area * _texture_mean(light)
    if isinstance(light, PointLight):
        a, b, c = light.attenuation
        if a or b:
            raise ValueError(f"a light of attenuation {light.attenuation} has no finite power")
        return np.full(3, _solid_angle(light) / c)
    raise ValueError(f"{type(light).__name__} has no power: only area and point lights have")


def _solid_angle(light: PointLight) -> float:
    """Integral of the falloff over all directions."""
    angle = min(light.cone_angle, 90.0) if light.exponent > 0 else light.cone_angle
    n = light.exponent + 1
    return 2 * math.pi * (1 - math.cos(math.radians(angle)) ** n) / n


def _irradiance_of_unit(light: Light, place: NDArray, normal: Any) -> NDArray[np.float64]:
    if isinstance(light, ConstantEnvironment):
        return np.full(3, math.pi)
    if isinstance(light, DirectionalLight):
        return np.full(3, _cosine(-np.array(light.direction), normal))
    if isinstance(light, PointLight):
        return np.full(3, _from_point(light, place, normal))
    if isinstance(light, AreaLight):
        return _from_area(light, place, normal) * _texture_mean(light)
    raise ValueError(f"the irradiance of {type(light).__name__} is not known in advance")


def _cosine(toward: NDArray, normal: Any) -> float:
    if normal is None:
        return 1.0
    return max(float(np.dot(checks.direction("normal", normal), toward)), 0.0)


def _from_point(light: PointLight, place: NDArray, normal: Any) -> float:
    toward = np.array(light.position) - place
    distance = float(np.linalg.norm(toward))
    if distance == 0:
        raise ValueError(f"the place {tuple(place.tolist())} is that of the light")
    toward /= distance
    cosine = -float(np.dot(light.direction, toward))
    if light.cone_angle < 180 and cosine < math.cos(math.radians(light.cone_angle)):
        return 0.0
    falloff = max(cosine, 0.0) ** light.exponent if light.exponent > 0 else 1.0
    return _cosine(toward, normal) * falloff / np.dot(light.attenuation, (1, distance, distance**2))


def _from_area(light: AreaLight, place: NDArray, normal: Any) -> float:
    parts = [patch.quadrature() for patch in light.patches]
    points, normals, areas = (np.concatenate(part) for part in zip(*parts, strict=True))
    toward = points - place
    square = np.sum(toward**2, axis=1)
    toward /= np.sqrt(square)[:, None]
    middle = np.mean([patch.centre for patch in light.patches], axis=0) - place
    facing = np.array(checks.direction("normal", middle if normal is None else normal))
    at_light = -np.sum(normals * toward, axis=1)
    two_sided = getattr(light, "two_sided", False)
    at_light = np.abs(at_light) if two_sided else np.maximum(at_light, 0)
    return float(np.sum(np.maximum(toward @ facing, 0) * at_light / square * areas))
