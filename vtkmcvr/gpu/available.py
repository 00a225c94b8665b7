"""Whether there is a CUDA device, and all that it takes."""

from __future__ import annotations

import ctypes
import functools
import os
import sys
from importlib import import_module
from importlib.util import find_spec

from .errors import CPU_INSTEAD

INSTALL = 'pip install "vtkmcvr[cuda]"'


@functools.cache
def missing() -> str | None:
    """What keeps CUDA from being used, and what to do; None where it can be used.

    Quick where there is none: the driver is looked for before numba-cuda is loaded.
    """
    if find_spec("numba_cuda") is None:
        return f"numba-cuda is not installed: {INSTALL}, {CPU_INSTEAD}"
    if not _driver_found():
        return f"there is no NVIDIA driver ({_driver_name()}): install one, {CPU_INSTEAD}"
    try:
        return _device_missing() or _toolkit_missing()
    except Exception as error:  # numba-cuda and its driver fail in many ways
        return f"numba-cuda cannot be used ({type(error).__name__}: {error}), {CPU_INSTEAD}"


def _driver_name() -> str:
    return "nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1"


def _driver_found() -> bool:
    try:
        ctypes.CDLL(_driver_name())
    except OSError:
        return False
    return True


def _device_missing() -> str | None:
    from numba import cuda

    error = cuda.cuda_error()
    if error is None and len(cuda.gpus) > 0:
        return None
    visible = os.environ.get("CUDA_VISIBLE_DEVICES")
    hint = "" if visible is None else f"; CUDA_VISIBLE_DEVICES is {visible!r}"
    why = f"{error or 'none is visible'}{hint}"
    return f"the NVIDIA driver has no device for us ({why}), {CPU_INSTEAD}"


def _toolkit_missing() -> str | None:
    """NVVM compiles, NVRTC knows the architectures; both come with the extra."""
    try:
        import_module("numba.cuda.cudadrv.nvvm").NVVM()
    except Exception as error:
        return f"NVVM was not found ({error}): {INSTALL}, {CPU_INSTEAD}"
    try:
        import_module("numba.cuda.cudadrv.nvrtc").get_supported_ccs()
    except Exception as error:
        return f"NVRTC was not found ({error}): {INSTALL}, {CPU_INSTEAD}"
    return None
