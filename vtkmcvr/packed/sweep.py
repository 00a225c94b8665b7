"""A sweep of light and view through layers; see `vtkmcvr.occlusion`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .basics import Vector
from .layers import Perspective
from .scattering import Surface


class Cone(NamedTuple):
    """Cone of light, in the frame (columns, rows, toward the viewer)."""

    axis: Vector
    around_view: np.bool_  # the axis is every pixel's own view ray
    cosine: np.float32
    per_cosine: np.float32  # sharpness of its edge


class Beam(NamedTuple):
    """Rays toward light of one direction."""

    sideways_x: np.float32  # world units per unit of depth; perspective: times depth
    sideways_y: np.float32
    weight: np.float32


class Shade(NamedTuple):
    """Gradient shading of what the eye sees: Lambert and Blinn, light along the cone's axis."""

    surface: Surface
    toward_light: Vector  # world
    headlight: np.bool_  # the light is where the eye is, for each pixel
    right: Vector  # of the film, in the world
    down: Vector
    forward: Vector
    specular: Vector
    exponent: np.float32
    strength: np.float32  # 1: shaded; 0: normals only


class OcclusionFilm(NamedTuple):
    """Sums per pixel, [row, column]."""

    radiance: NDArray[np.float32]  # (h, w, 3)
    alpha: NDArray[np.float32]
    depth: NDArray[np.float32]  # distance from the eye times opacity
    share: NDArray[np.float32]  # opacity of the medium as light meets it
    albedo: NDArray[np.float32] | None  # (h, w, 3) times that opacity
    normal: NDArray[np.float32] | None  # (h, w, 3) world normal times that opacity


class Sheets(NamedTuple):
    """Two blocks of layers on a device, [which of them, ...]: one is filled, one is lit."""

    depth: NDArray[np.float32]  # [which, layer, row, column], as in `Layers`
    whole: NDArray[np.float32]
    tinted: NDArray[np.float32] | None  # [which, colour, layer, row, column]
    mixed: NDArray[np.float32] | None
    front: NDArray[np.float32]
    back: NDArray[np.float32]
    filled: NDArray[np.uint8]  # [which, layer, row, segment] 2: filled
    occupied: NDArray[np.uint8]  # [which, tile row, segment] 1: filled in any layer
    # Of the block that is lit
    seen: NDArray[np.float32]  # [layer, row, column]
    relief: NDArray[np.float32] | None
    visible: NDArray[np.uint8]  # [layer, row, segment] 0: not seen; 1: faint; 2


class Sweep(NamedTuple):
    """What is the same for all blocks of layers on a device."""

    perspective: Perspective | None
    edges: NDArray[np.int64]  # (4,) first column and row, end column and row of what the eye sees
    layers: np.int64  # how many there are in all
    bleeding: np.float32
    opaque: np.float32
    limited: np.bool_
    tiers: np.bool_
    skip: np.bool_


class BeamTable(NamedTuple):
    """Beams on a device: how they move, and what their rays have met."""

    cone: Cone
    table: NDArray[np.float32]  # (n, 3) sideways measures and weight
    order: NDArray[np.int32]  # (n,) in which they are summed
    few: np.int64  # how many of these light what is faint
    zooms: NDArray[np.float32]  # [layer] inverse of the depth, 1 in a parallel view
    places: NDArray[np.int32]  # (m, 2) rows, columns: see `trace_beams`
    first: NDArray[np.int32]  # (n, layers + 1) where a layer's places start
    middle: NDArray[np.int32]  # [beam, layer, 2] place half way through a layer
    # [beam, block, 4] last place before a block, and what is added to a pixel there to get where
    # its ray is kept, modulo rows and columns
    behind: NDArray[np.int32]
    buffers: NDArray[np.float32]  # [beam, colour, row, column] optical depth met before the block


class BlurTable(NamedTuple):
    """Light in one buffer per colour on a device, blurred between layers."""

    kappa: np.float32  # optical depth of the cone's mean path over that of its axis
    widths: NDArray[np.float32]  # [layer] window of the blur behind it, pixels; 0: none
    missing: NDArray[np.float32]  # [colour, row, column]
    other: NDArray[np.float32]


class PublishedTable(NamedTuple):
    """The occlusion buffer of the paper on a device."""

    points: NDArray[np.float32]  # [layer, sample, 2] offsets in rows and columns
    secants: NDArray[np.float32]  # [sample]
    exact: np.bool_
    missing: NDArray[np.float32]  # [before or behind, row, column], by turns


class SweptLight(NamedTuple):
    """How light goes through layers on a device: one of these."""

    beams: BeamTable | None
    blurred: BlurTable | None
    published: PublishedTable | None
