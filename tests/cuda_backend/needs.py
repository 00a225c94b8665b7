"""What tests of the CUDA backend skip without."""

from importlib.util import find_spec

import pytest


def _missing():
    if find_spec("numba_cuda") is None:
        return "numba-cuda is not installed (extra cuda)"
    from vtkmcvr.gpu.available import _toolkit_missing

    return _toolkit_missing() or ""


numba_cuda = pytest.mark.skipif(
    find_spec("numba_cuda") is None, reason="numba-cuda is not installed (extra cuda)"
)
compiler = pytest.mark.skipif(bool(_missing()), reason=_missing() or "NVVM is there")
