"""How light is scattered and tracked."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .basics import Matrix, Vector


class Surface(NamedTuple):
    """Hybrid surface/volume scattering: where and how often a BRDF replaces the phase function."""

    mode: np.int32  # 0 hybrid by Eq. 1, 1 BRDF at every gradient, 2 above a threshold
    opacity_distance: np.float32  # of sigma_t in the opacity that P_brdf is proportional to; inf: 1
    world_from_index_gradient: Matrix
    per_gradient: np.float32  # 1 / largest gradient magnitude
    exponent_scale: np.float32  # 25 g^3, with g the gradient factor
    threshold: np.float32  # of the normalised gradient magnitude


class Gloss(NamedTuple):
    """Specular coat of surfaces: the glossy part of the Fresnel blend."""

    specular: Vector  # reflectance at normal incidence
    exponent: np.float32  # Blinn exponent; the GGX roughness is sqrt(2 / (exponent + 2))
    ggx: np.bool_  # GGX distribution of microfacets instead of Blinn's


class NormalMap(NamedTuple):
    """The film records the normal at the first collision, and so needs a gradient there."""

    world_from_index_gradient: Matrix


class Phase(NamedTuple):
    """Phase function other than isotropic."""

    kind: np.int32  # 0 Henyey-Greenstein, 1 Schlick, 2 Rayleigh, 3 cone
    shape: np.float32  # g; k; nothing; 1 - cosine of the cone's half angle


class Scattering(NamedTuple):
    """Multiple scattering."""

    most: np.int32  # scattering events of a path
    roulette: np.float32  # throughput below which Russian roulette may end the path


class Marching(NamedTuple):
    """Collisions by marching in equal steps, which is biased, instead of by tracking."""

    step: np.float32  # world units


class Shadows(NamedTuple):
    """Light is attenuated on its way to the scattering point."""

    reach: np.float32  # world units from the scattering point within which the medium attenuates


class RatioTracking(NamedTuple):
    """Transmittance by ratio tracking instead of a binary estimate."""

    roulette: np.float32  # transmittance below which Russian roulette ends the walk


class Gradient(NamedTuple):
    """Radiance that changes linearly with the angle of elevation."""

    up: Vector
    top: Vector
    bottom: Vector
