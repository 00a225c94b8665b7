"""A tile of the film, by the launcher that is the fastest for the scene."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from . import packed
from .kernels.cpu import render_tile as render_one_by_one
from .kernels.launch import Launched, words_of
from .kernels.stages import Room, new_room, render_in_step

Words = NDArray[np.int64]
# Rooms that no thread is in, with their words: as many as there have been threads at a time
_free: list[tuple[Room, Words]] = []


def goes_in_step(scene: packed.Scene) -> bool:
    """Whether paths go in step: single scattering in one volume, whose table is one of scalars."""
    medium, transfer = scene.medium, scene.transfer
    others = (
        scene.scattering, scene.marching, scene.more, medium.holes, medium.regions,
        transfer.gradient_opacity, transfer.table_2d,
    )  # fmt: skip
    # Plain Python, as with NUMBA_DISABLE_JIT=1, knows no lanes
    compiled = hasattr(render_in_step, "py_func")
    return compiled and all(effect is None for effect in others)


class Launcher:
    """Renders tiles of a film, up to a `goal` of samples in each pixel.

    It takes film and scene apart once, for all tiles.

    Parameters
    ----------
    film : packed.Film
        Continued where it is. No pixel depends on the tile that it is in.
    scene : packed.Scene
    goal : ndarray of int64, (H, W)
    seed : int64
    """

    def __init__(
        self, film: packed.Film, scene: packed.Scene, goal: NDArray[np.int64], seed: np.int64
    ) -> None:
        self._arguments = film, scene, goal, seed
        self._in_step = goes_in_step(scene)
        # Plain Python with NUMBA_DISABLE_JIT=1
        self._compiled = isinstance(render_one_by_one, Launched)
        if self._compiled:
            self._address = self._machine_code()
            self._words = words_of((film, scene)), words_of((goal, seed))

    def _machine_code(self) -> int:
        film, scene, goal, seed = self._arguments
        if not self._in_step:
            return render_one_by_one.address(film, scene, 0, 0, 0, 0, goal, seed)
        with _room() as (room, _):
            return render_in_step.address(film, scene, 0, 0, 0, 0, goal, seed, room)

    def __call__(self, row_0: int, row_1: int, column_0: int, column_1: int) -> None:
        """Bring every pixel of a tile up to its goal."""
        if not self._compiled:
            film, scene, goal, seed = self._arguments
            render_one_by_one(film, scene, row_0, row_1, column_0, column_1, goal, seed)
            return
        film_and_scene, goal_and_seed = self._words
        tile = np.array((row_0, row_1, column_0, column_1), np.int64)
        words = film_and_scene, tile, goal_and_seed
        if not self._in_step:
            Launched.launch(self._address, *words)
            return
        with _room() as (_, room):
            Launched.launch(self._address, *words, room)


def render_tile(
    film: packed.Film,
    scene: packed.Scene,
    row_0: int,
    row_1: int,
    column_0: int,
    column_1: int,
    goal: NDArray[np.int64],
    seed: np.int64,
) -> None:
    """Render one tile; see `Launcher`."""
    Launcher(film, scene, goal, seed)(row_0, row_1, column_0, column_1)


@contextmanager
def _room() -> Iterator[tuple[Room, Words]]:
    # Taking one is a single step of the interpreter, as giving it back is
    try:
        free = _free.pop()
    except IndexError:
        room = new_room()
        free = room, words_of(room)
    try:
        yield free
    finally:
        _free.append(free)
