"""Directions of light inside a cone, and how they move over the raster from layer to layer."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..pack import f32, vector
from .raster import Raster

GOLDEN = math.pi * (3 - math.sqrt(5))
# Even spread over the unit square (Roberts's R2 sequence)
PLASTIC = np.array((0.7548776662466927, 0.5698402909980532))
# Light comes in at most this oblique to the view axis, as a tangent; beyond it only its path gets
# longer.
STEEPEST = 8.0
# View rays and directions of light are taken to this angle from the view axis, radians
WIDEST = math.radians(86.0)
# Depths, farthest over nearest, over which directions are spread; nearer ones get fewer
MOST_RATIO = 16.0
# Cone, radians, that is a single direction; directions in the narrowest one of several
NARROWEST, FEW = 1e-3, 6.0
# Pixels that a beam may move sideways at a time; or layers, where pixels are much finer than these:
# a view through a keyhole takes no more steps than any other
STRIDE, LAYERS_STRIDE = 1.5, 0.25


@dataclass(frozen=True, eq=False)
class Beams:
    """Directions of light.

    Attributes
    ----------
    cone : packed.Cone
    sideways : (n, 2) float64
        Toward light, columns and rows: tangent (parallel), or tangent times depth (perspective).
    weight : (n,) float64
    """

    cone: packed.Cone
    sideways: NDArray[np.float64]
    weight: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.weight)

    def routes(self, raster: Raster) -> list[Route]:
        """How the raster of each beam moves from layer to layer."""
        planes = raster.near + raster.thickness * np.arange(raster.count + 1)
        moves = np.diff(raster.spread(planes))
        along = np.linalg.norm(self.sideways, axis=1)
        per_depth = np.ones(raster.count) if raster.parallel else 1 / planes[1:]
        tangent = along[:, None] * per_depth
        share = np.minimum(1.0, STEEPEST / np.maximum(tangent, 1e-30))
        steps = self.sideways[:, None, ::-1] * (moves * share)[..., None]
        # Beams are rounded to pixels at different places, which evens the errors out
        phase = (np.arange(len(self))[:, None] * PLASTIC + 0.5) % 1
        pixel = raster.pitch / per_depth
        stride = np.maximum(STRIDE, LAYERS_STRIDE * raster.thickness / pixel)
        return [_route(*each, stride) for each in zip(steps, phase, strict=True)]


@dataclass(frozen=True, eq=False)
class Route:
    """Whole pixels by which a beam's raster has moved.

    Whole ones, so that a ray which passes through a pixel of one layer passes through pixels of
    all layers: what the eye sees and what shades it are the same points.

    Attributes
    ----------
    places : (n, 2) int64
        Rows, columns: for each layer, in each of the parts in which it is crossed.
    first : (layers + 1,) int64
        Where a layer's places start.
    """

    places: NDArray[np.int64]
    first: NDArray[np.int64]


def _route(steps: NDArray, phase: NDArray, stride: NDArray) -> Route:
    """Straight way over the raster, rounded at each place; layers in strides of some pixels."""
    parts = np.maximum(1, np.ceil(np.abs(steps).max(axis=1) / stride)).astype(np.int64)
    before = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])[:-1]
    first = np.concatenate([[0], np.cumsum(parts)])
    layer = np.repeat(np.arange(len(parts)), parts)
    along = (np.arange(first[-1]) - first[layer] + 0.5) / parts[layer]
    places = np.floor(before[layer] + steps[layer] * along[:, None] + phase)
    return Route(places.astype(np.int64), first.astype(np.int64))


def beams_of(
    raster: Raster, half_angle: float, count: int, axis: tuple[float, float, float] | None
) -> Beams:
    """Evenly spread directions (Vogel 1979) that fill the cone at every depth and pixel.

    Parameters
    ----------
    half_angle : float
        Radians, [0, pi/2).
    axis : (columns, rows, toward the viewer), optional
        Unit vector. None: every pixel's own view ray.
    """
    cosine = math.cos(half_angle)
    if half_angle == 0 and axis is None:
        count = 1
    if raster.parallel:
        aim = np.array((0.0, 0.0, 1.0) if axis is None else axis)
        directions = _turned(_spiral(cosine, count), aim)
        directions = directions[directions[:, 2] > 0.02]
        sideways = directions[:, :2] / directions[:, 2:]
        # All inside: an edge of no width
        cone = packed.Cone(vector(aim), np.bool_(axis is None), f32(-2.0), f32(1.0))
        return Beams(cone, sideways, np.ones(len(sideways)))
    return _perspective_beams(raster, half_angle, count, axis)


def _perspective_beams(
    raster: Raster, half_angle: float, count: int, axis: tuple[float, float, float] | None
) -> Beams:
    """Beams through points of the eye's plane, spread so that every depth has its share.

    From depth z a point at distance m from the eye lies at tangent m / z to the view ray. The
    radial density is the mean of those that would be even in solid angle at several depths.
    """
    if half_angle < NARROWEST and axis is None:
        # The eye itself
        cone = packed.Cone(vector(np.array((0.0, 0.0, 1.0))), np.bool_(True), f32(-2.0), f32(1.0))
        return Beams(cone, np.zeros((1, 2)), np.ones(1))
    if axis is not None:
        half_angle = max(half_angle, narrowest_cone(raster, count, axis))
    opening = 1 - math.cos(half_angle)
    edge = opening * min(0.5, 2 / math.sqrt(count))
    wide = raster.obliqueness
    reach = math.acos(max(math.cos(half_angle) - edge, -1.0))
    if axis is None:
        tangent = math.tan(min(math.atan(wide) + reach, WIDEST)) - wide
        tangent = max(tangent, math.tan(min(reach, WIDEST)))
    else:
        tangent = math.tan(min(math.acos(min(axis[2], 1.0)) + reach, WIDEST)) + wide
    depths = np.geomspace(max(raster.near, raster.far / MOST_RATIO), raster.far, 8)
    m, density = _radial(tangent, depths, count)
    turn = np.arange(len(m)) * GOLDEN
    sideways = m[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    aim = np.array((0.0, 0.0, 1.0) if axis is None else axis)
    cone = packed.Cone(
        vector(aim), np.bool_(axis is None), f32(math.cos(half_angle)),
        f32(1 / max(edge, 1e-7)),
    )  # fmt: skip
    return Beams(cone, sideways, density.max() / density)


def narrowest_cone(raster: Raster, count: int, axis: tuple[float, float, float]) -> float:
    """Half angle, radians, at which a cone around a fixed axis still holds a few directions.

    In a perspective view the directions are spread over all that the cone is for any pixel.
    """
    if raster.parallel:
        return 0.0
    widest = min(math.atan(raster.obliqueness) + math.acos(min(axis[2], 1.0)), WIDEST)
    return math.acos(1 - min(FEW / count, 1.0) * (1 - math.cos(widest)))


def _radial(tangent: float, depths: NDArray, count: int) -> tuple[NDArray, NDArray]:
    """Radii in the eye's plane, and the density of points per area there."""
    grid = depths[-1] * np.concatenate([[0.0], np.geomspace(1e-4 * tangent, tangent, 2048)])
    t = np.minimum(grid / depths[:, None], tangent)
    whole = 1 - 1 / math.hypot(1.0, tangent)
    cdf = np.mean((1 - 1 / np.hypot(1.0, t)) / whole, axis=0)
    m = np.interp((np.arange(count) + 0.5) / count, cdf, grid)
    t = m / depths[:, None]
    inside = np.where(t <= tangent, (1 + t * t) ** -1.5 / depths[:, None] ** 2, 0.0)
    return m, np.mean(inside, axis=0)


def _spiral(cosine: float, count: int) -> NDArray[np.float64]:
    """Unit vectors evenly spread in solid angle around +z down to a cosine."""
    i = np.arange(count)
    z = 1 - (i + 0.5) / count * (1 - cosine)
    r = np.sqrt(np.maximum(1 - z * z, 0))
    return np.stack([r * np.cos(i * GOLDEN), r * np.sin(i * GOLDEN), z], axis=1)


def _turned(directions: NDArray, axis: NDArray) -> NDArray:
    """Directions around +z, turned to be around a unit axis."""
    helper = np.array((1.0, 0, 0)) if abs(axis[0]) < 0.9 else np.array((0, 1.0, 0))
    a = np.cross(helper, axis)
    a /= np.linalg.norm(a)
    return directions @ np.array([a, np.cross(axis, a), axis])
