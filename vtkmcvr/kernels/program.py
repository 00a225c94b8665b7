"""Which stages the paths of a scene in step go through, and the loop that runs them.

The loop knows machine code by its address, so it is compiled once, and a stage once for all scenes
whose parts are of the same types.
"""

from __future__ import annotations

from collections import namedtuple
from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from .. import packed
from .jit import kernel
from .launch import Known, Launched, taken_apart
from .light_stages import by_light, by_scatter, collect, go_on, shade
from .packets import walk_queue
from .pool import Queue
from .room import COLUMN, COLUMN_0, COLUMN_1, LIVE, MOST, ROW, ROW_0, ROW_1, SAMPLE, TAKEN, Room
from .stages import begin, expose, leave, meet
from .surface_stages import face, see, see_normals

INT, LONG = ir.IntType(32), ir.IntType(64)


# Parts of a packed scene that stages take, and fields of `packed.Scene` that they read
VERTEX, RECEIVERS = "gloss phase sobol", "receivers mesh"
LIGHTS = "choice all_lights area_lights environment"
BeginPart = namedtuple(
    "BeginPart", f"camera lens sobol backdrop medium {RECEIVERS} all_lights area_lights"
)
MeetPart = namedtuple(
    "MeetPart", f"{VERTEX} {RECEIVERS} camera medium transfer surface more marching"
)
FacePart = namedtuple("FacePart", "sobol surface medium")
SeePart = namedtuple("SeePart", "normal_map medium")
ByLightPart = namedtuple("ByLightPart", f"{VERTEX} {LIGHTS} delta_lights")
ShadePart = namedtuple("ShadePart", f"sobol {RECEIVERS} medium shadows")
ByScatterPart = namedtuple("ByScatterPart", f"{VERTEX} {LIGHTS} ambient")
GoOnPart = namedtuple("GoOnPart", f"{VERTEX} {LIGHTS} ambient {RECEIVERS} medium")
FilmPart = namedtuple("FilmPart", "backdrop environment_visible ambient environment area_lights")
# Delta tracking and ratio tracking
BY_DELTA, BY_RATIO = np.bool_(False), np.bool_(True)


class Due(NamedTuple):
    """Samples that are due."""

    goal: NDArray[np.int64]  # (H, W) samples that each pixel is to have
    dark: NDArray[np.bool_]  # (H, W) pixels whose paths are all black
    seed: np.int64


class Program(NamedTuple):
    """Stages of a scene's paths in a room, in the order in which they run.

    The first ones run for every batch of paths; those from `again` to `end` for every further
    event, while there are paths that go on; the others when all paths have ended.
    """

    steps: NDArray[np.int64]  # (n, 2) addresses: machine code; words of its arguments
    again: int
    end: int
    most: int  # events of a path
    room: Room
    # What addresses point to
    arguments: list


Steps = list[tuple[Launched, tuple]]


def part(kind: type, scene: packed.Scene) -> tuple:
    """Part of a packed scene."""
    return kind(*(getattr(scene, name) for name in kind._fields))


def walked(scene: packed.Scene) -> tuple:
    """All that the walk knows of a scene: it is one for many scenes."""
    transfer = scene.transfer._replace(
        colour_grid=None, emission=None, specular=None, exponent=None, phase=None
    )
    return scene.medium._replace(clip=None), transfer


def with_material(scene: packed.Scene, room: Room) -> tuple[packed.Scene, Room]:
    """What a stage takes that meets events: no material where there is but one."""
    of_scalar = scene.transfer.specular, scene.transfer.exponent, scene.transfer.phase
    if scene.receivers is not None or any(table is not None for table in of_scalar):
        return scene, room
    return scene._replace(gloss=None, phase=None), room._replace(material=None)


def to_events(scene: packed.Scene, room: Room) -> Steps:
    """Steps of events: what rays meet, and which of it are surfaces."""
    without, even = with_material(scene, room)
    steps: Steps = [(meet, (part(MeetPart, without._replace(surface=None)), even))]
    if scene.surface is not None:
        steps.append((face, (part(FacePart, scene), room)))
    return steps


