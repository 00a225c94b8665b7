"""What the scalars look like: transfer functions and surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import checks
from .curves import ColourCurve, Curve

Vector = tuple[float, float, float]


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
