"""Where the picture is taken from: projection, lens, eyes, pixel filter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import checks

Vector = tuple[float, float, float]

MOST_BLADES = 64


@dataclass(frozen=True)
class Lens:
    """Thin lens: the focal plane is sharp, all else blurred by the shape of the aperture.

    Parameters
    ----------
    radius : float
        Radius of the aperture in world units, to the corners of a polygon, >= 0; 0 is a pinhole.
    focus_distance : float, optional
        Distance of the focal plane along the view axis, world units, > 0. Default: the focal point.
        `vtkmcvr.autofocus` measures that of a pixel.
    blades : int
        Corners of the aperture, a regular polygon, 3 to 64; 0: circular.
    rotation : float
        Degrees by which the polygon is turned counter-clockwise, as seen from behind the camera;
        0: a corner on top.
    """

    radius: float
    focus_distance: float | None = None
    blades: int = 0
    rotation: float = 0.0

    def __post_init__(self) -> None:
        checks.number("lens.rotation", self.rotation)
        if checks.whole("lens.blades", self.blades, least=0) not in (0, *range(3, MOST_BLADES + 1)):
            raise ValueError(
                f"lens.blades is 0 (circular) or from 3 to {MOST_BLADES}, got {self.blades}"
            )
        checks.number("lens.radius", self.radius, least=0.0)
        if self.focus_distance is not None:
            checks.number("lens.focus_distance", self.focus_distance, above=0.0)


@dataclass(frozen=True)
class Stereo:
    """Two eyes that look along parallel axes, their windows shifted (no vertical parallax).

    Parameters
    ----------
    eyes : {"both", "left", "right"}
        The view of one eye, or of both side by side, each on half of the film: left on the left.
    angle : float
        Angle between the lines of sight at the distance of convergence, degrees, as
        vtkCamera::SetEyeAngle; the eyes are 2 convergence tan(angle / 2) apart.
    convergence : float, optional
        Distance along the view axis at which both eyes see the same, world units, > 0. Default: the
        focal point, as in VTK.
    """

    eyes: str = "both"
    angle: float = 2.0
    convergence: float | None = None

    def __post_init__(self) -> None:
        if self.eyes not in ("both", "left", "right"):
            raise ValueError(f"stereo.eyes is one of both, left, right; got {self.eyes!r}")
        checks.number("stereo.angle", self.angle, above=0.0, most=90.0)
        if self.convergence is not None:
            checks.number("stereo.convergence", self.convergence, above=0.0)


@dataclass(frozen=True)
class Camera:
    """As vtkCamera: a position that looks at a focal point.

    Parameters
    ----------
    position, focal_point, view_up : 3 floats
        World coordinates; view_up must not be parallel to the view direction.
    view_angle : float
        Vertical angle of view in degrees, (0, 180).
    parallel_scale : float, optional
        Half the height of the view in world units; given, the projection is parallel.
    window_centre : 2 floats
        Shift of the image centre in half window sizes, as vtkCamera::SetWindowCenter.
    lens : Lens, optional
        Depth of field.
    stereo : Stereo, optional
        The view of one eye or of two.
    panorama : bool
        All directions in latitude-longitude form: the view direction in the middle of the film, up
        on top, 360 degrees wide and 180 high. Neither view angle nor window centre matter, and
        there is no lens.
    """

    position: Vector
    focal_point: Vector
    view_up: Vector = (0.0, 0.0, 1.0)
    view_angle: float = 30.0
    parallel_scale: float | None = None
    window_centre: tuple[float, float] = (0.0, 0.0)
    lens: Lens | None = None
    stereo: Stereo | None = None
    panorama: bool = False

    def __post_init__(self) -> None:
        for name in ("position", "focal_point", "view_up"):
            object.__setattr__(self, name, checks.vector(f"camera.{name}", getattr(self, name)))
        checks.number("camera.view_angle", self.view_angle, above=0.0, most=179.9)
        if self.parallel_scale is not None:
            checks.number("camera.parallel_scale", self.parallel_scale, above=0.0)
        checks.vector("camera.window_centre", (*self.window_centre, 0.0))
        if self.panorama and (self.parallel_scale is not None or self.stereo is not None):
            other = "parallel" if self.stereo is None else "stereo"
            raise ValueError(f"a camera is a panorama or {other}, not both")
        if self.distance == 0.0:
            raise ValueError(f"camera.position and camera.focal_point are both {self.position}")
        self.frame  # noqa: B018 - raises when view_up is parallel to the view direction

    @property
    def distance(self) -> float:
        """Distance from position to focal point, world units."""
        return float(np.linalg.norm(np.subtract(self.focal_point, self.position)))

    @property
    def frame(self) -> tuple[NDArray, NDArray, NDArray]:
        """Unit vectors (right, up, forward) in world coordinates."""
        forward = np.subtract(self.focal_point, self.position) / self.distance
        right = np.cross(forward, checks.direction("camera.view_up", self.view_up))
        length = np.linalg.norm(right)
        if length < 1e-9:
            raise ValueError(
                f"camera.view_up {self.view_up} is parallel to the view direction "
                f"{tuple(forward.tolist())}; choose another"
            )
        right = right / length
        return right, np.cross(right, forward), forward


@dataclass(frozen=True)
class PixelFilter:
    """Reconstruction filter, from which film samples are drawn.

    Parameters
    ----------
    kind : {"gaussian", "box", "tent"}
    width : float
        Standard deviation of the Gaussian (cut off at three), half width of box and tent; pixels, >
        0.
    """

    kind: str = "gaussian"
    width: float = 0.5

    def __post_init__(self) -> None:
        if self.kind not in ("gaussian", "box", "tent"):
            raise ValueError(f"pixel filters are gaussian, box, tent; got {self.kind!r}")
        checks.number("pixel filter width", self.width, above=0.0, most=64.0)
