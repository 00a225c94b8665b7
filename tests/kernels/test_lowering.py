"""Variables of kernel-only functions that are assigned once are values in LLVM code."""

import numpy as np
import pytest
from compiled import compiled

from vtkmcvr.kernels.jit import device

f32 = np.float32
# Memory of a pair of float32
PLACE = "alloca [2 x float]"


@device
def larger(a, b):
    pair = (a, b)
    if a < b:
        return pair[1]
    return pair[0]


@device
def summed(a, b, n):
    pair = (a, b)
    total = a - a
    for i in range(n):
        pair = (pair[1], pair[0])
        if i > 1:
            total += pair[0]
    return total


@device
def last_above(a, n):
    found = a
    for i in range(n):
        twice = f32(2) * f32(i)
        if twice > a:
            found = twice
    return found


def code_of(function):
    (compiled_once,) = function.overloads.values()
    return str(compiled_once.library._final_module)


def test_a_tuple_that_is_assigned_once_takes_no_memory():
    call = compiled(larger)
    assert call(f32(1), f32(2)) == call(f32(2), f32(1)) == 2
    assert PLACE not in code_of(larger)


def test_one_that_is_assigned_again_does():
    # From the third turn on: a, b, a
    assert compiled(summed)(f32(1), f32(10), 5) == 21
    assert PLACE in code_of(summed)


@pytest.mark.parametrize(("n", "expected"), [(0, 3), (2, 3), (3, 4), (9, 16)])
def test_what_is_assigned_in_a_branch_keeps_its_value(n, expected):
    assert compiled(last_above)(f32(3), n) == expected
