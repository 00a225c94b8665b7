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


LARGE = """
from math import lgamma
import numpy as np
from vtkmcvr.kernels.jit import entry_point, kernel, outlined


@outlined
def large(n):
    # Too large for LLVM to merge it into both calls
    total = lgamma(n + 0.1) + lgamma(n + 0.2) + lgamma(n + 0.3) + lgamma(n + 0.4)
    total += lgamma(n + 0.5) + lgamma(n + 0.6) + lgamma(n + 0.7) + lgamma(n + 0.8)
    return total + lgamma(n + 0.9) + lgamma(n + 1.0) + lgamma(n + 1.1) + lgamma(n + 1.2)


@kernel
def of_two(n, out):
    out[0], out[1] = large(n), large(n + 1)


@kernel
def of_one(n, out):
    out[0] = large(n)


@entry_point
def of_a_caller(n):
    return large(n)


def run():
    out = np.zeros(2)
    of_two(3, out)
    again = of_a_caller(3)
    expected = sum(lgamma(3 + k / 10) for k in range(1, 13))
    hits = sum(f.stats.cache_hits[s] for f in (of_two, of_a_caller) for s in f.stats.cache_hits)
    print(np.allclose([out[0], again], expected), hits)


def run_one():
    out = np.zeros(1)
    of_one(3, out)
    found = sum(sum(f.stats.cache_hits.values()) for f in (of_one, large))
    print(np.allclose(out[0], sum(lgamma(3 + k / 10) for k in range(1, 13))), found)
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


def test_other_code_does_not_run_what_a_kernel_has_made_of_a_function(tmp_path):
    """The optimiser drops arguments of a function that nothing else can call.

    LLVM's loader knows functions by name: were that of the kernel's own to be seen, other code
    would call it, with all arguments.
    """
    (tmp_path / "parts.py").write_text(LARGE)
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    for hits in (0, 2):
        assert python("import parts; parts.run()", tmp_path, **cache) == f"True {hits}"


def test_machine_code_that_kernels_share_comes_from_the_cache(tmp_path):
    (tmp_path / "parts.py").write_text(LARGE)
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert python("import parts; parts.run()", tmp_path, **cache) == "True 0"
    # A kernel that is new takes it from its own file, then along with the kernel
    for _ in range(2):
        assert python("import parts; parts.run_one()", tmp_path, **cache) == "True 1"
    # Two kernels bring it along
    both = python("import parts; parts.run(); parts.run_one()", tmp_path, **cache)
    assert both.split() == ["True", "2", "True", "1"]
