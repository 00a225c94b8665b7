"""An absent effect leaves nothing in the machine code: it is that of kernels without its source."""

import ast
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from scenes import everything, scene
from without_effects import Removal, absent_parts, compiled_launcher

from vtkmcvr.lights import DirectionalLight
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.scene import Camera, Lens
from vtkmcvr.tiles import goes_in_step

# And how far the two builds may differ: their functions have other names, so that a large kernel is
# optimised in another order, in which other functions are inlined more than once
SCENES = {
    "one light": (scene(lights=(DirectionalLight((0.3, 1, -1)),)), 0.005),
    "everything": (everything(), 0.06),
}
# Moves and jumps, which depend on the order in which registers are given out
PLUMBING = ("mov", "vmov", "j", "lea", "nop", "push", "pop", "xchg")


def instructions(planned, absent=(), in_step=False):
    """Instructions of the kernels of a scene, how often each."""
    launch = compiled_launcher(in_step, absent)
    film = empty_film(planned)
    launch.at(film, planned.packed, film.count, np.int64(0))(0, 0, 0, 0)
    text = "\n".join(launch.assembly())
    lines = [line.split()[0] for line in text.splitlines() if line.startswith("\t")]
    return Counter(word for word in lines if not word.startswith("."))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "in_step"), [("one light", False), ("one light", True), ("everything", False)]
)
def test_machine_code_is_that_of_a_build_without_the_absent_effects(name, in_step):
    some, tolerance = SCENES[name]
    planned = plan(some)
    assert goes_in_step(planned.packed) or not in_step
    absent = absent_parts(planned.packed) | absent_parts(empty_film(planned))
    assert {"lens", "clip", "labels", "backdrop", "emission"} <= absent
    whole, without = (instructions(planned, left_out, in_step) for left_out in ((), absent))
    assert whole.total() > 2000
    assert abs(whole.total() - without.total()) < tolerance * without.total()
    for counts in (whole, without):
        for word in list(counts):
            if word.startswith(PLUMBING):
                del counts[word]
    assert (whole - without).total() + (without - whole).total() < tolerance * without.total()


@pytest.mark.slow
def test_an_effect_that_is_there_is_noticed():
    without = plan(SCENES["one light"][0])
    lensed = plan(replace(without.scene, camera=Camera((0, -5, 0), (0, 0, 0), lens=Lens(0.1))))
    assert instructions(lensed).total() > 1.005 * instructions(without).total()


SOURCE = """
def f(lens, clip, x):
    if lens is None:
        return x
    if clip is not None and x > 0:
        x = 1
    y = 1 if clip is None else lens.radius
    if lens is None or x:
        x = 2
    else:
        x = 3
    return x + y
"""


@pytest.mark.parametrize(
    ("absent", "left"),
    [
        ({"lens"}, "def f(lens, clip, x):\n    return x"),
        ({"clip"}, "def f(lens, clip, x):\n    if lens is None:\n        return x\n    y = 1\n"
         "    if lens is None or x:\n        x = 2\n    else:\n        x = 3\n    return x + y"),
        ({"x", "z"}, SOURCE.strip()),
    ],
)  # fmt: skip
def test_removal_takes_what_is_never_run_and_no_more(absent, left):
    tree = Removal(frozenset(absent)).visit(ast.parse(SOURCE))
    assert ast.unparse(tree) == ast.unparse(ast.parse(left))
