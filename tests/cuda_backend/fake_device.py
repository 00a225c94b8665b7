"""A device that is the CPU: launches are carried out when they are first waited for."""

import numpy as np
from compiled import compiled

from vtkmcvr import packed
from vtkmcvr.accuracy import totals_of
from vtkmcvr.film.moments import copy_film
from vtkmcvr.gpu import bricks
from vtkmcvr.gpu.errors import OutOfDeviceMemory
from vtkmcvr.kernels.shown import show_pixel
from vtkmcvr.tiles import render_tile


class FakeDevice:
    """Keeps what was asked of it; `fail_at` is the launch at which it breaks."""

    name = "fake device, compute capability 0.0"
    count = 1

    def __init__(self, room=True, fail_at=None, error=None):
        self.room, self.fail_at, self.error = room, fail_at, error
        self.launched, self.in_flight, self.most_in_flight, self.compiled = [], 0, 0, 0
        self.downloads = 0

    def alike(self):
        return [0]

    def room_for(self, *parts):
        if not self.room:
            raise OutOfDeviceMemory("scene and film take 9 MiB, fake device has 1 MiB free")

    def upload(self, part):
        return part.copy() if isinstance(part, np.ndarray) else copied(part)

    def download(self, film):
        assert self.in_flight == 0
        self.downloads += 1
        return copy_film(film)

    def totals(self, film):
        assert self.in_flight == 0
        return totals_of(film)

    def shown(self, film, screen):
        assert self.in_flight == 0
        pixels, show = np.zeros((*film.count.shape, 4), np.uint8), compiled(show_pixel)
        for row, column in np.ndindex(film.count.shape):
            show(screen, film, pixels, row, column)
        return pixels

    def compile(self, film, scene, goal, seed):
        self.compiled += 1

    def launch(self, film, scene, rows, goal, cap, seed):
        if len(self.launched) == self.fail_at:
            raise self.error
        self.launched.append((rows, cap))
        self.in_flight += 1
        self.most_in_flight = max(self.most_in_flight, self.in_flight)
        return [film, scene, rows, goal, cap, seed]

    def finished(self, ticket):
        film, scene, rows, goal, cap, seed = ticket
        here = np.minimum(goal, cap)
        render_tile(film, scene, *rows, 0, goal.shape[1], here, np.int64(seed))
        self.in_flight -= 1
        return True


def copied(part):
    if isinstance(part, tuple):
        inner = map(copied, part)
        return type(part)(*inner) if hasattr(part, "_fields") else tuple(inner)
    return part.copy() if isinstance(part, np.ndarray) else part


def poisoned(medium):
    """What a device has of a medium in bricks as an array, NaN where it has nothing."""
    found, (slot, voxels) = np.full(medium.values.shape, np.nan, np.float32), medium.values[1:]
    edge = int(packed.BRICK)
    for place in np.argwhere(bricks.needed_bricks(medium)):
        there = tuple(slice(n * edge, (n + 1) * edge) for n in place)
        shape = found[there].shape
        found[there] = voxels[(slot[tuple(place)], *map(slice, shape))]
    return medium._replace(values=found)
