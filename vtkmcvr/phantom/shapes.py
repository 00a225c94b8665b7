"""Signed distance fields on broadcast grids: what the head phantom is modelled with.

A distance is in mm, negative inside. Every shape is evaluated only in the window of the grid
around its own box, so a tooth costs what a tooth occupies.

The shapes and the smooth union are those of Inigo Quilez, "Distance functions"
(https://iquilezles.org/articles/distfunctions/): the ellipsoid is the usual first-order bound,
exact on its surface; the tapered capsule takes the radius that is linear along its axis.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import reduce
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Point = tuple[float, float, float]
Field = NDArray[np.float32]
Window = tuple[slice, slice, slice]

FAR = 60.0
REACH = 12.0


class Grid(NamedTuple):
    """Open axes of a block of voxels: `x` is (1, 1, i), `y` is (1, j, 1), `z` is (k, 1, 1)."""

    x: Field
    y: Field
    z: Field

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels in the order of the array: k, j, i."""
        return self.z.size, self.y.size, self.x.size

    def window(self, low: Point, high: Point, reach: float) -> Window | None:
        """Return where the box grown by `reach` lies in this grid, None where it does not."""
        spans = []
        for axis, a, b in zip((self.z, self.y, self.x), low[::-1], high[::-1], strict=True):
            start, stop = np.searchsorted(axis.ravel(), (a - reach, b + reach))
            if start == stop:
                return None
            spans.append(slice(int(start), int(stop)))
        return spans[0], spans[1], spans[2]

    def part(self, window: Window) -> Grid:
        """Return the grid of a window."""
        k, j, i = window
        return Grid(self.x[:, :, i], self.y[:, j], self.z[k])


class Shape(Protocol):
    """A solid with a box and a signed distance."""

    def box(self) -> tuple[Point, Point]:
        """Return the low and the high corner in mm."""

    def distance(self, grid: Grid) -> Field:
        """Return the signed distance in mm at each voxel."""


class Ellipsoid(NamedTuple):
    """Ellipsoid with radii in mm, turned about z by `turn` degrees (x axis towards y)."""

    centre: Point
    radii: Point
    turn: float = 0.0

    def box(self) -> tuple[Point, Point]:
        """Return the corners: of the turned ellipsoid's enclosing upright cylinder."""
        wide = max(self.radii[:2])
        x, y = (wide, wide) if self.turn else self.radii[:2]
        (cx, cy, cz), z = self.centre, self.radii[2]
        return (cx - x, cy - y, cz - z), (cx + x, cy + y, cz + z)

    def distance(self, grid: Grid) -> Field:
        """Return the distance, exact on the surface and along the axes."""
        axes = _turned(grid, self.centre, self.turn)
        u, v, w = ((a / r) ** 2 for a, r in zip(axes, self.radii, strict=True))
        a, b, c = (s / r**2 for s, r in zip((u, v, w), self.radii, strict=True))
        inside = np.sqrt(u + v + w)
        slope = np.sqrt(a + b + c + np.float32(1e-12))
        return inside * (inside - 1) / slope


def ball(centre: Point, radius: float) -> Ellipsoid:
    """Return a sphere."""
    return Ellipsoid(centre, (radius, radius, radius))


class Chain(NamedTuple):
    """Capsules from point to point, with a radius in mm for each point or one for all.

    Along a link the radius goes linearly from one point's to the next one's.
    """

    points: Sequence[Point]
    radii: float | Sequence[float]

    def box(self) -> tuple[Point, Point]:
        """Return the corners of the points grown by the largest radius."""
        r = max(self._radii())
        (x, a), (y, b), (z, c) = ((min(p) - r, max(p) + r) for p in zip(*self.points, strict=True))
        return (x, y, z), (a, b, c)

    def distance(self, grid: Grid) -> Field:
        """Return the distance to the nearest link."""
        links = zip(pairwise(self.points), pairwise(self._radii()), strict=True)
        return reduce(np.minimum, (_link(grid, a, b, r, s) for (a, b), (r, s) in links))

    def _radii(self) -> Sequence[float]:
        if isinstance(self.radii, int | float):
            return [self.radii] * len(self.points)
        return self.radii


class Box(NamedTuple):
    """Box with half sizes in mm and rounded edges, turned about z by `turn` degrees."""

    centre: Point
    half: Point
    edge: float
    turn: float = 0.0

    def box(self) -> tuple[Point, Point]:
        """Return the corners: of the turned box's enclosing upright cylinder."""
        wide = math.hypot(*self.half[:2])
        return Ellipsoid(self.centre, (wide, wide, self.half[2])).box()

    def distance(self, grid: Grid) -> Field:
        """Return the distance to the rounded box."""
        axes = _turned(grid, self.centre, self.turn)
        u, v, w = (np.abs(a) - (h - self.edge) for a, h in zip(axes, self.half, strict=True))
        inner = np.minimum(np.maximum(np.maximum(u, v), w), 0)
        square = (np.maximum(u, 0) ** 2 + np.maximum(v, 0) ** 2) + np.maximum(w, 0) ** 2
        return np.sqrt(square) + inner - self.edge


Tissue = tuple[str, float, Shape]


class Part(NamedTuple):
    """A named step of a sculpture: a shape joined, or carved out, with a fillet of `blend` mm."""

    name: str
    shape: Shape
    blend: float = 0.0
    carve: bool = False


def _link(grid: Grid, a: Point, b: Point, radius: float, end_radius: float) -> Field:
    px, py, pz = grid.x - a[0], grid.y - a[1], grid.z - a[2]
    dx, dy, dz = (q - p for p, q in zip(a, b, strict=True))
    length = dx * dx + dy * dy + dz * dz
    dot = (px * dx + py * dy) + pz * dz
    along = np.clip(dot / length, 0, 1)
    square = (px * px + py * py) + pz * pz + along * (along * length - 2 * dot)
    return np.sqrt(np.maximum(square, 0)) - (radius + along * (end_radius - radius))


def _turned(grid: Grid, centre: Point, turn: float) -> tuple[Field, Field, Field]:
    x, y, z = grid.x - centre[0], grid.y - centre[1], grid.z - centre[2]
    if not turn:
        return x, y, z
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    return x * c + y * s, y * c - x * s, z


def smooth_minimum(a: Field, b: Field, blend: float) -> Field:
    """Return the union of two distances with a fillet of `blend` mm (quadratic polynomial)."""
    least = np.minimum(a, b)
    if blend:
        near = np.maximum(blend - np.abs(a - b), 0)
        least -= near * near * (0.25 / blend)
    return least


def sculpt(parts: Iterable[Part], grid: Grid, start: Field | None = None) -> Field:
    """Return the distance to the parts joined to `start`, or carved out, in their order.

    Away from all of them it is `FAR`.
    """
    field = np.full(grid.shape, FAR, np.float32) if start is None else start.copy()
    for part in parts:
        window = grid.window(*part.shape.box(), REACH + part.blend)
        if window is None:
            continue
        distance = part.shape.distance(grid.part(window))
        old = field[window]
        if part.carve:
            field[window] = -smooth_minimum(-old, distance, part.blend)
        else:
            field[window] = smooth_minimum(old, distance, part.blend)
    return field


def cover(distance: Field, edge: float) -> Field:
    """Return the share of a voxel inside a surface, for an edge `edge` mm wide."""
    t = np.clip(0.5 - distance / edge, 0, 1)
    return t * t * (3 - 2 * t)
