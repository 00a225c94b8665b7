"""vtkCamera <-> camera."""

from __future__ import annotations

import math

import numpy as np
from vtkmodules.vtkRenderingCore import vtkCamera

from ..scene import Camera, Lens, Stereo, Volume

VIEW_ANGLE = 30.0


def camera_of(
    camera: vtkCamera,
    lens: Lens | None = None,
    *,
    aspect: float | None = None,
    eyes: str | None = None,
) -> Camera:
    """Camera of a vtkCamera, perspective or parallel.

    The clipping range is not used. The focal distance of a new vtkCamera is 0, which means without
    depth of field; above 0 the camera has a lens, as in VTK's ray tracers, of the diameter of the
    focal disk.

    Parameters
    ----------
    camera : vtkCamera
    lens : Lens, optional
        Depth of field, instead of the camera's own.
    aspect : float, optional
        Width over height of the film; needed where the view angle is the horizontal one.
    eyes : {"both", "left", "right"}, optional
        Stereo view under the camera's eye angle.

    Returns
    -------
    Camera

    Raises
    ------
    ValueError
        Where the camera uses what a `Camera` cannot express, or is degenerate.
    """
    _refuse_unsupported(camera)
    parallel = bool(camera.GetParallelProjection())
    return Camera(
        position=camera.GetPosition(),
        focal_point=camera.GetFocalPoint(),
        view_up=camera.GetViewUp(),
        view_angle=_vertical_angle(camera, aspect),
        parallel_scale=camera.GetParallelScale() if parallel else None,
        window_centre=camera.GetWindowCenter(),
        lens=lens or lens_of(camera),
        stereo=None if eyes is None else Stereo(eyes, camera.GetEyeAngle()),
    )


def lens_of(camera: vtkCamera) -> Lens | None:
    """Lens of a vtkCamera, or None where its focal distance is 0."""
    distance = camera.GetFocalDistance()
    if distance <= 0:
        return None
    return Lens(camera.GetFocalDisk() / 2, distance)


def vtk_camera_of(camera: Camera) -> vtkCamera:
    """Return a vtkCamera with the same view and lens; a polygonal aperture becomes circular.

    Raises
    ------
    ValueError
        For a panorama, which a vtkCamera cannot express.
    """
    if camera.panorama:
        raise ValueError("a vtkCamera cannot express a panorama")
    result = vtkCamera()
    result.SetPosition(camera.position)
    result.SetFocalPoint(camera.focal_point)
    result.SetViewUp(camera.view_up)
    result.SetViewAngle(camera.view_angle)
    result.SetWindowCenter(*camera.window_centre)
    if camera.parallel_scale is not None:
        result.ParallelProjectionOn()
        result.SetParallelScale(camera.parallel_scale)
    if camera.lens is not None and camera.lens.radius > 0:
        result.SetFocalDisk(2 * camera.lens.radius)
        result.SetFocalDistance(camera.lens.focus_distance or camera.distance)
    if camera.stereo is not None:
        result.SetEyeAngle(camera.stereo.angle)
    return result


def default_camera(volume: Volume, aspect: float = 1.0) -> Camera:
    """View of the whole volume along -z with +y up, as a new vtkRenderer chooses it.

    Parameters
    ----------
    volume : Volume
    aspect : float
        Width over height of the film.
    """
    half = math.radians(VIEW_ANGLE) / 2
    narrower = min(half, math.atan(math.tan(half) * aspect))
    x, y, z = volume.centre.tolist()
    return Camera(
        (x, y, z + volume.radius / math.sin(narrower)),
        (x, y, z),
        view_up=(0.0, 1.0, 0.0),
        view_angle=VIEW_ANGLE,
    )


def _vertical_angle(camera: vtkCamera, aspect: float | None) -> float:
    angle = camera.GetViewAngle()
    if not camera.GetUseHorizontalViewAngle() or camera.GetParallelProjection():
        return angle
    if aspect is None:
        raise ValueError("the camera's view angle is horizontal: the film's aspect is needed")
    return 2 * math.degrees(math.atan(math.tan(math.radians(angle) / 2) / aspect))


def _refuse_unsupported(camera: vtkCamera) -> None:
    features = {
        "view shear": not np.array_equal(camera.GetViewShear(), (0.0, 0.0, 1.0)),
        "a user transform": camera.GetUserTransform() is not None,
        "a user view transform": camera.GetUserViewTransform() is not None,
        "a model transform": not camera.GetModelTransformMatrix().IsIdentity(),
        "an explicit projection matrix": camera.GetUseExplicitProjectionTransformMatrix(),
        "off-axis projection": camera.GetUseOffAxisProjection(),
        # Missing before VTK 9.3
        "an explicit aspect ratio": getattr(camera, "GetUseExplicitAspectRatio", int)(),
    }
    for name, used in features.items():
        if used:
            raise ValueError(
                f"the camera uses {name}, which is not supported yet; express the view by "
                "position, focal point, view up, view angle and window centre"
            )
