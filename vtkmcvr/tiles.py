"""A tile of the film, by the launcher that is the fastest for the scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import packed
from .kernels.cpu import render_tile as render_one_by_one
from .kernels.stages import Room, new_room, render_in_step

# Rooms that no thread is in: as many as there have been threads at a time, 2 MB each
_free: list[Room] = []


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
    """Bring every pixel of a tile up to its `goal` of samples; continues where the film is.

    No pixel depends on the tile that it is in.
    """
    if not goes_in_step(scene):
        render_one_by_one(film, scene, row_0, row_1, column_0, column_1, goal, seed)
        return
    room = _room()
    try:
        render_in_step(film, scene, row_0, row_1, column_0, column_1, goal, seed, room)
    finally:
        _free.append(room)


def _room() -> Room:
    # Taking one is a single step of the interpreter, as giving it back is
    try:
        return _free.pop()
    except IndexError:
        return new_room()
