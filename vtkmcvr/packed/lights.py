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


# Along a side of an environment map
MOST_TEXELS = 2**17


class Environment(NamedTuple):
    """Environment map in latitude-longitude form, importance-sampled by radiance."""

    pixels: NDArray[np.float32]  # (rows, columns, 3), row 0 at the local +y pole
    row_cdf: NDArray[np.float32]  # (rows + 1,)
    column_cdf: NDArray[np.float32]  # (rows, columns + 1)
    row_edge: NDArray[np.float32]  # (rows + 1,) cosine of the angle from the pole
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


class AreaLight(NamedTuple):
    """A surface that emits: a canonical one in the frame of its unit axes u, v, w.

    See `kernels.shapes`.
    """

    kind: np.int32  # 0 rectangle, 1 disk, 2 sphere, 3 cylinder
    centre: Vector
    u: Vector
    v: Vector
    w: Vector
    size: Vector
    radiance: Vector
    two_sided: np.bool_
    visible: np.bool_  # camera rays see it


class LightRows(NamedTuple):
    """Surfaces that emit, as tables; see `AreaLight`."""

    kind: NDArray[np.int32]  # (n,)
    frame: NDArray[np.float32]  # (n, 4, 3) centre, u, v, w
    size: NDArray[np.float32]  # (n, 3)
    radiance: NDArray[np.float32]  # (n, 3)
    two_sided: NDArray[np.bool_]  # (n,)
    visible: NDArray[np.bool_]  # (n,)


class AreaLights(NamedTuple):
    """Surfaces that emit. They block light, also with their dark side.

    A few are values, for which kernels read no memory; black ones make up their number.
    """

    number: np.int32
    few: tuple[AreaLight, ...] | None
    many: LightRows | None
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


class LightNode(NamedTuple):
    """A light as it is chosen, or a cluster of them."""

    centre: Vector  # of a sphere around the cluster
    radius: np.float32  # of that sphere; < 0: no ray meets it
    axis: Vector  # of emission
    spread: np.float32  # cosine of the largest angle between the axis and a light's own axis
    reach: np.float32  # cosine of the largest angle to its own axis under which a light emits
    flux: np.float32  # irradiance, at unit distance where it decays
    within: np.float32  # irradiance in the volume, on average
    law: np.int32  # how flux becomes irradiance; see `kernels.light_tree`


class LightTree(NamedTuple):
    """Many lights as a binary tree in depth-first order: see `LightNode`.

    The first child of node k is node k + 1. The tree chooses a light by estimated contribution, and
    finds the area lights that a ray meets.
    """

    bound: NDArray[np.float32]  # (m, 4) centre and radius
    cone: NDArray[np.float32]  # (m, 5) axis, spread, reach
    flux: NDArray[np.float32]  # (m,)
    within: NDArray[np.float32]  # (m,)
    law: NDArray[np.int32]  # (m,)
    links: NDArray[np.int32]  # (m, 3) next node beyond the cluster, parent, light of a leaf or -1
    leaf: NDArray[np.int32]  # (n,) node of each light


class LightSet(NamedTuple):
    """All lights (area, then delta, then the map), to choose from.

    Of a few, each is asked; black ones make up their number.
    """

    number: np.int32
    few: tuple[LightNode, ...] | None
    tree: LightTree | None


class LightChoice(NamedTuple):
    """How directions toward the lights are drawn."""

    environment: np.int32  # index of the environment map, -1 without
    by_light: np.bool_  # sample directions by the lights
    by_scatter: np.bool_  # sample directions by the scattering function
