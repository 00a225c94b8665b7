"""What the user describes: plain, frozen, validated data. World units are those of the volume.

Nothing here knows VTK or Numba; `vtk_scene` translates from VTK, `plan` into what kernels see.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import checks
from .curves import ColourCurve, Curve
from .lights import ConstantEnvironment, EnvironmentMap, Light

Vector = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Volume:
    """Scalars on a regular grid.

    Parameters
    ----------
    values : array (k, j, i)
        One real scalar per point, at least two points along each axis. NaN and infinite values are
        "no data": transparent.
    index_to_world : array (4, 4), optional
        Affine map from index coordinates (i, j, k) to world: origin, spacing, direction, user
        matrix.
    """

    values: NDArray
    index_to_world: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        values = np.asarray(self.values)
        if values.ndim != 3:
            raise ValueError(
                f"a volume has one scalar per point, shape (k, j, i); got shape {values.shape}"
            )
        if min(values.shape) < 2:
            raise ValueError(
                "a volume needs at least two points along each axis; this is a 2-D image or a "
                f"single slice of {' x '.join(map(str, values.shape[::-1]))} points"
            )
        if values.dtype.kind not in "iufb":
            raise ValueError(f"a volume holds real numbers, got type {values.dtype}")
        object.__setattr__(self, "values", values)
        matrix = checks.affine("volume.index_to_world", self.index_to_world)
        object.__setattr__(self, "index_to_world", matrix)

    @classmethod
    def from_grid(
        cls,
        values: NDArray,
        spacing: Vector = (1.0, 1.0, 1.0),
        origin: Vector = (0.0, 0.0, 0.0),
        direction: NDArray | None = None,
    ) -> Volume:
        """Volume of an array (k, j, i), with spacing and origin in world units.

        `direction` is a 3x3 matrix whose columns are the index axes in world coordinates.
        """
        matrix = np.eye(4)
        axes = np.eye(3) if direction is None else np.asarray(direction, np.float64)
        matrix[:3, :3] = axes * np.asarray(checks.vector("spacing", spacing))
        matrix[:3, 3] = checks.vector("origin", origin)
        return cls(values, matrix)

    def flipped(self, axes: str) -> Volume:
        """The volume with some of its index axes ("i", "j", "k") running backwards in the world.

        For files that do not say which way they were stored: "k" turns a head that stands on its
        crown, left and right staying as they are.
        """
        if not axes or set(axes) - set("ijk") or len(set(axes)) < len(axes):
            raise ValueError(f"flip takes axes out of i, j, k, such as k or ij; got {axes!r}")
        matrix = self.index_to_world.copy()
        for axis in ("ijk".index(letter) for letter in axes):
            matrix[:3, 3] += matrix[:3, axis] * (self.shape[axis] - 1)
            matrix[:3, axis] *= -1
        return Volume(self.values, matrix)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of points along (i, j, k)."""
        k, j, i = self.values.shape
        return i, j, k

    @property
    def centre(self) -> NDArray[np.float64]:
        """World position of the middle of the grid."""
        middle = (np.array(self.shape) - 1) / 2
        return self.index_to_world[:3, :3] @ middle + self.index_to_world[:3, 3]

    @property
    def spacing(self) -> NDArray[np.float64]:
        """Distance between neighbouring points along (i, j, k), in world units."""
        return np.linalg.norm(self.index_to_world[:3, :3], axis=0)

    @property
    def corners(self) -> NDArray[np.float64]:
        """The eight outer points, (8, 3), in world coordinates."""
        far = np.array(self.shape) - 1
        index = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * far
        return index @ self.index_to_world[:3, :3].T + self.index_to_world[:3, 3]

    @property
    def radius(self) -> float:
        """Radius of the sphere around the corners, in world units."""
        return float(np.linalg.norm(self.corners - self.centre, axis=1).max())


@dataclass(frozen=True)
class TransferFunction:
    """Scalar -> extinction and colour.

    Parameters
    ----------
    opacity : Curve, optional
        Opacity a per `unit_distance`, [0, 1]: sigma_t = -log1p(-a) / unit_distance. a = 1 is
        capped, see `vtkmcvr.tables.OPAQUE_DEPTH`.
    colour : ColourCurve
        Single-scattering albedo of the volume and diffuse colour of surfaces, linear RGB, [0, 1].
    unit_distance : float
        World units, > 0.
    extinction : Curve, optional
        Extinction sigma_t in 1/world unit, instead of opacity.
    density_scale : float
        Factor on sigma_t, >= 0.
    """

    opacity: Curve | None
    colour: ColourCurve
    unit_distance: float = 1.0
    extinction: Curve | None = None
    density_scale: float = 1.0

    def __post_init__(self) -> None:
        if (self.opacity is None) == (self.extinction is None):
            raise ValueError("a transfer function takes either opacity or extinction, exactly one")
        checks.number("unit_distance", self.unit_distance, above=0.0)
        checks.number("density_scale", self.density_scale, least=0.0)
        curve = self.opacity if self.opacity is not None else self.extinction
        y = np.array([node[1] for node in curve.nodes])  # type: ignore[union-attr]
        if y.min() < 0:
            raise ValueError(f"opacity and extinction must not be negative, got {y.min():g}")
        if self.opacity is not None and y.max() > 1:
            raise ValueError(f"opacity goes from 0 to 1, got {y.max():g}")


