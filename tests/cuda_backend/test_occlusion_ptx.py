"""Kernels of directional occlusion compile for CUDA; float64 is where integrals of tables are."""

import numpy as np
import pytest
import sweeps
from needs import compiler

pytestmark = [compiler, pytest.mark.slow]
TURING, HOPPER = (7, 5), (9, 0)
MEANT = {
    "cone_transfer.py": "integrals of transfer functions, whose differences are small",
    "merged": "no line of their own",
}
# What depends on clip planes alone is computed once, at the heads of the loops over tiles
CLIPPED = {
    "cut.py": "where rays meet what clipping leaves",
    "vec.py": "the same",
    "cone_cuda.py": "the same",
}
CASES = {
    **sweeps.MODES,
    "clipped, shaded": sweeps.MORE["far away, shaded, albedo and normal, clipped"],
    "coloured light": sweeps.MORE["coloured light from the side in a parallel view"],
    "two volumes": sweeps.MORE["two volumes"],
}


def kernel_and_types(case):
    from numba.cuda.typing.typeof import typeof

    from vtkmcvr.kernels.cone_cuda import sweep_layers

    arguments = (*sweeps.dense_tables(*case), np.int64(0), np.int64(0))
    return sweep_layers, tuple(map(typeof, arguments))


@pytest.mark.parametrize("name", CASES)
def test_kernel_compiles_without_stray_doubles(name, monkeypatch, tmp_path):
    from ptx import assembled, doubles, pretend, ptx_of

    kernel, types = kernel_and_types(CASES[name])
    for capability in (TURING, HOPPER):
        pretend(monkeypatch, capability)
        ptx = ptx_of(kernel.py_func, types, capability)
        arch = "sm_{}{}".format(*capability)
        assert f".target {arch}" in ptx
        # The barrier of the whole grid
        assert "cudaCGSynchronize" in ptx
        found = doubles(ptx)
        print(f"{name}, {arch}: {dict(found)}; {assembled(ptx, arch, tmp_path, '-c')}")
        assert found["cone_transfer.py"] > 0
        assert set(found) <= set(MEANT) | set(CLIPPED if "clipped" in name else ()), found


def test_kernel_of_a_launch_links_with_the_barrier_to_machine_code(monkeypatch):
    from numba.cuda import codegen
    from numba.cuda.dispatcher import _Kernel
    from ptx import pretend

    pretend(monkeypatch, HOPPER)
    monkeypatch.setattr(codegen.CUDACodeLibrary, "_ensure_cc", lambda self, cc: cc or HOPPER)
    kernel, types = kernel_and_types(sweeps.MODES["fast"])
    made = _Kernel(kernel.py_func, types, **kernel.targetoptions)
    assert made.cooperative
    # An ELF file
    assert made._codelibrary.get_cubin(cc=HOPPER).code[:4] == b"\x7fELF"