def to_lights(scene: packed.Scene, walk: tuple, room: Room, queue: Queue) -> Steps:
    """Steps of shadow rays, which walk where anything can be in their way."""
    steps: Steps = [(shade, (part(ShadePart, scene), room, queue))]
    if scene.shadows is None:
        return steps
    if scene.ratio is None:
        how = BY_DELTA, np.float32(0)
    else:
        how = BY_RATIO, scene.ratio.roulette
    return [*steps, (walk_queue, (*walk, *how, queue, room.pool))]


def steps_of(
    film: packed.Film, scene: packed.Scene, due: Due, room: Room
) -> tuple[Steps, Steps, Steps]:
    """Stages and their arguments: of a batch, of each further event, of its end."""
    _, even = with_material(scene, room)
    walk = walked(scene)
    ahead: Steps = [(walk_queue, (*walk, BY_DELTA, np.float32(0), room.first, room.pool))]
    events = to_events(scene, room)
    seen = see if scene.normal_map is None else see_normals
    lit: Steps = [
        (by_light, (part(ByLightPart, scene), even)),
        *to_lights(scene, walk, room, room.second),
    ]
    first: Steps = [
        (begin, (film.count, due, part(BeginPart, scene), room)), *ahead, *events,
        (seen, (part(SeePart, scene), room)), *lit,
    ]  # fmt: skip
    last: Steps = [(expose, (film, part(FilmPart, scene), room))]
    if scene.scattering is None:
        scatter = by_scatter, (part(ByScatterPart, scene), even)
        last.insert(0, (collect, (room,)))
        return [*first, scatter, *to_lights(scene, walk, room, room.first)], [], last
    onward = go_on, (scene.scattering, part(GoOnPart, scene), even)
    return first, [onward, *ahead, (leave, (room,)), *events, *lit], last


def program(film: packed.Film, scene: packed.Scene, due: Due, room: Room, known: Known) -> Program:
    """Compile what is not compiled yet. `known` serves programs of one scene in several rooms."""
    first, again, last = steps_of(film, scene, due, room)
    steps = [*first, *again, *last]
    addresses, blocks = [], []
    for stage, arguments in steps:
        parts = [taken_apart(argument, known) for argument in arguments]
        blocks.append(np.concatenate([words for _, words in parts]))
        address = stage.address_for(tuple(kind for kind, _ in parts))
        addresses.append((address, blocks[-1].ctypes.data))
    most = 1 if scene.scattering is None else scene.scattering.most
    return Program(
        np.array(addresses, np.int64), len(first), len(first) + len(again), most, room,
        [blocks, [arguments for _, arguments in steps]],
    )  # fmt: skip


def run(made: Program, row_0: int, row_1: int, column_0: int, column_1: int) -> None:
    """Bring every pixel of a tile up to its goal."""
    if row_0 >= row_1 or column_0 >= column_1:
        return
    place(made, row_0, row_1, column_0, column_1)
    status = run_steps(made.steps, made.again, made.end, made.room.numbers)
    if status != 0:
        raise RuntimeError(f"a kernel ended with status {status}; this is a fault of vtkmcvr")


def place(made: Program, row_0: int, row_1: int, column_0: int, column_1: int) -> None:
    """Put a program at the start of a tile."""
    numbers = made.room.numbers
    numbers[[ROW_0, ROW_1, COLUMN_0, COLUMN_1]] = row_0, row_1, column_0, column_1
    numbers[[ROW, COLUMN, SAMPLE, MOST]] = row_0, column_0, 0, made.most


@intrinsic
def call(typing, address, words):
    """Status of the machine code at an address, which takes the address of its words."""

    def emit(context, builder, sig, args):
        kind = ir.FunctionType(INT, [LONG.as_pointer()])
        code = builder.inttoptr(args[0], kind.as_pointer())
        return builder.call(code, [builder.inttoptr(args[1], LONG.as_pointer())])

    return types.int32(types.int64, types.int64), emit


@kernel
def run_steps(steps, again, end, numbers):
    """Run a program batch by batch, until no sample is due. Returns the status of its kernels."""
    status = np.int32(0)
    while status == 0:
        for k in range(again):
            status |= call(steps[k, 0], steps[k, 1])
            if numbers[TAKEN] == 0:
                return status
        while again < end and numbers[LIVE] > 0 and status == 0:
            for k in range(again, end):
                status |= call(steps[k, 0], steps[k, 1])
        for k in range(end, len(steps)):
            status |= call(steps[k, 0], steps[k, 1])
    return status
