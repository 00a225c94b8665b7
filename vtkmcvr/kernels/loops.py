"""What LLVM is told of loops: which turns it may run side by side, and what it shall unroll.

LLVM's loop vectoriser runs turns in lanes of SIMD registers, and makes masks of branches by itself.
What it cannot see is that turns have nothing to do with each other: that no two of them write to
the same place of one of so many arrays. Where it can't, as with a loop inside the loop, one turn
follows the other.
"""

from __future__ import annotations

from collections.abc import Iterable

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

# Turns, and numbers, side by side
WIDTH = 16
INT = ir.IntType(32)


@intrinsic
def apart(typing):
    """Say that the turns of the loop around this call have nothing to do with each other."""
    return types.void(), lambda context, builder, sig, args: context.get_dummy_value()


class _Distinct(ir.MDValue):
    """Metadata that is like no other, and may name itself."""

    names_itself = False

    def descr(self, buf):
        operands = [self] * self.names_itself + list(self.operands)
        names = ", ".join(x.get_reference() for x in operands)
        buf += (f"distinct !{{ {names} }}", "\n")


def _distinct(module, operands=()):
    return _Distinct(module, operands, str(len(module.metadata)))


def accesses(module: ir.Module) -> ir.MDValue:
    """Name for accesses of memory that have nothing to do with those of another turn."""
    return _distinct(module)


def _fact(module, name, *values):
    return module.add_metadata([ir.MetaDataString(module, name), *values])


def _tell(module, backs, facts):
    loop = _distinct(module, facts)
    loop.names_itself = True
    for jump in backs:
        jump.set_metadata("llvm.loop", loop)


def put_side_by_side(module: ir.Module, group: ir.MDValue, backs: Iterable, blocks: Iterable):
    """Have LLVM run the turns of a loop in lanes.

    `backs` are the jumps back to its head, `blocks` all that it is made of. `group` is the kernel's
    own `accesses`: LLVM may make one access of those of several loops.
    """
    facts = [
        _fact(module, "llvm.loop.parallel_accesses", group),
        _fact(module, "llvm.loop.vectorize.width", ir.Constant(INT, WIDTH)),
        _fact(module, "llvm.loop.interleave.count", ir.Constant(INT, 1)),
    ]
    _tell(module, backs, facts)
    for block in blocks:
        for instruction in block.instructions:
            if instruction.opname in ("load", "store", "call"):
                instruction.set_metadata("llvm.access.group", group)


def unroll(module: ir.Module, backs: Iterable) -> None:
    """Have LLVM write a loop's turns one after the other, whose number it knows."""
    _tell(module, backs, [_fact(module, "llvm.loop.unroll.full")])
