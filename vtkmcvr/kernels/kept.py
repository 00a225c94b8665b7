"""Tuples of any shape, kept in an array of bytes from one loop to the next."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

# Bytes of a place
PLACE = 256


def _pointer(context, builder, places, array, i, value):
    element = context.get_value_type(value)
    if context.get_abi_sizeof(element) > PLACE:
        raise ValueError(f"{value} takes more than {PLACE} bytes")
    data = cgutils.create_struct_proxy(places)(context, builder, value=array).data
    start = builder.mul(i, ir.Constant(i.type, PLACE))
    return builder.bitcast(builder.gep(data, [start]), element.as_pointer())


@intrinsic
def keep(typing, places, i, value):
    """Write a tuple of numbers to place i of an array (n, PLACE) of uint8."""

    def emit(context, builder, sig, args):
        pointer = _pointer(context, builder, places, args[0], args[1], value)
        builder.store(args[2], pointer, align=8)
        return context.get_dummy_value()

    return types.void(places, types.intp, value), emit


@intrinsic
def kept(typing, places, i, like):
    """Read what `keep` has written at place i, which was of the type of `like`."""

    def emit(context, builder, sig, args):
        pointer = _pointer(context, builder, places, args[0], args[1], like)
        return builder.load(pointer, align=8)

    return like(places, types.intp, like), emit
