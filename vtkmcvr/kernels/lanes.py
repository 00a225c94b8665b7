"""Numbers side by side in SIMD registers, as a type of Numba's: kernels compute with 16 at a time.

A function of scalars becomes one of lanes where `over_lanes` compiles its source once more, with
lanes for its conversions; operators, `min` and `max` take lanes as they are. Branches on lanes do
not exist: `select` takes the place of `if`. LLVM makes of 16 lanes what the CPU has: two registers
with AVX2, one with AVX-512, four with SSE or NEON.
"""

import operator
from types import FunctionType

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.datamodel import PrimitiveModel
from numba.core.imputils import lower_builtin, lower_cast
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, register_model

from .jit import device

WIDTH = 16
BIT, INT, LONG, FLOAT = ir.IntType(1), ir.IntType(32), ir.IntType(64), ir.FloatType()
ELEMENTS = {"f32": FLOAT, "i32": INT, "u64": LONG, "bool": BIT}
SCALARS = {"f32": types.float32, "i32": types.int32, "u64": types.uint64}
KINDS = {scalar: kind for kind, scalar in SCALARS.items()}
NUMBERS, WHOLE = ("f32", "i32", "u64"), ("i32", "u64", "bool")


class Lanes(types.Type):
    """`WIDTH` numbers of a kind."""

    def __init__(self, kind: str):
        self.kind = kind
        super().__init__(name=f"{WIDTH} x {kind}")

    def can_convert_from(self, typing, other):
        """Where one branch has a scalar and the other one lanes, the scalar becomes lanes."""
        return Conversion.safe if other == SCALARS.get(self.kind) else None


@register_model(Lanes)
class _LanesModel(PrimitiveModel):
    def __init__(self, manager, lanes):
        super().__init__(manager, lanes, _vector(ELEMENTS[lanes.kind]))


F32, I32, U64, BOOL = Lanes("f32"), Lanes("i32"), Lanes("u64"), Lanes("bool")


def _vector(element):
    return ir.VectorType(element, WIDTH)


def _constant(element, value):
    return ir.Constant(_vector(element), [value] * WIDTH)


def _spread(builder, scalar):
    undefined = ir.Constant(_vector(scalar.type), ir.Undefined)
    first = builder.insert_element(undefined, scalar, INT(0))
    return builder.shuffle_vector(first, undefined, _constant(INT, 0))


def _as_lanes(context, builder, value, kind, lanes):
    if isinstance(kind, Lanes):
        return value
    return _spread(builder, context.cast(builder, value, kind, SCALARS[lanes.kind]))


@lower_cast(types.Number, Lanes)
def _scalar_to_lanes(context, builder, fromty, toty, value):
    return _spread(builder, value)


# Operators


def _between(kinds, args):
    """Lanes of an operator, None where it has none of these kinds."""
    found = {a for a in args if isinstance(a, Lanes)}
    if len(args) != 2 or len(found) != 1 or not all(
        isinstance(a, (Lanes, types.Float, types.Integer)) for a in args
    ):  # fmt: skip
        return None
    lanes = found.pop()
    return lanes if lanes.kind in kinds else None


def _define(function, kinds, emit, result=None):
    """Have Numba compile `function(a, b)` where one or both are lanes."""

    class Template(AbstractTemplate):
        def generic(self, args, kws):
            lanes = _between(kinds, args)
            return signature(result or lanes, *args) if lanes else None

    def lower(context, builder, sig, args):
        lanes = _between(kinds, sig.args)
        a, b = (
            _as_lanes(context, builder, value, kind, lanes)
            for value, kind in zip(args, sig.args, strict=True)
        )
        return emit(builder, lanes.kind, a, b)

    infer_global(function)(Template)
    for kind in (Lanes, types.Float, types.Integer):
        lower_builtin(function, Lanes, kind)(lower)
        lower_builtin(function, kind, Lanes)(lower)


def _instruction(of_floats, of_integers):
    def emit(builder, kind, a, b):
        return getattr(builder, of_floats if kind == "f32" else of_integers)(a, b)

    return emit


