"""Lights, and how one of them is chosen."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Matrix, Vector
from .scattering import Gradient


class Ambient(NamedTuple):
    """Environment of constant radiance, or of three colours."""

    radiance: Vector  # everywhere, or at the horizon
    gradient: Gradient | None


class Environment(NamedTuple):
    """Environment map in latitude-longitude form, importance-sampled by radiance."""

    pixels: NDArray[np.float32]  # (rows, columns, 3), row 0 at the local +y pole
    row_cdf: NDArray[np.float32]  # (rows + 1,)
    column_cdf: NDArray[np.float32]  # (rows, columns + 1)
    local_from_world: Matrix
    world_from_local: Matrix


class Present(NamedTuple):
    """Marks that the scene has something; None where it has not."""

    number: np.int32


class Shapes(NamedTuple):
    """Which surfaces of area lights need code beyond that of a flat, distant rectangle."""

    near_rectangles: Present | None  # sampled by solid angle
    disks: Present | None
    spheres: Present | None
    cylinders: Present | None


class LightTextures(NamedTuple):
    """Factors of the radiance over the surfaces of area lights."""

    texels: NDArray[np.float32]  # (texels of all textures, 3)
    layout: NDArray[np.int32]  # (n, 3) first texel, rows, columns; rows 0: no texture


class AreaLights(NamedTuple):
    """Surfaces that emit. They block light, also with their dark side.

    Each one is a canonical surface in the frame of its unit axes u, v, w around its centre; see
    `kernels.shapes`.
    """

    kind: NDArray[np.int32]  # (n,) 0 rectangle, 1 disk, 2 sphere, 3 cylinder
    frame: NDArray[np.float32]  # (n, 4, 3) centre, u, v, w
    size: NDArray[np.float32]  # (n, 3)
    radiance: NDArray[np.float32]  # (n, 3)
    two_sided: NDArray[np.bool_]  # (n,)
    visible: NDArray[np.bool_]  # (n,) camera rays see it
    shapes: Shapes
    textures: LightTextures | None
    seen: Present | None  # some are visible


class DeltaLights(NamedTuple):
    """Directional and point lights, which no scattered ray can hit."""

    kind: NDArray[np.int32]  # (n,) 0 directional, 1 point
    position: NDArray[np.float32]  # (n, 3), point lights
    axis: NDArray[np.float32]  # (n, 3), direction of propagation (of the cone's axis)
    power: NDArray[np.float32]  # (n, 3), irradiance, or intensity in power per steradian
    attenuation: NDArray[np.float32]  # (n, 3), a + b r + c r^2 divides the intensity
    cone: NDArray[np.float32]  # (n, 2), cosine of the cone's half angle, exponent of its falloff


class LightTree(NamedTuple):
    """All lights (area, then delta, then the map) as a binary tree in depth-first order.

    The first child of node k is node k + 1. The tree chooses a light by estimated contribution, and
    finds the area lights that a ray meets.
    """

    bound: NDArray[np.float32]  # (m, 4) sphere around the cluster; radius < 0: no ray meets it
    cone: NDArray[np.float32]  # (m, 5) axis of emission, cosines of its spread and of its reach
    flux: NDArray[np.float32]  # (m,) irradiance, at unit distance where it decays
    within: NDArray[np.float32]  # (m,) irradiance in the volume, on average
    law: NDArray[np.int32]  # (m,) how flux becomes irradiance; see `kernels.light_tree`
    links: NDArray[np.int32]  # (m, 3) next node beyond the cluster, parent, light of a leaf or -1
    leaf: NDArray[np.int32]  # (n,) node of each light


class LightChoice(NamedTuple):
    """How directions toward the lights of the tree are drawn."""

    environment: np.int32  # index of the environment map, -1 without
    by_light: np.bool_  # sample directions by the lights
    by_scatter: np.bool_  # sample directions by the scattering function
