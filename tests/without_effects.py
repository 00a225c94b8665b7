"""The kernels as they would be had some effects never been written."""

import ast

import numba
import numpy as np

from vtkmcvr.kernels import jit
from vtkmcvr.kernels.compilers import KernelCompiler, LaunchedCompiler
from vtkmcvr.kernels.launch import Launched
from vtkmcvr.kernels.program import Due
from vtkmcvr.kernels.room import new_room
from vtkmcvr.work.sources import load_kernels


def launched(function):
    """`jit.launched` without its on-disk cache."""
    options = {"nogil": True, "pipeline_class": LaunchedCompiler, **jit.KERNEL}
    return Launched.of(numba.njit(**options)(function))


# As in `kernels.jit`, without its on-disk cache
UNCACHED = {
    "device": numba.njit(**jit.DEVICE),
    "exact": numba.njit(**{**jit.DEVICE, "fastmath": False}),
    "glue": jit.glue,
    "kernel": numba.njit(nogil=True, pipeline_class=KernelCompiler, **jit.KERNEL),
    "launched": launched,
    "entry_point": numba.njit(error_model="numpy", fastmath=jit.FAST_MATH, nogil=True),
}


def compiled_launcher(in_step, absent=()):
    """Launcher of tiles, compiled anew from sources without what serves parameters named `absent`.

    `at(film, scene, goal, seed)` returns what brings a tile up to its goal.
    """
    module = "program" if in_step else "cpu"
    kernels = load_kernels(module, UNCACHED, Removal(frozenset(absent)).visit)
    return InStep(kernels) if in_step else OneByOne(kernels.render_tile)


class OneByOne:
    """Launcher of paths one by one."""

    def __init__(self, kernel):
        self.kernel = kernel

    def at(self, film, scene, goal, seed):
        return lambda *tile: self.kernel(film, scene, *tile, goal, seed)

    def assembly(self):
        return list(self.kernel.inspect_asm().values())


class InStep:
    """Launcher of paths in step."""

    def __init__(self, kernels):
        self.kernels, self.room = kernels, new_room()
        self.stages = set()

    def at(self, film, scene, goal, seed):
        due = Due(goal, np.zeros(goal.shape, np.bool_), seed)
        steps = self.kernels.steps_of(film, scene, due, self.room)
        self.stages |= {stage for part in steps for stage, _ in part}
        made = self.kernels.program(film, scene, due, self.room, {})
        return lambda *tile: self.kernels.run(made, *tile)

    def assembly(self):
        return [text for stage in self.stages for text in stage.inspect_asm().values()]


class Removal(ast.NodeTransformer):
    """Decides every `x is None` about a parameter x that is absent, and drops what is never run."""

    def __init__(self, absent):
        self.absent = absent
        self.parameters = frozenset()

    def visit_FunctionDef(self, node):
        self.parameters = self.absent & {argument.arg for argument in node.args.args}
        node.body = self.block(node.body)
        return node

    def block(self, statements):
        """Statements without those that never run."""
        kept = []
        for statement in statements:
            truth = self.truth(statement.test) if isinstance(statement, ast.If) else None
            if truth is None:
                for name in ("body", "orelse"):
                    if getattr(statement, name, None):
                        setattr(statement, name, self.block(getattr(statement, name)))
                kept.append(self.visit_inner(statement))
            else:
                taken = statement.body if truth else statement.orelse
                kept += self.block(taken) if taken else []
            if kept and isinstance(kept[-1], ast.Return):
                break
        return kept or [ast.Pass()]

    def visit_inner(self, statement):
        """Conditional expressions inside a statement."""
        for node in ast.walk(statement):
            for name, value in ast.iter_fields(node):
                if isinstance(value, ast.IfExp) and self.truth(value.test) is not None:
                    setattr(node, name, value.body if self.truth(value.test) else value.orelse)
        return statement

    def truth(self, test):
        """Whether a condition holds, None where the absent parameters do not say."""
        if isinstance(test, ast.BoolOp):
            known = [self.truth(value) for value in test.values]
            decisive = isinstance(test.op, ast.Or)
            if decisive in known:
                return decisive
            return None if None in known else not decisive
        if isinstance(test, ast.Compare) and isinstance(test.left, ast.Name):
            about = test.left.id in self.parameters
            against = isinstance(test.comparators[0], ast.Constant)
            if about and against and test.comparators[0].value is None:
                return isinstance(test.ops[0], ast.Is)
        return None


def absent_parts(part):
    """Names of all parts of packed tuples that are None."""
    found = set()
    for name, value in part._asdict().items():
        if value is None:
            found.add(name)
        elif hasattr(value, "_asdict"):
            found |= absent_parts(value)
    return found
