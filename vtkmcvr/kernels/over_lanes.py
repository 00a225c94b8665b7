"""Kernel-only functions of scalars, compiled once more over lanes of SIMD registers."""

from types import FunctionType

from .jit import device
from .lanes import as_is, bits_float, float_bits, select, to_float, to_int
from .lanes_memory import corners, gather_pair, point

# What sources of scalar functions find under these names when they are compiled over lanes
_meanings = {
    "f32": to_float, "i32": to_int, "i64": as_is, "index": as_is, "select": select,
    "corners": corners, "point": point, "entries": gather_pair,
    "float_bits": float_bits, "bits_float": bits_float,
}  # fmt: skip


def over_lanes(function):
    """Compile the source of a kernel-only function once more, over lanes.

    Functions that it calls are those that went through here before, or take lanes as they are.
    """
    source = getattr(function, "py_func", function)
    twin = FunctionType(
        source.__code__, {**source.__globals__, **_meanings}, source.__name__,
        source.__defaults__, source.__closure__,
    )  # fmt: skip
    twin.__qualname__, twin.__module__ = source.__qualname__, source.__module__
    _meanings[source.__name__] = compiled = device(twin)
    return compiled
