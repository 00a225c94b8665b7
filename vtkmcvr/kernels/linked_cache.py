"""What the on-disk cache keeps of kernels and of the functions that only they call.

This leans on parts of Numba that it does not document: `CompileResult` and the implementation of
its cache.
"""

import functools

from numba.core import compiler
from numba.core.caching import CompileResultCacheImpl
from numba.core.codegen import CodeLibrary

from .linked import DeviceLibrary, ObjectLibrary, weak_module


@functools.cache
def _bitcode(library: CodeLibrary) -> tuple[str, bytes]:
    return getattr(library, "symbol", library.name), weak_module(library).as_bitcode()


def _load(codegen, objects):
    return [ObjectLibrary.from_object(codegen, *kept) for kept in objects]


def _rebuilt(target_context, library, descriptor, environment, signature, reload_init):
    """Return the compiled function of a library, as Numba's compiler does."""
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


def _facts(cres):
    descriptor = cres.fndesc
    descriptor.typemap = descriptor.calltypes = None
    return descriptor, cres.environment, cres.signature, cres.reload_init


def _reload(reload_init):
    for initialise in reload_init:
        initialise()


class DeviceCacheImpl(CompileResultCacheImpl):
    """Of a function that kernels link in: its LLVM code, and the code of all it calls."""

    def reduce(self, cres):
        """Return what can be pickled of a compiled function."""
        library = cres.library
        objects = [part for part in library.callees if isinstance(part, ObjectLibrary)]
        code = [
            _bitcode(part) for part in (library, *library.callees) if part not in objects
        ]
        return code, [part.as_kept() for part in objects], *_facts(cres)

    def rebuild(self, target_context, payload):
        """Return the compiled function that `reduce` took apart."""
        code, objects, *facts = payload
        _reload(facts[-1])
        codegen = target_context.codegen()
        library, *callees = (DeviceLibrary.from_bitcode(codegen, *part) for part in code)
        library.callees = callees + _load(codegen, objects)
        return _rebuilt(target_context, library, *facts)


class ObjectCacheImpl(CompileResultCacheImpl):
    """Of a function with machine code of its own that kernels share."""

    def reduce(self, cres):
        """Return what can be pickled of a compiled function."""
        objects = [part.as_kept() for part in (*cres.library.objects, cres.library)]
        return objects, *_facts(cres)

    def rebuild(self, target_context, payload):
        """Return the compiled function that `reduce` took apart."""
        objects, *facts = payload
        _reload(facts[-1])
        *others, library = _load(target_context.codegen(), objects)
        library.objects = others
        return _rebuilt(target_context, library, *facts)


class KernelCacheImpl(CompileResultCacheImpl):
    """Of a kernel: what Numba keeps, and the functions with machine code of their own."""

    def reduce(self, cres):
        """Return what can be pickled of a compiled kernel."""
        return [part.as_kept() for part in cres.library.objects], super().reduce(cres)

    def rebuild(self, target_context, payload):
        """Return the compiled kernel that `reduce` took apart."""
        objects, kernel = payload
        _load(target_context.codegen(), objects)
        return super().rebuild(target_context, kernel)
