"""How kernel-only functions are compiled: to LLVM code that kernels link in, not to machine code.

Numba optimises every function that it compiles, together with all that it calls, and makes machine
code of it, which nobody runs if only kernels call it. Here such a function ends as LLVM code. Each
kernel gathers the functions that it calls, those that they call and so on, and optimises the whole
once, which gives code as fast in a sixth less time.

This leans on parts of Numba that it does not document: `CodeLibrary`, where a compiled function
ends.
"""

from __future__ import annotations

from collections.abc import Iterable

from llvmlite import binding as llvm
from numba.core.codegen import CodeLibrary, JITCodeLibrary


class _Library(JITCodeLibrary):
    def _optimize_functions(self, ll_module):
        """Remove dead code only: Numba's round of simplification costs more than it saves later.

        Dead code at each call is the address of the callee's Python object, which differs from run
        to run and would forbid caching. Inside loops it takes another pass to see that it is dead.
        """
        ll_module.data_layout = self._codegen._data_layout
        self._remove_dead_code(ll_module)
        if any(g.name.startswith("numba.dynamic.globals") for g in ll_module.global_variables):
            self._remove_dead_code(ll_module, through_memory=True)

    def _remove_dead_code(self, ll_module, through_memory=False):
        passes = llvm.create_new_module_pass_manager()
        if through_memory:
            passes.add_sroa_pass()
        passes.add_dead_code_elimination_pass()
        passes.add_global_dead_code_eliminate_pass()
        passes.run(ll_module, self._codegen._pass_builder())


class DeviceLibrary(_Library):
    """LLVM code of a kernel-only function.

    `symbol` is its name in that code; `callees` are the libraries of all that it calls, directly
    or not.
    """

    symbol: str
    callees: list[CodeLibrary]

    @classmethod
    def from_bitcode(cls, codegen, symbol: str, bitcode: bytes):
        """Return the library that a cache holds, still without its callees."""
        self = cls(codegen, symbol)
        self._final_module = llvm.parse_bitcode(bitcode)
        self.finalize()
        return self

    def finalize(self):
        """End here: gather what the function calls."""
        self._raise_if_finalized()
        self.callees = _with_callees(self._linking_libraries)
        for library in self.callees:
            self._reload_init.update(library._reload_init)
        _set_linkage(self._final_module, llvm.Linkage.external, "weak_odr")
        self.symbol = next(f.name for f in self._final_module.functions if not f.is_declaration)
        self._finalize_dynamic_globals()
        self._finalized = True

    def _get_module_for_linking(self):
        """Return one module with all that it calls, for a caller that is not a KernelLibrary."""
        self._ensure_finalized()
        if self._shared_module is None:
            self._shared_module = self._final_module.clone()
            _link(self._shared_module, self.callees)
            _set_linkage(self._shared_module, llvm.Linkage.weak_odr, "linkonce_odr")
        return self._shared_module

    def get_pointer_to_function(self, name):
        """Return that there is no machine code."""
        self._ensure_finalized()
        return 0

    @property
    def codegen(self):
        """Take the address of the function's environment, which no code here asks for."""
        return _WithoutEnvironment


class _WithoutEnvironment:
    @staticmethod
    def set_env(env_name, env):
        """Leave the environment out."""


class KernelLibrary(_Library):
    """Machine code of a kernel, made in one go of its own LLVM code and that of all it calls."""

    def finalize(self):
        """Gather all that the kernel calls, optimise and make machine code."""
        parts = _with_callees(self._linking_libraries)
        self._linking_libraries = []
        for library in parts:
            self._reload_init.update(library._reload_init)
        _link(self._final_module, parts)
        # Not "internal", which keeps the name: LLVM's loader would bind other code's function of
        # that name to this one, whose arguments the optimiser may have changed
        _set_linkage(self._final_module, llvm.Linkage.weak_odr, "private")
        super().finalize()

    def _optimize_final_module(self):
        """Optimise in one round: Numba's cheap one before it serves reference counts."""
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


def _with_callees(libraries: Iterable[CodeLibrary]) -> list[CodeLibrary]:
    """Return the libraries and all that they call, each once."""
    found: dict[object, CodeLibrary] = {}
    for library in libraries:
        for part in (library, *getattr(library, "callees", ())):
            found.setdefault(getattr(part, "symbol", id(part)), part)
    return list(found.values())


def weak_module(library: CodeLibrary):
    """Return a library's code, of functions that others may define as well.

    They are weak and not linkonce, which a linker leaves out while nothing asks for them yet.
    """
    if isinstance(library, DeviceLibrary):
        return library._final_module
    module = library._get_module_for_linking().clone()
    _set_linkage(module, llvm.Linkage.external, "weak_odr")
    _set_linkage(module, llvm.Linkage.linkonce_odr, "weak_odr")
    return module


def _link(module, libraries: Iterable[CodeLibrary]):
    """Link by twos: LLVM goes through all of a module again whenever something is linked in."""
    parts = [weak_module(library).clone() for library in libraries]
    while len(parts) > 1:
        for one, other in zip(parts[::2], parts[1::2], strict=False):
            one.link_in(other)
        parts = parts[::2]
    for part in parts:
        module.link_in(part)


def _set_linkage(module, old, new: str):
    for function in module.functions:
        if not function.is_declaration and function.linkage == old:
            function.linkage = new