def _compare(builder, sign, kind, a, b):
    if kind == "f32":
        return builder.fcmp_ordered(sign, a, b)
    if kind == "u64":
        return builder.icmp_unsigned(sign, a, b)
    return builder.icmp_signed(sign, a, b)


def _comparison(sign):
    return lambda builder, kind, a, b: _compare(builder, sign, kind, a, b)


def _extreme(sign):
    # As Numba's own: the first where either is NaN
    return lambda builder, kind, a, b: builder.select(_compare(builder, sign, kind, b, a), b, a)


_define(operator.add, NUMBERS, _instruction("fadd", "add"))
_define(operator.sub, NUMBERS, _instruction("fsub", "sub"))
_define(operator.mul, NUMBERS, _instruction("fmul", "mul"))
_define(operator.truediv, ("f32",), _instruction("fdiv", ""))
_define(operator.and_, WHOLE, _instruction("", "and_"))
_define(operator.or_, WHOLE, _instruction("", "or_"))
_define(operator.xor, WHOLE, _instruction("", "xor"))
_define(operator.lshift, ("i32", "u64"), _instruction("", "shl"))
_define(
    operator.rshift, ("i32", "u64"),
    lambda builder, kind, a, b: builder.ashr(a, b) if kind == "i32" else builder.lshr(a, b),
)  # fmt: skip
for _function, _sign in (
    (operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">="),
    (operator.eq, "=="),
):  # fmt: skip
    _define(_function, NUMBERS, _comparison(_sign), BOOL)
_define(min, ("f32", "i32"), _extreme("<"))
_define(max, ("f32", "i32"), _extreme(">"))


@infer_global(operator.neg)
class _Negation(AbstractTemplate):
    def generic(self, args, kws):
        return signature(F32, F32) if args == (F32,) else None


@lower_builtin(operator.neg, Lanes)
def _negate(context, builder, sig, args):
    return builder.fneg(args[0])


# Conversions and choices


@intrinsic
def select(typing, condition, a, b):
    """Lane by lane, a where the condition holds, else b."""
    lanes = next((x for x in (a, b) if isinstance(x, Lanes)), None) or Lanes(KINDS[a])

    def emit(context, builder, sig, args):
        a, b = (
            _as_lanes(context, builder, args[k], sig.args[k], lanes) for k in (1, 2)
        )  # fmt: skip
        return builder.select(args[0], a, b)

    return lanes(condition, a, b), emit


@intrinsic
def opposite(typing, condition):
    """Lane by lane, whether a condition does not hold."""
    return condition(condition), lambda context, builder, sig, args: builder.not_(args[0])


@intrinsic
def to_float(typing, x):
    """float32 of a scalar or of lanes; of u64 lanes, those below 2^32."""
    if not isinstance(x, Lanes):
        return types.float32(x), _cast

    def emit(context, builder, sig, args):
        if x.kind == "u64":
            return builder.uitofp(builder.trunc(args[0], _vector(INT)), _vector(FLOAT))
        return builder.sitofp(args[0], _vector(FLOAT))

    return F32(x), emit


@intrinsic
def to_int(typing, x):
    """int32 of a scalar or of lanes of floats."""
    if not isinstance(x, Lanes):
        return types.int32(x), _cast
    if x.kind == "i32":
        return I32(x), lambda context, builder, sig, args: args[0]
    return I32(x), lambda context, builder, sig, args: builder.fptosi(args[0], _vector(INT))


def _cast(context, builder, sig, args):
    return context.cast(builder, args[0], sig.args[0], sig.return_type)


@intrinsic
def float_bits(typing, x):
    """Bits of float lanes."""
    return I32(x), lambda context, builder, sig, args: builder.bitcast(args[0], _vector(INT))


@intrinsic
def bits_float(typing, x):
    """Float lanes of some bits."""
    return F32(x), lambda context, builder, sig, args: builder.bitcast(args[0], _vector(FLOAT))


@device
def as_is(x):
    """Lanes need no conversion to an index."""
    return x


@intrinsic
def mask(typing, condition):
    """Bit k tells whether a condition holds in lane k."""

    def emit(context, builder, sig, args):
        return builder.zext(builder.bitcast(args[0], ir.IntType(WIDTH)), INT)

    return types.uint32(condition), emit


