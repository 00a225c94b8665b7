"""Every Numba option of the project, and what keeps its on-disk cache honest.

Numba's own cache looks at the file that holds a function and not at the functions it calls: after
an edit of `grid.py`, a cached `path.py` would go on running the old code. Here all kernels carry
one stamp over all kernel sources, so that any edit rebuilds them all.
"""

from __future__ import annotations

import functools
import hashlib
import pickle
from collections.abc import Callable
from pathlib import Path

from numba import njit
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.registry import CPUDispatcher

from .compilers import DeviceCompiler, KernelCompiler, LaunchedCompiler
from .launch import Launched
from .linked_cache import DeviceCacheImpl

# No "nnan" and no "ninf": kernels use NaN voxels and infinite distances on purpose.
FAST_MATH = {"nsz", "contract", "arcp", "afn", "reassoc"}


@functools.cache
def source_stamp() -> str:
    """Hash of the sources that compiled kernels depend on."""
    here = Path(__file__).parent
    digest = hashlib.sha256()
    for source in sorted([*here.glob("*.py"), *(here.parent / "packed").glob("*.py")]):
        digest.update(source.read_bytes())
    return digest.hexdigest()


class CheckedCacheFile(IndexDataCacheFile):
    """Index and data files of a function, where a data file says what it holds.

    Numba numbers data files by what it has read of the index. Two processes that compile at once
    may give one number to two combinations of types, and one of them would then run the other's
    machine code; or meet a file that an older source has left under that number.
    """

    def save(self, key, data):
        """Save what was compiled for some types."""
        super().save(key, (self._version, key, data))

    def load(self, key):
        """Load what was compiled for some types; None where there is nothing, or something else."""
        try:
            found = super().load(key)
        except UNREADABLE:
            return None
        if not isinstance(found, tuple) or found[:2] != (self._version, key):
            return None
        return found[2]


# What unpickling a file of other sources may raise
UNREADABLE = (pickle.UnpicklingError, EOFError, AttributeError, ImportError, LookupError, TypeError)


class _StampedCache(FunctionCache):
    """Numba's on-disk cache, fresh while neither its file nor a kernel source has changed.

    The stamp is part of the version, which is read before the index: an index of an older vtkmcvr
    may name classes that are gone.
    """

    def __init__(self, py_func: Callable):
        super().__init__(py_func)
        self._cache_file = CheckedCacheFile(
            self._cache_path, self._impl.filename_base, self._impl.locator.get_source_stamp()
        )
        self._cache_file._version = f"{self._cache_file._version} {source_stamp()}"


class _StampedDeviceCache(_StampedCache):
    _impl_class = DeviceCacheImpl


class _KernelOnly(CPUDispatcher):
    """A function that has no machine code of its own."""

    def __call__(self, *args, **kwargs):
        raise TypeError(
            f"{self.py_func.__name__} is a part of kernels and cannot be called from Python; "
            "call it from a function of your own that numba.njit compiles"
        )


def _cached(dispatcher, cache=_StampedCache):
    # With NUMBA_DISABLE_JIT=1 `njit` returns the plain function, which has no cache to stamp.
    if hasattr(dispatcher, "py_func"):
        dispatcher._cache = cache(dispatcher.py_func)
    return dispatcher


def _kernel_only(dispatcher):
    if hasattr(dispatcher, "py_func"):
        dispatcher.__class__ = _KernelOnly
    return _cached(dispatcher, _StampedDeviceCache)


# Kernels allocate nothing, so Numba's reference counting is left out of them: it would count every
# array of the scene up and down, atomically, at each call of a function (445 calls in a path, or
# 14). No function is called back from C.
KERNEL = {
    "error_model": "numpy",
    "fastmath": FAST_MATH,
    "no_cfunc_wrapper": True,
    "_nrt": False,
}

DEVICE = {
    **KERNEL,
    "forceinline": True,
    "no_cpython_wrapper": True,
    "pipeline_class": DeviceCompiler,
}


def device(function: Callable):
    """Compile a function that only kernels call, on the CPU and (re-compiled) on CUDA.

    It ends as LLVM code for kernels to link in (see `linked`); a call from Python is an error.
    """
    return _kernel_only(njit(**DEVICE)(function))


def exact(function: Callable):
    """Compile a kernel-only function whose roundings must be those that are written down."""
    return _kernel_only(njit(**{**DEVICE, "fastmath": False})(function))


def glue(function: Callable):
    """Merge a function into its callers before they are typed, instead of compiling it by itself.

    For functions that hand the whole scene on: as functions of their own they would take hundreds
    of arguments, a second of compilation each. They must not test their arguments for None, because
    branches are pruned before the merge.
    """
    return njit(inline="always", **KERNEL)(function)


def kernel(function: Callable):
    """Compile a function that Python calls, which runs without the GIL and allocates nothing."""
    compiled = njit(nogil=True, pipeline_class=KernelCompiler, **KERNEL)(function)
    return _cached(compiled)


def launched(function: Callable):
    """`kernel` for one that takes a film and a scene: called by way of a block of words."""
    dispatcher = njit(nogil=True, pipeline_class=LaunchedCompiler, **KERNEL)(function)
    return _cached(Launched.of(dispatcher))


def entry_point(function: Callable):
    """Compile a function that Python calls; it may allocate arrays, and releases the GIL."""
    return _cached(njit(error_model="numpy", fastmath=FAST_MATH, nogil=True)(function))
