"""Tuples of any shape, kept in an array from one stage to the next."""

from llvmlite import ir
from numba import types
from numba.core import cgutils, errors
from numba.extending import intrinsic


def _place(context, builder, places, array, i, value):
    element, room = context.get_value_type(value), places.dtype.count
    if context.get_abi_sizeof(element) > room:
        raise ValueError(f"{value} takes more than {room} bytes")
    data = cgutils.create_struct_proxy(places)(context, builder, value=array).data
    start = builder.mul(i, ir.Constant(i.type, room))
    data = builder.bitcast(data, ir.IntType(8).as_pointer())
    return builder.bitcast(builder.gep(data, [start]), element.as_pointer())


@intrinsic
def keep(typing, places, i, value, like):
    """Write a tuple of numbers, of the type of `like`, to place i of an array (n,) of bytes, "Sm".

    Another type is an error of compilation: `kept` reads the bytes of `like`.
    """
    if value != like:
        raise errors.TypingError(f"{value} is not kept as {like}")

    def emit(context, builder, sig, args):
        pointer = _place(context, builder, places, args[0], args[1], value)
        builder.store(args[2], pointer, align=8)
        return context.get_dummy_value()

    return types.void(places, types.intp, value, like), emit


@intrinsic
def kept(typing, places, i, like):
    """Read what `keep` has written at place i, which was of the type of `like`."""

    def emit(context, builder, sig, args):
        pointer = _place(context, builder, places, args[0], args[1], like)
        return builder.load(pointer, align=8)

    return like(places, types.intp, like), emit
