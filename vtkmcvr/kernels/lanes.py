"""Numbers side by side in SIMD registers, as a type of Numba's: kernels compute with 16 at a time.

A function of scalars becomes one of lanes where `over_lanes` compiles its source once more, with
lanes for its conversions; operators, `min` and `max` take lanes as they are. Branches on lanes do
not exist: `select` takes the place of `if`. LLVM makes of 16 lanes what the CPU has: two registers
with AVX2, one with AVX-512, four with SSE or NEON.
"""

import operator

from llvmlite import ir
from numba import types
from numba.core.datamodel import PrimitiveModel
from numba.core.imputils import lower_builtin, lower_cast
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, register_model

from .jit import device
from .loops import WIDTH

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
        super().__init__(manager, lanes, vector(ELEMENTS[lanes.kind]))


F32, I32, U64, BOOL = Lanes("f32"), Lanes("i32"), Lanes("u64"), Lanes("bool")


def vector(element):
    """LLVM type of lanes."""
    return ir.VectorType(element, WIDTH)


def constant(element, value):
    """One number in all lanes."""
    return ir.Constant(vector(element), [value] * WIDTH)


def spread(builder, scalar):
    """A scalar in all lanes."""
    undefined = ir.Constant(vector(scalar.type), ir.Undefined)
    first = builder.insert_element(undefined, scalar, INT(0))
    return builder.shuffle_vector(first, undefined, constant(INT, 0))


def _as_lanes(context, builder, value, kind, lanes):
    if isinstance(kind, Lanes):
        return value
    return spread(builder, context.cast(builder, value, kind, SCALARS[lanes.kind]))


@lower_cast(types.Number, Lanes)
def _scalar_to_lanes(context, builder, fromty, toty, value):
    return spread(builder, value)


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
            return builder.uitofp(builder.trunc(args[0], vector(INT)), vector(FLOAT))
        return builder.sitofp(args[0], vector(FLOAT))

    return F32(x), emit


@intrinsic
def to_int(typing, x):
    """int32 of a scalar or of lanes of floats."""
    if not isinstance(x, Lanes):
        return types.int32(x), _cast
    if x.kind == "i32":
        return I32(x), lambda context, builder, sig, args: args[0]
    return I32(x), lambda context, builder, sig, args: builder.fptosi(args[0], vector(INT))


def _cast(context, builder, sig, args):
    return context.cast(builder, args[0], sig.args[0], sig.return_type)


@intrinsic
def float_bits(typing, x):
    """Bits of float lanes."""
    return I32(x), lambda context, builder, sig, args: builder.bitcast(args[0], vector(INT))


@intrinsic
def bits_float(typing, x):
    """Float lanes of some bits."""
    return F32(x), lambda context, builder, sig, args: builder.bitcast(args[0], vector(FLOAT))


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
