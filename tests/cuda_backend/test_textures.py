"""The probe of textures compiles, and says to the driver what it means."""

import sys
from pathlib import Path

import numpy as np
import pytest
from needs import compiler

sys.path.insert(0, str(Path(__file__).parents[1] / "gpu"))

pytestmark = compiler
CAPABILITIES = [(7, 5), (9, 0)]


@pytest.mark.parametrize("capability", CAPABILITIES)
@pytest.mark.parametrize("name", ["by_array", "by_filter", "by_texels"])
def test_lookups_compile_and_assemble(name, capability, monkeypatch, tmp_path):
    import lookups
    from numba.cuda.typing.typeof import typeof
    from ptx import assembled, doubles, pretend, ptx_of

    pretend(monkeypatch, capability)
    source = np.zeros((2, 2, 2), np.int16) if name == "by_array" else np.uint64(1)
    types = tuple(map(typeof, (source, np.int64(9), np.zeros(2, np.float32))))
    ptx = ptx_of(getattr(lookups, name).py_func, types, capability)
    reads = {"by_array": 0, "by_filter": 1, "by_texels": 8}[name]
    # Loops are unrolled
    assert ptx.count("tex.3d.v4.f32.f32") % max(reads, 1) == 0
    assert bool(ptx.count("tex.3d.v4.f32.f32")) == (name != "by_array")
    assert not doubles(ptx)
    made = assembled(ptx, "sm_{}{}".format(*capability), tmp_path)
    assert made is None or made[1] == 0


def test_lookups_link_to_machine_code(monkeypatch):
    import lookups
    from numba.cuda import codegen
    from numba.cuda.dispatcher import _Kernel
    from numba.cuda.typing.typeof import typeof
    from ptx import pretend

    pretend(monkeypatch, (9, 0))
    monkeypatch.setattr(codegen.CUDACodeLibrary, "_ensure_cc", lambda self, cc: cc or (9, 0))
    types = tuple(map(typeof, (np.uint64(1), np.int64(9), np.zeros(2, np.float32))))
    kernel = lookups.by_filter
    made = _Kernel(kernel.py_func, types, **{**kernel.targetoptions, "lto": False})
    assert made._codelibrary.get_cubin(cc=(9, 0)).code[:4] == b"\x7fELF"


@pytest.mark.parametrize("filtered", [False, True])
def test_driver_is_told_the_shape_and_the_filter(filtered):
    import lookups

    values = np.zeros((3, 4, 5), np.int16)
    array, copy, texture = lookups.described(values, filtered)
    assert (array.Width, array.Height, array.Depth, array.NumChannels) == (5, 4, 3, 1)
    assert "SIGNED_INT16" in array.Format.name
    assert (copy.WidthInBytes, copy.Height, copy.Depth) == (10, 4, 3)
    assert (copy.srcPitch, copy.srcHeight, int(copy.srcHost)) == (10, 4, values.ctypes.data)
    assert texture.filterMode.name.endswith("LINEAR" if filtered else "POINT")
    # Neither normalised coordinates nor whole numbers as they are
    assert texture.flags == 0


def test_paths_stay_inside_the_volume():
    import lookups

    room = lookups.EDGE - 3 - lookups.STEP * lookups.LOOKUPS
    assert room > 0
    assert 1 + room + lookups.LOOKUPS * lookups.STEP < lookups.EDGE - 1
    assert lookups.PATHS % lookups.THREADS == 0
