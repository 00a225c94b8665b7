"""What the scalars look like: transfer functions and surfaces."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import checks
from .curves import ColourCurve, Curve
from .recipes.content_hash import INSIDE

Vector = tuple[float, float, float]

SURFACE_MODES = ("hybrid", "brdf", "threshold")
COATS = ("blinn", "ggx")
LARGEST_EXPONENT = 1e6


@dataclass(frozen=True, eq=False)
class TransferTable:
    """Opacity and colour by scalar and gradient magnitude, as vtkVolumeProperty's TF_2D.

    Parameters
    ----------
    rgba : array (gradients, scalars, 4)
        Linear RGB, and opacity per unit distance, [0, 1]. Entries stand at the middles of equal
        intervals, bilinear between them, the outer ones continued.
    scalar_range, gradient_range : (low, high)
        Ends of the first and the last interval; gradient magnitude in scalar per
        `TransferFunction.gradient_distance`.
    """

    rgba: NDArray = field(metadata=INSIDE)
    scalar_range: tuple[float, float]
    gradient_range: tuple[float, float]

    def __post_init__(self) -> None:
        rgba = np.asarray(self.rgba, np.float64)
        if rgba.ndim != 3 or rgba.shape[2] != 4 or not rgba.size:
            raise ValueError(
                f"a transfer table has shape (gradients, scalars, 4), got {rgba.shape}"
            )
        if not (np.isfinite(rgba).all() and rgba.min() >= 0 and rgba.max() <= 1):
            raise ValueError("colours and opacities of a transfer table go from 0 to 1")
        for name in ("scalar_range", "gradient_range"):
            low, high = (checks.number(name, x) for x in getattr(self, name))
            if low >= high:
                raise ValueError(f"{name} goes from low to high, got {low:g} to {high:g}")
        # One row or column is the same everywhere; interpolation needs two
        rgba = rgba.repeat(2 if rgba.shape[0] == 1 else 1, axis=0)
        object.__setattr__(self, "rgba", rgba.repeat(2 if rgba.shape[1] == 1 else 1, axis=1))


@dataclass(frozen=True)
class TransferFunction:
    """Scalar, and gradient magnitude where asked for -> extinction, colour and other channels.

    Parameters
    ----------
    opacity : Curve, optional
        Opacity a per `unit_distance`, [0, 1]: sigma_t = -log1p(-a) / unit_distance. a = 1 is
        capped, see `vtkmcvr.tables.OPAQUE_DEPTH`.
    colour : ColourCurve, optional
        Single-scattering albedo of the volume and diffuse colour of surfaces, linear RGB, [0, 1].
        Needed without `table`.
    unit_distance : float
        World units, > 0.
    extinction : Curve, optional
        Extinction sigma_t in 1/world unit, instead of opacity.
    density_scale : float
        Factor on sigma_t, >= 0.
    table : TransferTable, optional
        Opacity and colour by scalar and gradient magnitude, instead of opacity and colour.
    gradient_opacity : Curve, optional
        Factor on sigma_t by gradient magnitude, [0, 1].
    gradient_distance : float, optional
        World units that gradient magnitudes refer to: scalar per this distance. None: the mean
        spacing of the voxels, as in VTK.
    emission : ColourCurve, optional
        Radiance of the medium's own light over `emission_scale`: the source of a ray is
        sigma_a L_e with sigma_a = (1 - colour) sigma_t, so that an opaque black body shows L_e.
    emission_scale : float
        Radiance, >= 0.
    specular : ColourCurve, optional
        Reflectance of the coat at normal incidence, instead of the Surface's.
    refraction_index : Curve, optional
        Index of refraction n >= 1 of the coat, instead of `specular`: ((n - 1) / (n + 1))^2.
    exponent : Curve, optional
        Exponent of the coat, 0 to 1e6, instead of the Surface's.
    g : Curve, optional
        Mean cosine of the phase function (k of Schlick's), -0.9999 to 0.9999, instead of the
        scene's.
    """

    opacity: Curve | None = None
    colour: ColourCurve | None = None
    unit_distance: float = 1.0
    extinction: Curve | None = None
    density_scale: float = 1.0
    table: TransferTable | None = None
    gradient_opacity: Curve | None = None
    gradient_distance: float | None = None
    emission: ColourCurve | None = None
    emission_scale: float = 1.0
    specular: ColourCurve | None = None
    refraction_index: Curve | None = None
    exponent: Curve | None = None
    g: Curve | None = None

    def __post_init__(self) -> None:
        given = [x for x in (self.opacity, self.extinction, self.table) if x is not None]
        if len(given) != 1:
            raise ValueError(
                "a transfer function takes either opacity or extinction, exactly one "
                f"(or a table instead of both); got {len(given)}"
            )
        if (self.colour is None) == (self.table is None):
            raise ValueError("a transfer function takes a colour, or a table that holds it")
        if self.table is not None and self.gradient_opacity is not None:
            raise ValueError("a table depends on the gradient already: leave out gradient_opacity")
        if self.specular is not None and self.refraction_index is not None:
            raise ValueError("the coat takes either specular or refraction_index, not both")
        checks.number("unit_distance", self.unit_distance, above=0.0)
        checks.number("density_scale", self.density_scale, least=0.0)
        checks.number("emission_scale", self.emission_scale, least=0.0)
        if self.gradient_distance is not None:
            checks.number("gradient_distance", self.gradient_distance, above=0.0)
        _check_curve("extinction", self.extinction, 0.0, np.inf)
        _check_curve("opacity", self.opacity, 0.0, 1.0)
        _check_curve("gradient_opacity", self.gradient_opacity, 0.0, 1.0)
        _check_curve("refraction_index", self.refraction_index, 1.0, np.inf)
        _check_curve("exponent", self.exponent, 0.0, LARGEST_EXPONENT)
        _check_curve("g", self.g, -0.9999, 0.9999)


def _check_curve(name: str, curve: Curve | None, least: float, most: float) -> None:
    if curve is None:
        return
    y = np.array([node[1] for node in curve.nodes])
    if y.min() < least and least == 0:
        raise ValueError(f"{name} must not be negative, got {y.min():g}")
    if y.min() < least or y.max() > most:
        worst = y.min() if y.min() < least else y.max()
        limits = f"is at least {least:g}" if np.isinf(most) else f"goes from {least:g} to {most:g}"
        raise ValueError(f"{name} {limits}, got {worst:g}")


@dataclass(frozen=True)
class Phong:
    """Coefficients by which VTK shades volumes, see vtkVolumeProperty.

    Parameters
    ----------
    ambient, diffuse, specular : float
        Shares, >= 0: colour (ambient + diffuse n.l) + specular (r.v)^power, cut off at 1.
    power : float
        Exponent of the highlight, 0 to 1e6.
    """

    ambient: float = 0.1
    diffuse: float = 0.7
    specular: float = 0.2
    power: float = 10.0

    def __post_init__(self) -> None:
        for name in ("ambient", "diffuse", "specular"):
            checks.number(name, getattr(self, name), least=0.0)
        checks.number("power", self.power, least=0.0, most=LARGEST_EXPONENT)


@dataclass(frozen=True)
class Surface:
    """Hybrid scattering: surfaces where the gradient is strong (Exposure Render, Eq. 1, corrected).

    Without a Surface, everything scatters by the phase function. A surface is the Fresnel blend of
    Ashikhmin and Shirley, diffuse below a coat: reciprocal, never reflecting more than arrives. It
    loses energy, as in the paper, the more the lower the exponent and the flatter the angle, so
    that a white one is darker than white; GGX microfacets lose some too.

    Parameters
    ----------
    gradient_factor : float
        g in P_brdf = opacity (1 - exp(-25 g^3 |grad|/max|grad|)), [0, 1]. 0: no
        surfaces, no gradients.
    mode : {"hybrid", "brdf", "threshold"}
        By that probability; at every collision that has a gradient; or where |grad|/max|grad| is
        above `threshold`.
    opacity_modulated : bool
        Whether P_brdf of "hybrid" has the factor opacity.
    threshold : float
        [0, 1].
    specular : colour
        Reflectance of the glossy coat at normal incidence; 0: plain Lambert.
    exponent : float
        Blinn exponent of the coat, 0 to 1e6.
    coat : {"blinn", "ggx"}
        Distribution of the coat's microfacets; GGX has alpha^2 = 2 / (exponent + 2).
    phong : Phong, optional
        VTK's coefficients, by which technique "emission-absorption" shades instead.
    """

    gradient_factor: float = 0.5
    mode: str = "hybrid"
    opacity_modulated: bool = True
    threshold: float = 0.5
    specular: Vector | float = (0.04, 0.04, 0.04)
    exponent: float = 30.0
    coat: str = "blinn"
    phong: Phong | None = None

    def __post_init__(self) -> None:
        checks.number("gradient_factor", self.gradient_factor, least=0.0, most=1.0)
        checks.number("threshold", self.threshold, least=0.0, most=1.0)
        checks.choice("mode", self.mode, SURFACE_MODES)
        checks.choice("coat", self.coat, COATS)
        if not isinstance(self.phong, Phong | None):
            raise TypeError(f"phong takes a Phong, got {type(self.phong).__name__}")
        specular = checks.colour("specular", self.specular)
        if max(specular) > 1:
            raise ValueError(f"specular goes from 0 to 1, got {specular}")
        checks.number("exponent", self.exponent, least=0.0, most=LARGEST_EXPONENT)
        object.__setattr__(self, "specular", specular)
