"""A view of a volume and the lights around it: camera placement, key light, rim light, fill."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from . import checks
from .lights import ConstantEnvironment, Light, RectangleLight
from .scene import Camera, Volume

Colour = tuple[float, float, float]

# View directions by name, in LPS (x left, y posterior, z superior): where the camera looks, what is
# up
VIEWS = {
    "front": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "back": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "left": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "right": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "top": ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0)),
    "bottom": ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0)),
}


# Room around a volume that fills the view
MARGIN = 1.02


@dataclass(frozen=True)
class Studio:
    """Key light, rim light and fill.

    Attributes
    ----------
    key, rim : float
        Irradiance at the volume's centre, of a warm rectangle up on the left of the camera and of a
        cool one behind on the right.
    fill : float
        Radiance of the constant environment.
    softness : float
        Edge of the key light over the radius of the volume.
    """

    key: float = 6.0
    rim: float = 2.5
    fill: float = 0.45
    softness: float = 1.2
    warm: Colour = (1.0, 0.93, 0.84)
    cool: Colour = (0.82, 0.91, 1.0)


@dataclass(frozen=True)
class View:
    """Where the camera stands; see `view_camera`."""

    view: str = "front"
    azimuth: float = 0.0
    elevation: float = 0.0
    roll: float = 0.0
    zoom: float = 1.0


def view_camera(
    volume: Volume,
    view: str = "front",
    *,
    azimuth: float = 0.0,
    elevation: float = 0.0,
    roll: float = 0.0,
    zoom: float = 1.0,
    view_angle: float = 30.0,
    aspect: float = 4 / 3,
    corners: NDArray | None = None,
) -> Camera:
    """Camera that sees the whole volume, or a part of it.

    Parameters
    ----------
    volume : Volume
    view : str
        Name in `VIEWS`: the side from which the patient is seen.
    azimuth, elevation, roll : float
        Degrees; the camera moves around the volume to the viewer's right, up, and turns clockwise.
    zoom : float
        > 0; 2 shows half the height.
    view_angle : float
        Degrees under which the sphere around the volume is seen; sets the distance. The angle of
        the camera is then fitted to the volume.
    aspect : float
        Width over height of the film.
    corners : array (n, 3), optional
        World points that shall fill the view; their middle as seen is the focal point.
        Default: the corners of the volume.
    """
    if view not in VIEWS:
        raise ValueError(f"view is one of {', '.join(VIEWS)}; got {view!r}")
    checks.number("zoom", zoom, above=0.0)
    forward, up = (np.array(v) for v in VIEWS[view])
    forward, up = _turn(forward, up, up, math.radians(checks.number("azimuth", azimuth)))
    right = np.cross(forward, up)
    forward, up = _turn(forward, up, right, -math.radians(checks.number("elevation", elevation)))
    forward, up = _turn(forward, up, forward, -math.radians(checks.number("roll", roll)))
    corners = volume.corners if corners is None else np.asarray(corners, np.float64)
    centre = _middle(corners, np.array([np.cross(forward, up), up, forward]))
    distance, height = _fit(corners - centre, forward, up, view_angle, aspect)
    angle = 2 * math.degrees(math.atan(height / zoom))
    position = centre - distance * forward
    return Camera(
        tuple(position.tolist()), tuple(centre.tolist()), tuple(up.tolist()), min(angle, 170.0)
    )


def _middle(points: NDArray, axes: NDArray) -> NDArray:
    """Middle of the box around points (n, 3) whose edges run along orthonormal axes (rows)."""
    along = points @ axes.T
    return (along.min(0) + along.max(0)) / 2 @ axes


def projected(camera: Camera, projection: str) -> Camera:
    """Camera with the same view in another projection.

    Parameters
    ----------
    camera : Camera
        Perspective.
    projection : {"perspective", "parallel", "panorama"}
        Parallel: the plane through the focal point keeps its size. Panorama: from the focal point,
        with the view direction in the middle.
    """
    if projection == "perspective":
        return camera
    if projection == "parallel":
        scale = camera.distance * math.tan(math.radians(camera.view_angle) / 2)
        return replace(camera, parallel_scale=scale)
    if projection == "panorama":
        ahead = np.array(camera.focal_point) + camera.frame[2] * camera.distance
        return replace(
            camera,
            position=camera.focal_point,
            focal_point=tuple(ahead.tolist()),
            panorama=True,
        )
    raise ValueError(f"projection is perspective, parallel or panorama; got {projection!r}")


def _turn(forward: NDArray, up: NDArray, axis: NDArray, angle: float) -> tuple[NDArray, NDArray]:
    """Rotate both vectors around a unit axis (Rodrigues)."""
    c, s = math.cos(angle), math.sin(angle)

    def rotated(v: NDArray) -> NDArray:
        return v * c + np.cross(axis, v) * s + axis * (axis @ v) * (1 - c)

    return rotated(forward), rotated(up)


def _fit(
    corners: NDArray, forward: NDArray, up: NDArray, view_angle: float, aspect: float
) -> tuple[float, float]:
    """Distance to the centre, and tangent of half the view angle that holds all corners."""
    radius = float(np.linalg.norm(corners, axis=1).max())
    distance = radius / math.sin(math.radians(view_angle) / 2)
    right = np.cross(forward, up)
    depth = distance + corners @ forward
    need = max(
        float((np.abs(corners @ up) / depth).max()),
        float((np.abs(corners @ right) / depth).max()) / aspect,
    )
    return distance, need * MARGIN


def studio_lights(studio: Studio, volume: Volume, camera: Camera) -> tuple[Light, ...]:
    """Lights placed around the volume as the camera sees it."""
    right, up, forward = camera.frame
    radius, centre = volume.radius, volume.centre
    lights: list[Light] = [ConstantEnvironment((studio.fill,) * 3)]
    key = centre + 2.6 * radius * _unit(-0.75 * right + 0.85 * up - 0.9 * forward)
    rim = centre + 2.6 * radius * _unit(0.95 * right + 0.55 * up + 0.55 * forward)
    parts = (
        (studio.key, key, studio.softness, studio.warm),
        (studio.rim, rim, 0.9, studio.cool),
    )
    for irradiance, position, edge, tint in parts:
        if irradiance > 0:
            lights.append(_panel(irradiance, position, edge * radius, tint, centre, up))
    return tuple(lights)


def _panel(
    irradiance: float,
    position: NDArray,
    edge: float,
    tint: Colour,
    centre: NDArray,
    up: NDArray,
) -> RectangleLight:
    """Square that sends about this irradiance to the centre it faces."""
    solid_angle = edge * edge / float(np.sum((position - centre) ** 2))
    radiance = np.asarray(tint) * (irradiance / solid_angle)
    return RectangleLight(
        tuple(position.tolist()),
        tuple(centre.tolist()),
        (edge, edge),
        tuple(radiance.tolist()),
        tuple(up.tolist()),
    )


def _unit(v: NDArray) -> NDArray:
    return v / np.linalg.norm(v)
