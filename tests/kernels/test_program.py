"""Stages that paths in step go through: which a new effect compiles, and what they keep."""

from dataclasses import replace

import numpy as np
import pytest
from numba import config
from numba.core.errors import TypingError
from scenes import everything

from vtkmcvr.cutting import Plane
from vtkmcvr.lights import ConstantEnvironment, PointLight
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.scene import Lens, Surface

pytestmark = pytest.mark.skipif(config.DISABLE_JIT, reason="it is about compiled code")
if not config.DISABLE_JIT:
    from vtkmcvr.kernels.jit import kernel, launched
    from vtkmcvr.kernels.kept import keep, kept
    from vtkmcvr.kernels.launch import taken_apart, words_of
    from vtkmcvr.kernels.program import Due, program, run_steps, steps_of
    from vtkmcvr.kernels.room import LIVE, MOST, TAKEN, new_room

ALL = {
    "begin", "walk_queue", "meet", "face", "see", "by_light", "shade", "by_scatter", "collect",
    "go_on", "leave", "expose",
}  # fmt: skip
WHOLE = everything(ConstantEnvironment(1.0), surface=Surface(gradient_factor=1.0), aovs=("albedo",))


def nothing_due(film):
    return Due(film.count, np.zeros(film.count.shape, np.bool_), np.int64(0))


def stages(some):
    """Names of the stages of a scene, with the types of their arguments, which code is for."""
    made = plan(some)
    film = empty_film(made)
    parts = steps_of(film, made.packed, nothing_due(film), new_room())
    return {
        (stage.py_func.__name__, tuple(taken_apart(a, {})[0] for a in arguments))
        for part in parts
        for stage, arguments in part
    }


@pytest.mark.parametrize(
    ("change", "compiled"),
    [
        ({"shadow_reach": 0.0}, {"shade"}),
        ({"ratio_tracking": False}, set()),
        ({"surface": None}, {"by_light", "by_scatter"}),
        ({"lights": WHOLE.lights[:1]}, {"begin", "by_light", "by_scatter", "expose"}),
        ({"lights": (*WHOLE.lights, PointLight((9, 9, 9)))}, set()),
        ({"scattering": "multiple"}, {"go_on", "leave"}),
        ({"camera": replace(WHOLE.camera, lens=Lens(radius=0.1))}, {"begin"}),
        ({"clip": (Plane((0, 0, 0), (1, 0, 0)),)}, {"begin", "meet", "face", "see", "shade"}),
        ({"aovs": ()}, {"expose"}),
        ({"aovs": ("albedo", "normal")}, {"see_normals", "expose"}),
    ],
    ids=lambda x: next(iter(x), "none") if isinstance(x, dict) else "",
)
def test_a_new_effect_compiles_the_stages_that_know_of_it(change, compiled):
    new = stages(replace(WHOLE, **change)) - stages(WHOLE)
    assert {name for name, _ in new} == compiled


def test_all_stages_are_compiled_for_what_they_take():
    both = stages(WHOLE) | stages(replace(WHOLE, scattering="multiple"))
    assert {name for name, _ in both} == ALL
    # One walk for rays of the camera, toward lights, and of both
    assert len(both) == len(ALL)


def test_parts_that_are_known_are_not_taken_apart_again():
    made = plan(WHOLE)
    film = empty_film(made)
    known, room = {}, new_room()
    first = program(film, made.packed, nothing_due(film), room, known)
    there = dict(known)
    other = program(film, made.packed, nothing_due(film), new_room(), known)
    np.testing.assert_array_equal(first.steps[:, 0], other.steps[:, 0])
    assert all(known[i] is found for i, found in there.items())
    # What addresses of words point to
    assert id(room) in there and first.room is room


def test_nothing_runs_where_no_sample_is_due():
    made = plan(WHOLE)
    film = empty_film(made)
    room = new_room()
    steps, again, end, *_ = program(film, made.packed, nothing_due(film), room, {})
    assert run_steps(steps, again, end, room.numbers) == 0
    assert room.numbers[TAKEN] == room.numbers[LIVE] == 0


def test_an_error_of_a_stage_ends_the_loop():
    @launched
    def fails(numbers):
        numbers[TAKEN], numbers[LIVE] = 1, 1
        raise ValueError("a stage fails")

    numbers = np.zeros(MOST + 1, np.int64)
    words = words_of(numbers)
    steps = np.array([(fails.address(numbers), words.ctypes.data)], np.int64)
    assert run_steps(steps, 1, 1, numbers) != 0
    assert run_steps(np.repeat(steps, 2, 0), 1, 2, numbers) != 0


def test_what_is_kept_is_of_one_type():
    @kernel
    def right(places, out):
        keep(places, 1, (out[0], 3), (out[0], 0))
        out[0], out[1] = kept(places, 1, (out[0], 0))

    @kernel
    def wrong(places, out):
        keep(places, 1, (out[0], 3), (out[0], 0.0))

    @kernel
    def too_large(places, out):
        keep(places, 1, (out[0], 3, 4), (out[0], 0, 0))

    places, out = np.zeros(3, "S16"), np.full(2, 7.0)
    right(places, out)
    np.testing.assert_array_equal(out, (7, 3))
    # First numbers of all places, then second ones
    np.testing.assert_array_equal(places.view(np.float64)[:3], (0, 7, 0))
    np.testing.assert_array_equal(places.view(np.int64)[3:], (0, 3, 0))
    with pytest.raises(TypingError, match="is not kept as"):
        wrong(places, out)
    with pytest.raises(Exception, match="more than 16 bytes"):
        too_large(places, out)
