"""A tile of the film, by the launcher that is the fastest for the scene."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from . import packed
from .kernels.cpu import render_tile as render_one_by_one
from .kernels.launch import Known, Launched, taken_apart, words_of
from .kernels.program import Due, Program, program, run
from .kernels.room import Room, new_room
from .outline import dark_pixels

# Not plain Python, as with NUMBA_DISABLE_JIT=1
COMPILED = isinstance(render_one_by_one, Launched)
# Rooms that no thread is in: as many as there have been threads at a time
_free: list[Room] = []
# What launchers need not take apart, each anew
_known_rooms: Known = {}


def goes_in_step(scene: packed.Scene) -> bool:
    """Whether paths go in step: in one volume, whose table is one of scalars."""
    medium, transfer = scene.medium, scene.transfer
    others = (
        scene.marching, scene.more, medium.holes, medium.regions, transfer.gradient_opacity,
        transfer.table_2d,
    )  # fmt: skip
    # Plain Python knows no lanes
    return COMPILED and all(effect is None for effect in others)


class Launcher:
    """Renders tiles of a film, up to a `goal` of samples in each pixel, which may change.

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
        self.goal = goal
        self._arguments = film, scene, goal, seed
        self._in_step = goes_in_step(scene)
        # By room: a thread's
        self._programs: dict[int, Program] = {}
        self._known = dict(_known_rooms)
        if self._in_step:
            self._due = Due(goal, dark_pixels(scene, film.count.shape), seed)
            with _room() as room:
                self._program(room)
        elif COMPILED:
            self._address = render_one_by_one.address(film, scene, 0, 0, 0, 0, goal, seed)
            self._words = words_of((film, scene)), words_of((goal, seed))

    def _program(self, room: Room) -> Program:
        # Rooms stay: no other one gets the number
        if id(room) not in self._programs:
            film, scene, _, _ = self._arguments
            self._programs[id(room)] = program(film, scene, self._due, room, self._known)
        return self._programs[id(room)]

    def __call__(self, row_0: int, row_1: int, column_0: int, column_1: int) -> None:
        """Bring every pixel of a tile up to its goal."""
        tile = row_0, row_1, column_0, column_1
        if self._in_step:
            with _room() as room:
                run(self._program(room), *tile)
        elif COMPILED:
            film_and_scene, goal_and_seed = self._words
            words = film_and_scene, np.array(tile, np.int64), goal_and_seed
            Launched.launch(self._address, *words)
        else:
            film, scene, goal, seed = self._arguments
            render_one_by_one(film, scene, *tile, goal, seed)


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
def _room() -> Iterator[Room]:
    # Taking one is a single step of the interpreter, as giving it back is
    try:
        room = _free.pop()
    except IndexError:
        room = new_room()
        taken_apart(room, _known_rooms)
    try:
        yield room
    finally:
        _free.append(room)
