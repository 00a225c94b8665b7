"""What tests of the CUDA backend skip without."""

import os
from importlib.util import find_spec

import pytest


def _missing():
    if os.environ.get("NUMBA_DISABLE_JIT") == "1":
        return "NUMBA_DISABLE_JIT=1: nothing is compiled"
    if find_spec("numba_cuda") is None:
        return "numba-cuda is not installed (extra cuda)"
    from vtkmcvr.gpu.available import _toolkit_missing

    return _toolkit_missing() or ""


numba_cuda = pytest.mark.skipif(
    find_spec("numba_cuda") is None, reason="numba-cuda is not installed (extra cuda)"
)
compiler = pytest.mark.skipif(bool(_missing()), reason=_missing() or "NVVM is there")