@dataclass(frozen=True)
class Surface:
    """Hybrid scattering: surfaces where the gradient is strong (Exposure Render, Eq. 1, corrected).

    Parameters
    ----------
    gradient_factor : float
        g in P_brdf = opacity (1 - exp(-25 g^3 |grad|/max|grad|)), [0, 1]. 0: no
        surfaces, no gradients.
    always : bool
        BRDF at every collision that has a gradient, whatever `gradient_factor`.
    specular : colour
        Reflectance of the glossy coat at normal incidence; 0: plain Lambert.
    exponent : float
        Blinn exponent of the coat, >= 0.
    """

    gradient_factor: float = 0.5
    always: bool = False
    specular: Vector | float = (0.04, 0.04, 0.04)
    exponent: float = 30.0

    def __post_init__(self) -> None:
        checks.number("gradient_factor", self.gradient_factor, least=0.0, most=1.0)
        specular = checks.colour("specular", self.specular)
        if max(specular) > 1:
            raise ValueError(f"specular goes from 0 to 1, got {specular}")
        checks.number("exponent", self.exponent, least=0.0, most=1e6)
        object.__setattr__(self, "specular", specular)


@dataclass(frozen=True)
class Lens:
    """Thin lens with a circular aperture.

    Parameters
    ----------
    radius : float
        Radius of the aperture in world units, >= 0; 0 is a pinhole.
    focus_distance : float, optional
        Distance of the focal plane along the view axis, world units, > 0. Default: the focal point.
    """

    radius: float
    focus_distance: float | None = None

    def __post_init__(self) -> None:
        checks.number("lens.radius", self.radius, least=0.0)
        if self.focus_distance is not None:
            checks.number("lens.focus_distance", self.focus_distance, above=0.0)


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
    """

    position: Vector
    focal_point: Vector
    view_up: Vector = (0.0, 0.0, 1.0)
    view_angle: float = 30.0
    parallel_scale: float | None = None
    window_centre: tuple[float, float] = (0.0, 0.0)
    lens: Lens | None = None

    def __post_init__(self) -> None:
        for name in ("position", "focal_point", "view_up"):
            object.__setattr__(self, name, checks.vector(f"camera.{name}", getattr(self, name)))
        checks.number("camera.view_angle", self.view_angle, above=0.0, most=179.9)
        if self.parallel_scale is not None:
            checks.number("camera.parallel_scale", self.parallel_scale, above=0.0)
        checks.vector("camera.window_centre", (*self.window_centre, 0.0))
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


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that decides the radiance of a picture.

    Parameters
    ----------
    volume, transfer, camera
        The medium, its look, the view.
    lights : sequence of Light
        Rectangle, directional and point lights, and at most one each of ConstantEnvironment and
        EnvironmentMap.
    surface : Surface, optional
        None: volume scattering only.
    phase_g : float
        Mean cosine of the Henyey-Greenstein phase function, -0.9999 to 0.9999; 0: isotropic.
    shadow_reach : float
        Distance from the scattering point within which the medium attenuates light, world units;
        inf: physically right; 0: no shadows.
    environment_visible : bool
        Whether camera rays that miss the volume see the environment.
    ratio_tracking : bool
        Shadow rays estimate transmittance by ratio tracking (True), or as seen or not by delta
        tracking as in Exposure Render (False).
    light_sampling : {"mis", "light", "scatter"}
        How directions toward light are drawn; "light" and "scatter" are for tests.
    size : (width, height)
        Pixels.
    pixel_filter : PixelFilter
    """

    volume: Volume
    transfer: TransferFunction
    camera: Camera
    lights: tuple[Light, ...] = ()
    surface: Surface | None = None
    phase_g: float = 0.0
    shadow_reach: float = float("inf")
    environment_visible: bool = False
    ratio_tracking: bool = True
    light_sampling: str = "mis"
    size: tuple[int, int] = (800, 600)
    pixel_filter: PixelFilter = field(default_factory=PixelFilter)

    def __post_init__(self) -> None:
        object.__setattr__(self, "lights", tuple(self.lights))
        for kind in (ConstantEnvironment, EnvironmentMap):
            if sum(isinstance(light, kind) for light in self.lights) > 1:
                raise ValueError(f"a scene takes at most one {kind.__name__}")
        checks.number("phase_g", self.phase_g, least=-0.9999, most=0.9999)
        checks.number("shadow_reach", self.shadow_reach, least=0.0, finite=False)
        if self.light_sampling not in ("mis", "light", "scatter"):
            raise ValueError(
                f"light_sampling is one of mis, light, scatter; got {self.light_sampling!r}"
            )
        width, height = self.size
        object.__setattr__(
            self,
            "size",
            (
                checks.whole("film width", width, least=1),
                checks.whole("film height", height, least=1),
            ),
        )
