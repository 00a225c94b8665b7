"""Kernels that take their arguments as a block of words."""

from typing import NamedTuple

import numpy as np
import pytest
from numba import typeof
from test_jit import python

from vtkmcvr.kernels.jit import launched
from vtkmcvr.kernels.launch import Launched, taken_apart, words_of

f32 = np.float32


class Inner(NamedTuple):
    """Every kind of number."""

    small: np.uint8
    single: np.float32
    double: np.float64
    yes: bool
    negative: np.int32
    large: np.uint64


class Outer(NamedTuple):
    """Tuples within a tuple."""

    matrix: tuple
    absent: None
    inner: Inner
    grid: np.ndarray


@launched
def take_apart(out, scene, k):
    inner = scene.inner
    out[0] = inner.small
    out[1] = inner.single
    out[2] = inner.double
    out[3] = 1.0 if inner.yes else 0.0
    out[4] = inner.negative
    out[5] = float(inner.large >> np.uint64(32))
    out[6] = scene.matrix[1][0]
    out[7] = scene.grid[1, 2, 3]
    out[8] = k
    out[9] = 1.0 if scene.absent is None else 0.0


@launched
def failing(out):
    if out[0] > 0:
        raise ValueError


def scene_of(grid):
    inner = Inner(np.uint8(200), f32(-1.5), 1e-300, True, np.int32(-7), np.uint64(2**63 + 2**32))
    return Outer(((f32(1), f32(2)), (f32(3), f32(4))), None, inner, grid)


@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16, np.float32])
def test_every_kind_of_argument_arrives(dtype):
    grid = np.arange(60, dtype=dtype).reshape(3, 4, 5)
    out = np.zeros(10)
    take_apart(out, scene_of(grid), 11)
    expected = [200, -1.5, 1e-300, 1, -7, 2**31 + 1, 3, 33, 11, 1]
    assert out.tolist() == expected


def test_words_may_be_prepared_for_many_calls():
    out, scene = np.zeros(10), scene_of(np.zeros((3, 4, 5), f32))
    address = take_apart.address(out, scene, 0)
    prepared = words_of((out, scene))
    for k in (5, -6):
        Launched.launch(address, prepared, words_of(k))
        assert out[8] == k and out[2] == 1e-300


def test_what_is_no_argument_is_refused():
    with pytest.raises(TypeError, match="arrays, tuples, numbers and None"):
        words_of("text")


def test_an_error_inside_a_kernel_is_told():
    failing(np.zeros(1))
    with pytest.raises(RuntimeError, match="ended with status"):
        failing(np.ones(1))


def test_a_kernel_is_called_by_another_process_from_the_cache(tmp_path):
    (tmp_path / "parts.py").write_text(
        "import numpy as np\nfrom vtkmcvr.kernels.jit import launched\n\n\n"
        "@launched\ndef double(out, n):\n    out[0] = 2 * n\n\n\n"
        "out = np.zeros(1)\ndouble(out, 21)\nprint(out[0], sum(double.stats.cache_hits.values()))\n"
    )
    for hits in (0, 1):
        found = python("import parts", tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
        assert found == f"42.0 {hits}"


def test_what_is_taken_apart_once_is_known():
    scene = scene_of(np.zeros((2, 3, 4), np.uint8))
    known = {}
    kind, words = taken_apart(scene, known)
    assert kind is typeof(scene)
    np.testing.assert_array_equal(words, words_of(scene))
    again = taken_apart(scene._replace(matrix=scene.matrix), known)
    assert again[0] is kind
    np.testing.assert_array_equal(again[1], words)
    # Parts stay as long as what is known of them, or others would take their place
    assert known[id(scene.inner)][2] is scene.inner


def test_machine_code_is_compiled_once_for_equal_types():
    first, second = (scene_of(np.zeros((2, 3, n), np.uint8)) for n in (4, 5))
    out = np.zeros(10)
    address = take_apart.address(out, first, np.int64(1))
    assert take_apart.address(out, second, np.int64(2)) == address
    assert take_apart.address(out, scene_of(np.zeros((2, 3, 4), np.int16)), np.int64(1)) != address
