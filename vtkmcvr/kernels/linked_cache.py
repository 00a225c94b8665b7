"""What the on-disk cache keeps of functions that only kernels call: LLVM code.

This leans on parts of Numba that it does not document: `CompileResult` and the implementation of
its cache.
"""

import functools

from numba.core import compiler
from numba.core.caching import CompileResultCacheImpl
from numba.core.codegen import CodeLibrary

from .linked import DeviceLibrary, weak_module


@functools.cache
def _bitcode(library: CodeLibrary) -> tuple[str, bytes]:
    return getattr(library, "symbol", library.name), weak_module(library).as_bitcode()


class DeviceCacheImpl(CompileResultCacheImpl):
    """Of a function that kernels link in: its LLVM code, and the code of all it calls."""

    def reduce(self, cres):
        """Return what can be pickled of a compiled function."""
        code = [_bitcode(part) for part in (cres.library, *cres.library.callees)]
        descriptor = cres.fndesc
        descriptor.typemap = descriptor.calltypes = None
        return code, descriptor, cres.environment, cres.signature, cres.reload_init

    def rebuild(self, target_context, payload):
        """Return the compiled function that `reduce` took apart."""
        code, descriptor, environment, signature, reload_init = payload
        for initialise in reload_init:
            initialise()
        codegen = target_context.codegen()
        library, *library.callees = (DeviceLibrary.from_bitcode(codegen, *part) for part in code)
        return compiler.compile_result(
            typing_context=target_context.typing_context,
            target_context=target_context,
            entry_point=target_context.get_executable(library, descriptor, environment),
            environment=environment,
            library=library,
            fndesc=descriptor,
            signature=signature,
            objectmode=False,
            lifted=(),
            reload_init=reload_init,
        )
