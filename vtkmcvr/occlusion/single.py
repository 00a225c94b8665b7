"""Fast and paper modes: one buffer of light, filtered from layer to layer."""

from __future__ import annotations

import itertools
import math
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from ..kernels.cone_single import blurred_layers, published_read, published_update
from ..pack import f32
from .raster import Raster
from .sweep import Block


def half_space_value(half_angle: float) -> float:
    """Radiance of a homogeneous, scattering half-space under a cone of unit light (HC-83).

    1 - ln(2 / (1 + c)) / (1 - c) with c the cosine of the half angle in radians; 1/2 at angle 0.
    """
    width = 2 * math.sin(half_angle / 2) ** 2
    if width < 1e-6:
        return 0.5 - width / 8
    return 1 + math.log1p(-width / 2) / width


# Layers wait until the blur between them has this variance, pixels squared
BLUR = 4.0


def mean_path(half_angle: float) -> float:
    """Path of the cone's light through a layer over the layer's thickness: exact half-space."""
    return 1 / half_space_value(half_angle) - 1


class Blurred:
    """Light of the whole cone in one buffer, blurred between layers (mode "fast").

    The blur's variance grows with the distance passed and the cone's spread, whatever the number of
    layers, and equals that of the cone at the distance `reach` from an occluder: nearer shadows are
    too soft, farther ones too sharp, as in any repeated blur (HC-80).

    Parameters
    ----------
    raster : Raster
    half_angle : float
        Radians.
    reach : float
        World units.
    colours : int
        1, or 3 for coloured light.
    """

    groups = 1
    tiers = relief = False

    def __init__(self, raster: Raster, half_angle: float, reach: float, colours: int):
        self.raster, self.colours = raster, colours
        self.kappa = mean_path(half_angle)
        # Half of the cone's solid angle lies within this tangent
        middle = math.acos((1 + math.cos(half_angle)) / 2)
        self.variance = math.tan(middle) ** 2 / 2 * reach * raster.thickness
        self.pending = 0.0
        self.missing = np.zeros((colours, raster.rows, raster.columns), f32)
        self.other = np.zeros_like(self.missing)
        self.running = np.zeros((colours, 2, raster.columns), f32)
        # Where anything is missing: nowhere
        self.part = np.array([[raster.rows, 0, raster.columns, 0]] * colours)

    def through(
        self, block: Block, sums: NDArray, weights: NDArray, slots: int, pool: ThreadPoolExecutor
    ) -> list[Future[None]]:
        """Begin to take the light through a block of layers, each colour in one go.

        While it goes on, other threads fill the next block: nobody waits for parts of a blur.
        """
        weights[:] = 1
        widths = np.array([self._width(block.start + i) for i in range(block.size)], f32)
        return [
            pool.submit(self._colour, block, c, widths, sums[0, c]) for c in range(self.colours)
        ]

    def _colour(self, block: Block, c: int, widths: NDArray, light: NDArray) -> None:
        layers = block.layers
        blurred_layers(
            self.raster.perspective, f32(self.kappa), self.missing[c], self.other[c],
            self.running[c], self.part[c], layers.depth, layers.depth if layers.tinted is None else
            layers.tinted[c], block.filled, block.visible, widths, light,
        )  # fmt: skip

    def _width(self, number: int) -> float:
        """Window of the blur behind a layer, of the variance that waits; 0: not yet."""
        self.pending += self.variance_at(number)
        if self.pending < BLUR:
            return 0.0
        width = min(math.sqrt(1 + 12 * self.pending), 2.0 * max(self.missing.shape[1:]))
        self.pending = 0.0
        return width

    def variance_at(self, number: int) -> float:
        """Variance of the blur behind a layer, pixels squared."""
        raster = self.raster
        pitch = raster.pitch
        if not raster.parallel:
            pitch *= raster.near + (number + 1) * raster.thickness
        return self.variance / pitch**2


def _strips(length: int, count: int = 4) -> list[tuple[int, int]]:
    """Parts of rows or columns."""
    edges = np.linspace(0, length, count + 1).astype(int).tolist()
    return list(itertools.pairwise(edges))


class Published:
    """The occlusion buffer of the paper (mode "paper"), with its grid of samples.

    Parameters
    ----------
    raster : Raster
    half_angle : float
        Radians.
    grid : int
        n of the n x n samples: cell centres of a square around the disk; those inside it count.
    exact : bool
        Distances of Algorithm 2 instead of Algorithm 3.
    """

    groups = colours = 1
    tiers = relief = False

    def __init__(self, raster: Raster, half_angle: float, grid: int, exact: bool):
        self.raster, self.exact = raster, exact
        centres = (np.arange(grid) + 0.5) / grid * 2 - 1
        points = np.stack(np.meshgrid(centres, centres, indexing="ij"), -1).reshape(-1, 2)
        points = points[np.hypot(*points.T) <= 1.0]
        self.points = points * math.tan(half_angle)
        self.secants = np.sqrt(1 + (self.points**2).sum(1)).astype(f32)
        self.missing = np.zeros((raster.rows, raster.columns), f32)
        self.other = np.zeros_like(self.missing)

    def through(
        self, block: Block, sums: NDArray, weights: NDArray, slots: int, pool: ThreadPoolExecutor
    ) -> list[Future[None]]:
        """Take the light through a block of layers, one by one."""
        weights[:] = 1
        raster = self.raster
        for index in range(block.size):
            published_read(
                raster.perspective, self.missing, block.layers.depth, block.visible, index,
                sums[0, 0],
            )  # fmt: skip
            pitch = raster.pitch
            if not raster.parallel:
                pitch *= raster.near + (block.start + index) * raster.thickness
            points = np.ascontiguousarray(self.points * (raster.thickness / pitch), f32)

            def update(
                strip: tuple[int, int], index: int = index, points: NDArray = points
            ) -> None:
                published_update(
                    self.missing, self.other, block.layers.depth, index, points, self.secants,
                    self.exact, *strip,
                )  # fmt: skip

            list(pool.map(update, _strips(raster.rows)))
            self.missing, self.other = self.other, self.missing
        return []
