"""Layers across the view axis, on a raster of pixels that may reach beyond the film."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..kernels.cone_layers import SEGMENT
from ..pack import f32, vector
from ..plan import Plan
from .medium import Filled

# Occluders are looked for this far beside the film, in shares of its longer side
MARGIN = 0.5
# Depth of the first plane for an eye inside the volume, in layers; rays of a parallel view do not
# meet in an eye
NEAREST = 0.25
# Tangent of view rays over which secants go evenly, with errors of an eighth of its square
STRAIGHT = 0.06


@dataclass(frozen=True, eq=False)
class Raster:
    """Where layers and pixels lie.

    Attributes
    ----------
    camera : packed.Camera
    left, top, columns, rows : int
        Rectangle of pixels that is worked on, in film pixels; may reach beyond the film or cover
        a part of it. A whole number of segments wide.
    near, thickness : float
        Depth of the first plane from the eye along the view axis, and of a layer, world units.
    count : int
        Number of layers.
    pitch : float
        Size of a pixel: world units (parallel), or world units per unit of depth (perspective).
    parallel : bool
    eye_column, eye_row : float
        Film position of the view axis.
    film : (width, height)
        Pixels of the film.
    """

    camera: packed.Camera
    left: int
    top: int
    columns: int
    rows: int
    near: float
    thickness: float
    count: int
    pitch: float
    parallel: bool
    eye_column: float
    eye_row: float
    film: tuple[int, int]

    @property
    def far(self) -> float:
        """Depth of the last plane."""
        return self.near + self.count * self.thickness

    @property
    def pixel(self) -> float:
        """Size of a pixel half way through, world units."""
        return self.pitch if self.parallel else self.pitch * (self.near + self.far) / 2

    @property
    def obliqueness(self) -> float:
        """Largest tangent between a view ray and the view axis."""
        if self.parallel:
            return 0.0
        first = np.maximum((self.left, self.top), 0)
        last = np.minimum((self.left + self.columns, self.top + self.rows), self.film)
        eye = np.array((self.eye_column, self.eye_row))
        return float(np.linalg.norm(np.maximum(np.abs(first - eye), np.abs(last - eye)))) * (
            self.pitch
        )

    @property
    def perspective(self) -> packed.Perspective | None:
        """What makes rays oblique, for kernels."""
        if self.parallel:
            return None
        span = int(np.clip(STRAIGHT / (self.pitch * SEGMENT), 1, 16)) * SEGMENT
        return packed.Perspective(
            f32(self.eye_column - self.left), f32(self.eye_row - self.top), f32(self.pitch),
            np.int64(span),
        )  # fmt: skip

    @property
    def slants(self) -> NDArray[np.float32] | None:
        """Secants and cosines of view rays in perspective, (rows, n, 2).

        At the middle of every row's first pixel of a segment, and beyond the last for a span more.
        """
        perspective = self.perspective
        if perspective is None:
            return None
        first = np.arange(0, self.columns + int(perspective.span) + 1, SEGMENT)
        x = (first + 0.5 - perspective.eye_column) * self.pitch
        y = (np.arange(self.rows) + 0.5 - perspective.eye_row) * self.pitch
        secant = np.sqrt(1 + x**2 + y[:, None] ** 2)
        return np.stack([secant, 1 / secant], axis=-1).astype(f32)

    def block(self, first: int, volume: Filled) -> packed.LayerBlock:
        """Positions in a volume from layer `first` on, for kernels; computed in float64."""
        m, centre = volume.index_from_world, volume.index_of_centre
        z = self.near + first * self.thickness
        o, ox, oy, d, dx, dy = (m @ np.array(v) for v in self.camera[:6])
        start = o + self.left * ox + self.top * oy
        deep = d + self.left * dx + self.top * dy
        return packed.LayerBlock(
            vector(centre + start + z * deep), vector(ox + z * dx), vector(oy + z * dy),
            vector(deep), vector(dx), vector(dy), f32(self.thickness), f32(z),
        )  # fmt: skip

    def spread(self, depth: NDArray) -> NDArray:
        """Pixels by which a beam of unit sideways measure lies off at a depth.

        Straight beams move evenly with -depth in a parallel view, with 1/depth in a perspective
        one.
        """
        if self.parallel:
            return -(depth - self.near) / self.pitch
        return (1 / depth - 1 / self.near) / self.pitch


def raster_of(plan: Plan, layer: float, margin: float = MARGIN) -> Raster:
    """Raster and layers that hold all of the volume's medium in view.

    Parameters
    ----------
    plan : Plan
        Of a scene whose film has the raster's pixels.
    layer : float
        Thickness of a layer, world units.
    margin : float
        How far occluders beside the film count, in shares of its longer side.
    """
    camera, (width, height) = plan.packed.camera, plan.scene.size
    parallel = plan.scene.camera.parallel_scale is not None
    right, up, forward = plan.scene.camera.frame
    axes = np.array([right, -up, forward])
    pitch = float(np.linalg.norm(camera.origin_x if parallel else camera.direction_x))
    if plan.empty:
        return _nothing(plan, parallel, pitch, layer)
    points = (plan.corners - plan.scene.volume.centre - np.array(camera.origin)) @ axes.T
    heading = axes @ np.array(camera.direction)
    depth = points[:, 2]
    near = max(float(depth.min()), 0.0 if parallel else NEAREST * layer)
    count = max(0, math.ceil((float(depth.max()) - near) / layer))
    if parallel:
        film = (points - depth[:, None] * heading)[:, :2] / pitch
        eye = np.zeros(2)
    else:
        film = (points[:, :2] / np.maximum(depth, near)[:, None] - heading[:2]) / pitch
        eye = -heading[:2] / pitch
    most = margin * max(width, height)
    lo, hi = np.full(2, -most), np.array([width, height]) + most
    if parallel or depth.min() >= near:
        lo, hi = np.maximum(lo, film.min(0)), np.minimum(hi, film.max(0))
    left, top = (math.floor(v) for v in lo)
    columns, rows = (max(math.ceil(b) - math.floor(a), 0) for a, b in zip(lo, hi, strict=True))
    columns = -(-columns // SEGMENT) * SEGMENT
    return Raster(
        camera, left, top, columns, rows, near, layer, count if columns and rows else 0,
        pitch, parallel, float(eye[0]), float(eye[1]),
        (width, height),
    )  # fmt: skip


def _nothing(plan: Plan, parallel: bool, pitch: float, layer: float) -> Raster:
    """Raster of a scene without any medium."""
    return Raster(
        plan.packed.camera, 0, 0, 0, 0, layer, layer, 0, pitch, parallel, 0.0, 0.0, plan.scene.size
    )
