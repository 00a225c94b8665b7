"""What can go wrong with CUDA, in words that say what to do."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

CPU_INSTEAD = "or render with backend='cpu'"
SMALLER = "crop the volume, store it as int16 or uint8, render a smaller picture,"


class CudaError(RuntimeError):
    """CUDA was asked for and cannot do it."""


class CudaUnavailable(CudaError):
    """There is no device, or something that it takes is missing."""


class OutOfDeviceMemory(CudaError):
    """Scene and film do not fit."""


@contextmanager
def translated(doing: str) -> Iterator[None]:
    """Turn whatever numba-cuda raises into a `CudaError` that says what was going on."""
    try:
        yield
    except CudaError:
        raise
    # Its driver, compiler and linker have classes of their own, with nothing in common
    except Exception as error:
        if "OUT_OF_MEMORY" in str(error):
            raise OutOfDeviceMemory(
                f"out of device memory while {doing}: {SMALLER} {CPU_INSTEAD}"
            ) from error
        raise CudaError(
            f"CUDA failed while {doing}: {type(error).__name__}: {error}; {CPU_INSTEAD}"
        ) from error
