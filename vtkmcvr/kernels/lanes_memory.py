"""Lanes from arrays and back: side by side, or gathered from where each lane says."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from .jit import device
from .lanes import (
    BIT,
    ELEMENTS,
    F32,
    FLOAT,
    I32,
    INT,
    KINDS,
    LONG,
    U64,
    WIDTH,
    Lanes,
    constant,
    spread,
    vector,
)


def _pointer(context, builder, sig, args, element):
    """Pointer to element number args[1] of the array args[0], flat."""
    array = cgutils.create_struct_proxy(sig.args[0])(context, builder, value=args[0])
    offset = context.cast(builder, args[1], sig.args[1], types.intp)
    return builder.bitcast(builder.gep(array.data, [offset]), element.as_pointer())


@intrinsic
def load(typing, array, start):
    """`WIDTH` elements of a C-ordered array, from element `start` on."""
    lanes = Lanes(KINDS[array.dtype])

    def emit(context, builder, sig, args):
        pointer = _pointer(context, builder, sig, args, vector(ELEMENTS[lanes.kind]))
        return builder.load(pointer, align=4)

    return lanes(array, start), emit


@intrinsic
def store(typing, array, start, x):
    """Write lanes, or one number to all places, to a C-ordered array from element `start` on."""

    def emit(context, builder, sig, args):
        value = args[2] if isinstance(x, Lanes) else spread(builder, args[2])
        pointer = _pointer(context, builder, sig, args, value.type)
        builder.store(value, pointer, align=4)
        return context.get_dummy_value()

    return types.void(array, start, x), emit


def _gathered(builder, base, positions, element, align):
    """What is at each lane's position from `base` on: one instruction where the CPU has it."""
    pointers = builder.gep(base, [positions], source_etype=base.type.pointee)
    pointers.type = ir.VectorType(ir.PointerType(), WIDTH)
    of = vector(element)
    name = f"llvm.masked.gather.v{WIDTH}{element.intrinsic_name}.v{WIDTH}p0"
    kind = ir.FunctionType(of, [pointers.type, INT, vector(BIT), of])
    function = builder.module.declare_intrinsic(name, (), kind)
    arguments = pointers, INT(align), constant(BIT, 1), ir.Constant(of, ir.Undefined)
    return builder.call(function, arguments)


@intrinsic
def gather(typing, array, positions):
    """Element of an array of float32 or of unsigned integers at each lane's position, flat."""
    floats = array.dtype == types.float32

    def emit(context, builder, sig, args):
        data = cgutils.create_struct_proxy(array)(context, builder, value=args[0]).data
        element = context.get_data_type(array.dtype)
        found = _gathered(builder, data, args[1], element, array.dtype.bitwidth // 8)
        return found if floats else builder.zext(found, vector(INT))

    return (F32 if floats else I32)(array, positions), emit


def _neighbours(builder, dtype, both):
    """Floats of two elements that were read as one integer of twice their bits: (first, second)."""
    bits = dtype.bitwidth
    if isinstance(dtype, types.Float):
        second = builder.lshr(both, constant(both.type.element, bits))
        halves = (builder.trunc(x, vector(INT)) for x in (both, second))
        return [builder.bitcast(x, vector(FLOAT)) for x in halves]
    if both.type.element != INT:
        both = builder.zext(both, vector(INT))
    shift = builder.ashr if dtype.signed else builder.lshr
    rest, half = constant(INT, 32 - bits), constant(INT, 32 - 2 * bits)
    return [
        builder.sitofp(shift(builder.shl(both, above), rest), vector(FLOAT))
        for above in (rest, half)
    ]


@intrinsic
def gather_neighbours(typing, array, positions, row, plane):
    """Floats of a C-ordered array at each lane's position and the next one.

    The same `row`, `plane` and both elements further on: a tuple of eight.
    """

    def emit(context, builder, sig, args):
        bits = array.dtype.bitwidth
        data = cgutils.create_struct_proxy(array)(context, builder, value=args[0]).data
        base = builder.bitcast(data, ir.IntType(bits).as_pointer())
        row, plane = (context.cast(builder, args[k], sig.args[k], types.intp) for k in (2, 3))
        ahead = (None, row, plane, builder.add(row, plane))
        bases = [base if step is None else builder.gep(base, [step]) for step in ahead]
        pair = ir.IntType(2 * bits)
        found = [_gathered(builder, base, args[1], pair, bits // 8) for base in bases]
        floats = [x for both in found for x in _neighbours(builder, array.dtype, both)]
        return context.make_tuple(builder, sig.return_type, floats)

    return types.UniTuple(F32, 8)(array, positions, row, plane), emit


@intrinsic
def gather_pair(typing, table, positions):
    """Floats of a float32 table at each lane's position and the next one."""

    def emit(context, builder, sig, args):
        data = cgutils.create_struct_proxy(table)(context, builder, value=args[0]).data
        found = _gathered(builder, data, args[1], LONG, 4)
        return context.make_tuple(
            builder, sig.return_type, _neighbours(builder, table.dtype, found)
        )

    return types.UniTuple(F32, 2)(table, positions), emit


@intrinsic
def _offset(typing, i, j, k, row, plane):
    """Position i + j row + k plane, as 64 bits."""

    def emit(context, builder, sig, args):
        row, plane = (context.cast(builder, args[n], types.intp, types.int64) for n in (3, 4))
        row = spread(builder, builder.trunc(row, INT))
        in_plane = builder.zext(builder.add(args[0], builder.mul(args[1], row)), vector(LONG))
        planes = builder.mul(builder.zext(args[2], vector(LONG)), spread(builder, plane))
        return builder.add(in_plane, planes)

    return U64(i, j, k, row, plane), emit


@device
def corners(values, i, j, k):
    """`grid.corners` of lanes."""
    _, ny, nx = values.shape
    return gather_neighbours(values, _offset(i, j, k, nx, nx * ny), nx, nx * ny)


@device
def point(rows, i, j, k):
    """`labels.point` of lanes."""
    _, ny, nx = rows.shape
    return gather(rows, _offset(i, j, k, nx, nx * ny))
