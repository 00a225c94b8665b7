"""Kernel-only functions as LLVM code that kernels link in."""

import numpy as np
import pytest
from compiled import compiled
from test_jit import python

from vtkmcvr.kernels.linked import DeviceLibrary
from vtkmcvr.kernels.vec import dot

MODULE = """
import numpy as np
from vtkmcvr.kernels.jit import device, kernel


@device
def cubed(x):
    return x * x * x


@device
def sum_of_cubes(x, n):
    total = np.float32(0)
    for _ in range(n):
        total += cubed(min(x, np.float32(9)))
    return total


@kernel
def first(out):
    out[0] = sum_of_cubes(out[0], 4)


@kernel
def second(out):
    # Two ways to one function: through another, and directly
    out[0] = cubed(out[0]) + sum_of_cubes(out[0], 4)


def run(function):
    out = np.full(1, 2, np.float32)
    function(out)
    hits = (sum(f.stats.cache_hits.values()) for f in (function, sum_of_cubes, cubed))
    print(out[0], *hits)
"""


def test_a_function_of_kernels_cannot_be_called_from_python():
    v = (np.float32(1), np.float32(2), np.float32(3))
    assert compiled(dot)(v, v) == 14
    with pytest.raises(TypeError, match="dot is a part of kernels"):
        dot(v, v)


def test_it_ends_as_llvm_code():
    v = (np.float32(1), np.float32(2), np.float32(3))
    compiled(dot)(v, v)
    for result in dot.overloads.values():
        assert isinstance(result.library, DeviceLibrary)
        assert result.library.get_pointer_to_function(result.library.symbol) == 0


def test_another_kernel_in_another_process_takes_it_from_the_cache(tmp_path):
    (tmp_path / "parts.py").write_text(MODULE)
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}

    def run(kernel):
        return python(f"import parts; parts.run(parts.{kernel})", tmp_path, **cache)

    # 4 * 2^3 and 2^3 + 4 * 2^3; then the hits: kernel, sum_of_cubes, cubed
    assert run("first") == "32.0 0 0 0"
    assert run("first") == "32.0 1 0 0"
    assert run("second") == "40.0 0 1 1"
