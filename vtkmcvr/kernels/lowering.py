"""Lowering of kernels to LLVM code: variables that are assigned once are values, not memory.

LLVM is told of loops what `loops` says. And kernels that take a scene get a way in that reads their
arguments from a block of words.

Numba gives every variable that is used in more than one block a place on the stack, to be loaded
whole wherever it is read, and LLVM takes all of them apart again. For a scene, a tuple of hundreds
of numbers that is read everywhere, this is most of its work.

This leans on parts of Numba that it does not document: `Lower._find_singly_assigned_variable`,
which makes values of variables that live in one block only, `Lower.lower_function_body` and
`lower_block`, and `Lower.create_cpython_wrapper`.
"""

from collections import Counter, defaultdict

from llvmlite import ir as llvm
from numba.core import analysis, ir, types
from numba.core.compiler_machinery import register_pass
from numba.core.lowering import Lower
from numba.core.typed_passes import NativeLowering

from .loops import accesses, apart, put_side_by_side, unroll


class _LowerValues(Lower):
    def _find_singly_assigned_variable(self):
        """Find the variables that can be values: assigned once, before every use."""
        self._singly_assigned_vars = assigned_before_use(self.blocks, ir.Assign, analysis)
        self._blk_local_varmap = {}

    def lower_function_body(self):
        """Lower the body, and tell LLVM what it does not see of its loops."""
        self._lowered = {}
        tail = super().lower_function_body()
        cfg, group = analysis.compute_cfg_from_blocks(self.blocks), None
        for loop in cfg.loops().values():
            jumps_back = [
                self._lowered[label][-1].terminator
                for label, _ in cfg.predecessors(loop.header)
                if label in loop.body
            ]
            if any(self._is_apart(self.blocks[label]) for label in loop.body):
                inside = [block for label in loop.body for block in self._lowered[label]]
                group = group or accesses(self.module)
                put_side_by_side(self.module, group, jumps_back, inside)
            elif self._is_over_tuple(self.blocks[loop.header]):
                unroll(self.module, jumps_back)
        return tail

    def lower_block(self, block):
        """Lower a block, and keep what it becomes: the last one ends in its jump."""
        before = len(self.function.blocks)
        [label] = [k for k, b in self.blocks.items() if b is block]
        super().lower_block(block)
        last = self.builder.basic_block
        more = [b for b in self.function.blocks[before:] if b is not last]
        self._lowered[label] = [self.blkmap[label], *more, last]

    def _is_apart(self, block):
        calls = (self.typeof(call.func.name) for call in block.find_exprs("call"))
        return any(getattr(kind, "typing_key", None) is apart for kind in calls)

    def _is_over_tuple(self, head):
        steps = head.find_exprs("iternext")
        return any(isinstance(self.typeof(x.value.name), types.UniTupleIter) for x in steps)


def assigned_before_use(blocks, assign, analysis):
    """Variables with one assignment, whose block dominates and precedes all that read them.

    `assign` is the type of assignments, `analysis` Numba's module of that name or numba-cuda's.
    """
    times, where = Counter(), {}
    for label, block in blocks.items():
        for assignment in block.find_insts(assign):
            times[assignment.target.name] += 1
            where[assignment.target.name] = label
    users = defaultdict(set)
    # Without those that a block itself assigns
    for label, names in analysis.compute_use_defs(blocks).usemap.items():
        for name in names:
            users[name].add(label)
    dominators = analysis.compute_cfg_from_blocks(blocks).dominators()
    in_memory = analysis.must_use_alloca(blocks)
    return {
        name
        for name, label in where.items()
        if times[name] == 1
        and name not in in_memory
        and all(label < user and label in dominators[user] for user in users[name])
    }


@register_pass(mutates_CFG=True, analysis_only=False)
class ValueLowering(NativeLowering):
    """Numba's last pass but one, by `_LowerValues`."""

    _name = "value_lowering"
    lowering_class = _LowerValues


INT, LONG = llvm.IntType(32), llvm.IntType(64)


class _LowerLaunched(_LowerValues):
    def pre_lower(self):
        """Begin a kernel, of which the way in would have a copy."""
        self.function.attributes.add("noinline")
        super().pre_lower()

    def create_cpython_wrapper(self, release_gil=False):
        """Make the way in, under the name of Numba's own: status of f(address of the words).

        Numba's takes Python's objects apart, one after the other, which for a film and a scene is a
        sixth of all there is to compile.
        """
        module = self.context.create_module("way in")
        kind = self.context.call_conv.get_function_type(self.fndesc.restype, self.fndesc.argtypes)
        kernel = llvm.Function(module, kind, self.fndesc.llvm_func_name)
        name = self.fndesc.llvm_cpython_wrapper_name
        way_in = llvm.Function(module, llvm.FunctionType(INT, [LONG.as_pointer()]), name)
        builder = llvm.IRBuilder(way_in.append_basic_block())
        result, error = (builder.alloca(place.pointee) for place in kind.args[:2])
        builder.store(llvm.Constant(error.type.pointee, None), error)
        words = [
            _word(builder, builder.gep(way_in.args[0], [LONG(k)]), element)
            for k, element in enumerate(kind.args[2:])
        ]
        builder.ret(builder.call(kernel, [result, error, *words]))
        self.library.add_ir_module(module)


def _word(builder, place, kind):
    """What a word holds: its lowest bits."""
    if kind == llvm.IntType(1):
        return builder.trunc(builder.load(place), kind)
    return builder.load(builder.bitcast(place, kind.as_pointer()))


@register_pass(mutates_CFG=True, analysis_only=False)
class LaunchedLowering(NativeLowering):
    """Numba's last pass but one, by `_LowerLaunched`."""

    _name = "launched_lowering"
    lowering_class = _LowerLaunched
