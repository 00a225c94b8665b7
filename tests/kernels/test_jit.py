"""Kernels as plain Python, and the stamp of the on-disk cache."""

import os
import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from compiled import compiled
from numba.core.caching import FunctionCache
from scenes import blob, everything, render

import vtkmcvr.kernels
from vtkmcvr.kernels import jit, path
from vtkmcvr.kernels.cpu import render_tile
from vtkmcvr.lights import ConstantEnvironment, EnvironmentMap, PointLight, RectangleLight
from vtkmcvr.packed import Gloss
from vtkmcvr.scene import Surface

TESTS = Path(__file__).parents[1]


def tiny():
    lights = (
        ConstantEnvironment(0.3),
        EnvironmentMap(np.random.default_rng(1).random((3, 5, 3))),
        RectangleLight((2, -2, 2), (0, 0, 0), (1, 1), 3.0),
        PointLight((-1, -2, 1), 2.0),
    )
    return everything(*lights, surface=Surface(0.8, exponent=20), vol=blob(8), size=(16, 12))


def python(code, folder, **environment):
    """Run code in another interpreter that finds this package and these helpers."""
    library = Path(vtkmcvr.kernels.__file__).parents[2]
    places = os.pathsep.join(map(str, (folder, TESTS, TESTS / "kernels", library)))
    return subprocess.run(
        [sys.executable, "-c", code], check=True, cwd=folder, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": places, **environment},
    ).stdout.strip()  # fmt: skip


def test_kernels_are_plain_python_too(tmp_path):
    code = (
        "import numpy as np; from test_jit import render, render_tile, tiny\n"
        "assert not hasattr(render_tile, 'py_func')\n"
        "np.savez('film.npz', **render(tiny(), samples=1).film._asdict())"
    )
    python(code, tmp_path, NUMBA_DISABLE_JIT="1")
    slow = np.load(tmp_path / "film.npz")
    fast = render(tiny(), samples=1)
    assert fast.alpha.mean() > 0.3
    # Compiled code fuses and reorders float32 operations. The random numbers are the same; the fate
    # of a path changes with a probability of some 1e-6 for each decision
    np.testing.assert_array_equal(slow["count"], fast.film.count)
    same = (slow["hits"] == fast.film.hits) & np.isclose(
        slow["mean"], fast.film.mean, rtol=1e-3, atol=1e-6
    ).all(axis=-1)
    assert same.sum() >= 16 * 12 - 2
    np.testing.assert_allclose(slow["depth"][same], fast.film.depth[same], rtol=1e-5)


def stamp_of(folder):
    code = "from kernel_copy.kernels import jit; print(jit.source_stamp())"
    return python(code, folder)


def test_stamp_changes_with_any_kernel_source(tmp_path):
    here = Path(vtkmcvr.kernels.__file__).parent
    copy = tmp_path / "kernel_copy"
    ignore = shutil.ignore_patterns("__pycache__")
    shutil.copytree(here, copy / "kernels", ignore=ignore)
    shutil.copytree(here.parent / "packed", copy / "packed", ignore=ignore)
    (copy / "__init__.py").touch()
    stamps = [stamp_of(tmp_path)]
    assert stamps[0] == jit.source_stamp()
    for source in (copy / "kernels" / "grid.py", copy / "packed" / "film.py"):
        with source.open("a") as file:
            file.write("# edited\n")
        stamps.append(stamp_of(tmp_path))
    assert len(set(stamps)) == 3


def test_kernels_carry_the_stamp():
    for kernel in (render_tile, path.light_by_light):
        assert isinstance(kernel._cache, jit._StampedCache)
        assert isinstance(kernel._cache, FunctionCache)
        assert jit.source_stamp() in kernel._cache._cache_file._version


def test_index_of_older_kernels_is_not_even_unpickled(tmp_path):
    # It may name classes that are gone
    index = jit._StampedCache(render_tile.py_func)._cache_file
    index._index_path = str(tmp_path / "older.nbi")
    current = index._version
    for version in ("0.1", current.replace(jit.source_stamp(), "0" * 64)):
        (tmp_path / "older.nbi").write_bytes(pickle.dumps(version) + b"no pickle")
        assert index._load_index() == {}
    (tmp_path / "older.nbi").write_bytes(pickle.dumps(current) + b"no pickle")
    with pytest.raises(pickle.UnpicklingError):
        index._load_index()


def test_kernel_outside_the_package_is_rebuilt_after_an_edit(tmp_path):
    source = tmp_path / "other.py"
    code = "from other import f; print(f())"
    text = (
        "from vtkmcvr.kernels.jit import entry_point\n\n\n@entry_point\ndef f():\n    return {}\n"
    )
    found = []
    for value in (1, 22):
        source.write_text(text.format(value))
        found.append(python(code, tmp_path))
    assert found == ["1", "22"]


def test_no_kernel_uses_doubles_by_accident():
    # A stray Python float or int64 would widen float32 arithmetic: colours and distances stay
    # single
    from vtkmcvr.kernels.brdf import blinn
    from vtkmcvr.kernels.phase import phase_value

    v = (np.float32(0), np.float32(0), np.float32(1))
    gloss = Gloss(v, np.float32(10), np.bool_(False))
    for kernel, args in ((blinn, (gloss, v, v)), (phase_value, (None, v, v))):
        assert isinstance(compiled(kernel)(*args), float)
        assert all(str(o.signature.return_type) == "float32" for o in kernel.overloads.values())


def test_a_data_file_under_another_number_is_not_run(tmp_path):
    # Two processes that read the same index, and give the next number to different types
    first, second = (jit.CheckedCacheFile(tmp_path, "kernel", "stamp") for _ in range(2))
    first.save("float", "code for floats")
    index = (tmp_path / "kernel.nbi").read_bytes()
    second.flush()
    second.save("int", "code for ints")
    assert second.load("int") == "code for ints"
    (tmp_path / "kernel.nbi").write_bytes(index)
    assert first.load("float") is None
    first.save("float", "code for floats")
    assert first.load("float") == "code for floats"
    # Another version's file, or none that can be read, under the same number
    second._version = "another"
    second._save_data("kernel.1.nbc", ("another", "float", "old code"))
    assert first.load("float") is None
    (tmp_path / "kernel.1.nbc").write_bytes(b"cut off")
    assert first.load("float") is None
