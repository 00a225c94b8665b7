"""Kernel-only functions, made callable from Python."""

from numba import njit


def compiled(function):
    """Return a function that Python can call, around one that only kernels can.

    With NUMBA_DISABLE_JIT=1 the function is plain Python and comes back as it is.
    """
    if not hasattr(function, "py_func"):
        return function

    @njit(error_model="numpy")
    def call(*args):
        return function(*args)

    return call
