"""Loops whose turns go side by side in lanes, and those that cannot."""

import math

import numpy as np
import pytest
from numba import config, njit
from scenes import everything

from vtkmcvr.lights import ConstantEnvironment, EnvironmentMap, RectangleLight
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.scene import Surface

pytestmark = pytest.mark.skipif(config.DISABLE_JIT, reason="it is about compiled code")
if not config.DISABLE_JIT:
    from vtkmcvr.kernels.compilers import LaunchedCompiler
    from vtkmcvr.kernels.jit import KERNEL, launched
    from vtkmcvr.kernels.launch import Launched, taken_apart
    from vtkmcvr.kernels.loops import WIDTH, apart
    from vtkmcvr.kernels.program import Due, steps_of
    from vtkmcvr.kernels.room import new_room

LANES = f"<{WIDTH} x float>"


def machine_code_of(kernel, kinds):
    """LLVM code of a kernel, compiled anew: what a cache holds is machine code."""
    fresh = Launched.of(njit(nogil=True, pipeline_class=LaunchedCompiler, **KERNEL)(kernel.py_func))
    fresh.compile(kinds)
    return fresh.overloads[kinds].library.get_llvm_str()


def goes_in_lanes(kernel, *arguments):
    """Whether all loops of a kernel do that are said to be apart.

    LLVM takes off what it was told of a loop, once it has done that.
    """
    code = machine_code_of(kernel, tuple(taken_apart(a, {})[0] for a in arguments))
    return LANES in code and "llvm.loop.vectorize.width" not in code


@launched
def side_by_side(places, x, y):
    for i in range(len(places) & -WIDTH):
        apart()
        k = places[i]
        if x[k] > np.float32(1):
            y[k] = math.sqrt(x[k]) * x[i]


@launched
def one_after_the_other(places, x, y):
    for i in range(len(places) & -WIDTH):
        k = places[i]
        if x[k] > np.float32(1):
            y[k] = math.sqrt(x[k]) * x[i]


@launched
def with_a_loop_inside(places, x, y):
    for i in range(len(places) & -WIDTH):
        apart()
        k = places[i]
        while x[k] > np.float32(1):
            x[k] *= np.float32(0.5)
        y[k] = x[k]


def arrays(n=3 * WIDTH):
    rng = np.random.default_rng(1)
    return rng.permutation(n), (4 * rng.random(n)).astype(np.float32), np.zeros(n, np.float32)


def test_turns_go_in_lanes_only_where_they_are_said_to_be_apart():
    places, x, y = arrays()
    # Nobody but us knows that no place comes twice
    assert goes_in_lanes(side_by_side, places, x, y)
    assert not goes_in_lanes(one_after_the_other, places, x, y)
    expected = y.copy()
    one_after_the_other(places, x, expected)
    side_by_side(places, x, y)
    np.testing.assert_array_equal(y, expected)
    assert 0 < np.count_nonzero(y) < len(y)


def test_a_loop_inside_keeps_turns_one_after_the_other():
    places, x, y = arrays()
    assert not goes_in_lanes(with_a_loop_inside, places, x, y)
    started = x.copy()
    with_a_loop_inside(places, x, y)
    assert (y <= 1).all()
    np.testing.assert_array_equal(y, x)
    ratio = np.log2(started / y)
    np.testing.assert_allclose(ratio, np.rint(ratio), atol=1e-6)


LAMPS = tuple(RectangleLight((x, 2, 4), (0, 0, 0), (1, 1), 3.0) for x in (-3, 3))
LIT = {
    "constant environment and two lamps": (ConstantEnvironment(1.0), *LAMPS),
    "map and lamp": (EnvironmentMap(np.ones((4, 8, 3))), LAMPS[0]),
}
# Those that are loops over paths and compute; the walk has lanes of its own, a film takes one path
# at a time, and what the camera sees is only copied
LOOPS = {"begin", "meet", "face", "by_light", "shade", "by_scatter", "collect", "go_on", "leave"}


@pytest.mark.slow
@pytest.mark.parametrize("scattering", ["single", "multiple"])
@pytest.mark.parametrize("name", LIT)
def test_stages_go_in_lanes(name, scattering):
    """Of the default look: a change that costs it its speed is found here, not in a benchmark."""
    made = plan(everything(*LIT[name], surface=Surface(gradient_factor=1.0), scattering=scattering))
    film = empty_film(made)
    due = Due(film.count, np.zeros(film.count.shape, np.bool_), np.int64(0))
    steps = dict.fromkeys(LOOPS)
    for part in steps_of(film, made.packed, due, new_room()):
        for stage, arguments in part:
            name = stage.py_func.__name__
            if name in LOOPS:
                steps[name] = goes_in_lanes(stage, *arguments)
    assert [name for name, lanes in steps.items() if lanes is False] == []
    assert sum(lanes is True for lanes in steps.values()) >= 6
