"""All that a sample of a pixel needs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .backdrop import Backdrop
from .basics import Matrix64, Vector64
from .camera import Camera, Lens, Sobol
from .geometry import Mesh, Receivers
from .lights import Ambient, AreaLights, DeltaLights, Environment, LightChoice, LightSet
from .scattering import (
    Gloss,
    Marching,
    NormalMap,
    Phase,
    RatioTracking,
    Scattering,
    Shadows,
    Surface,
)
from .volume import Medium, Transfer


class Layer(NamedTuple):
    """Another volume in the same place; extinctions add."""

    medium: Medium
    transfer: Transfer
    surface: Surface | None
    gloss: Gloss | None
    index_from_world: Matrix64  # directions
    index_of_centre: Vector64  # index position, in this volume, of the first volume's centre


class Scene(NamedTuple):
    """Everything a sample of a pixel needs."""

    medium: Medium
    transfer: Transfer
    camera: Camera
    lens: Lens | None
    surface: Surface | None
    gloss: Gloss | None
    phase: Phase | None
    scattering: Scattering | None
    marching: Marching | None
    shadows: Shadows | None
    ratio: RatioTracking | None
    ambient: Ambient | None
    environment: Environment | None
    area_lights: AreaLights | None
    delta_lights: DeltaLights | None
    all_lights: LightSet | None
    choice: LightChoice | None
    environment_visible: np.bool_
    normal_map: NormalMap | None
    sobol: Sobol | None
    receivers: Receivers | None
    mesh: Mesh | None
    more: tuple[Layer, ...] | None
    backdrop: Backdrop | None
