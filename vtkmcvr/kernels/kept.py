"""Tuples of any shape, kept in an array from one stage to the next, number by number.

All first numbers lie one behind the other, then all second ones, and so on: stages whose paths go
in SIMD lanes read and write those of neighbours at once.
"""

from llvmlite import ir
from numba import types
from numba.core import cgutils, errors
from numba.extending import intrinsic

BYTE, LONG = ir.IntType(8), ir.IntType(64)


def _numbers(kind):
    """Indices and type of every number of a tuple."""
    if not isinstance(kind, types.BaseTuple):
        return [((), kind)]
    return [((k, *more), x) for k, part in enumerate(kind) for more, x in _numbers(part)]


def _places(context, builder, places, array, i, kind):
    """Indices, type and address of every number at place i."""
    array = cgutils.create_struct_proxy(places)(context, builder, value=array)
    data = builder.bitcast(array.data, BYTE.as_pointer())
    n, above = cgutils.unpack_tuple(builder, array.shape, 1)[0], 0
    found = []
    for indices, number in _numbers(kind):
        if isinstance(number, types.NoneType):
            continue
        element = context.get_data_type(number)
        size = context.get_abi_sizeof(element)
        above = -(-above // size) * size
        start = builder.add(builder.mul(n, LONG(above)), builder.mul(i, LONG(size)))
        pointer = builder.bitcast(builder.gep(data, [start]), element.as_pointer())
        found.append((indices, number, pointer))
        above += size
    if above > places.dtype.count:
        raise ValueError(f"{kind} takes more than {places.dtype.count} bytes")
    return found


@intrinsic
def keep(typing, places, i, value, like):
    """Write a tuple of numbers, of the type of `like`, to place i of an array (n,) of bytes, "Sm".

    Another type is an error of compilation: `kept` reads the bytes of `like`.
    """
    if value != like:
        raise errors.TypingError(f"{value} is not kept as {like}")

    def emit(context, builder, sig, args):
        for indices, number, pointer in _places(context, builder, places, args[0], args[1], value):
            x = builder.extract_value(args[2], indices) if indices else args[2]
            model = context.data_model_manager[number]
            builder.store(model.as_data(builder, x), pointer)
        return context.get_dummy_value()

    return types.void(places, types.intp, value, like), emit


@intrinsic
def kept(typing, places, i, like):
    """Read what `keep` has written at place i, which was of the type of `like`."""

    def emit(context, builder, sig, args):
        found = context.get_constant_null(like)
        for indices, number, pointer in _places(context, builder, places, args[0], args[1], like):
            model = context.data_model_manager[number]
            x = model.from_data(builder, builder.load(pointer))
            found = builder.insert_value(found, x, indices) if indices else x
        return found

    return like(places, types.intp, like), emit