@intrinsic
def highest_bit(typing, bits):
    """Number of the highest bit that is set."""

    def emit(context, builder, sig, args):
        zeros = builder.ctlz(args[0], BIT(1))
        return builder.zext(builder.sub(INT(31), zeros), LONG)

    return types.intp(types.uint32), emit


# Memory


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
        pointer = _pointer(context, builder, sig, args, _vector(ELEMENTS[lanes.kind]))
        return builder.load(pointer, align=4)

    return lanes(array, start), emit


@intrinsic
def store(typing, array, start, x):
    """Write lanes to a C-ordered array, from element `start` on."""

    def emit(context, builder, sig, args):
        pointer = _pointer(context, builder, sig, args, _vector(ELEMENTS[x.kind]))
        builder.store(args[2], pointer, align=4)
        return context.get_dummy_value()

    return types.void(array, start, x), emit


def _gathered(builder, bases, positions, element, align):
    """One vector a base: what is there at each lane's position."""
    out = [ir.Constant(_vector(element), ir.Undefined)] * len(bases)
    for lane in range(WIDTH):
        position = builder.extract_element(positions, INT(lane))
        if position.type == INT:
            position = builder.zext(position, LONG)
        for k, base in enumerate(bases):
            pointer = builder.bitcast(builder.gep(base, [position]), element.as_pointer())
            out[k] = builder.insert_element(out[k], builder.load(pointer, align=align), INT(lane))
    return out


@intrinsic
def gather(typing, array, positions):
    """Element of an array of float32 or of unsigned integers at each lane's position, flat."""
    floats = array.dtype == types.float32

    def emit(context, builder, sig, args):
        data = cgutils.create_struct_proxy(array)(context, builder, value=args[0]).data
        element = context.get_data_type(array.dtype)
        found = _gathered(builder, [data], args[1], element, array.dtype.bitwidth // 8)[0]
        return found if floats else builder.zext(found, _vector(INT))

    return (F32 if floats else I32)(array, positions), emit


def _neighbours(builder, dtype, both):
    """Floats of two elements that were read as one integer of twice their bits: (first, second)."""
    bits = dtype.bitwidth
    if isinstance(dtype, types.Float):
        second = builder.lshr(both, _constant(both.type.element, bits))
        halves = (builder.trunc(x, _vector(INT)) for x in (both, second))
        return [builder.bitcast(x, _vector(FLOAT)) for x in halves]
    if both.type.element != INT:
        both = builder.zext(both, _vector(INT))
    shift = builder.ashr if dtype.signed else builder.lshr
    rest, half = _constant(INT, 32 - bits), _constant(INT, 32 - 2 * bits)
    return [
        builder.sitofp(shift(builder.shl(both, above), rest), _vector(FLOAT))
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
        found = _gathered(builder, bases, args[1], ir.IntType(2 * bits), bits // 8)
        floats = [x for both in found for x in _neighbours(builder, array.dtype, both)]
        return context.make_tuple(builder, sig.return_type, floats)

    return types.UniTuple(F32, 8)(array, positions, row, plane), emit


@intrinsic
def gather_pair(typing, table, positions):
    """Floats of a float32 table at each lane's position and the next one."""

    def emit(context, builder, sig, args):
        data = cgutils.create_struct_proxy(table)(context, builder, value=args[0]).data
        found = _gathered(builder, [data], args[1], LONG, 4)[0]
        return context.make_tuple(
            builder, sig.return_type, _neighbours(builder, table.dtype, found)
        )

    return types.UniTuple(F32, 2)(table, positions), emit


@intrinsic
def _offset(typing, i, j, k, row, plane):
    """Position i + j row + k plane, as 64 bits."""

    def emit(context, builder, sig, args):
        row, plane = (context.cast(builder, args[n], types.intp, types.int64) for n in (3, 4))
        row = _spread(builder, builder.trunc(row, INT))
        in_plane = builder.zext(builder.add(args[0], builder.mul(args[1], row)), _vector(LONG))
        planes = builder.mul(builder.zext(args[2], _vector(LONG)), _spread(builder, plane))
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
