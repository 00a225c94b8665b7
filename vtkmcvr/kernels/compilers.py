"""Numba's compiler, ending in the libraries of `linked` by way of `lowering`."""

from numba.core import compiler
from numba.core.codegen import CodeLibrary
from numba.core.typed_passes import NativeLowering

from .linked import DeviceLibrary, KernelLibrary
from .lowering import LaunchedLowering, ValueLowering


class _Compiler(compiler.Compiler):
    library: type[CodeLibrary]
    lowering = ValueLowering

    def define_pipelines(self):
        """Return Numba's pipeline, with this project's lowering."""
        [pipeline] = super().define_pipelines()
        passes = [(self.lowering if p is NativeLowering else p, why) for p, why in pipeline.passes]
        pipeline.passes = passes
        pipeline._finalized = False
        pipeline.finalize()
        return [pipeline]

    def compile_extra(self, func):
        """Compile a function into the library of this compiler."""
        codegen = self.state.targetctx.codegen()
        self.state.library = self.library(codegen, func.__qualname__)
        self.state.library.enable_object_caching()
        return super().compile_extra(func)


class DeviceCompiler(_Compiler):
    """Numba's compiler, ending before machine code."""

    library = DeviceLibrary


class KernelCompiler(_Compiler):
    """Numba's compiler, optimising a kernel with all that it calls as one."""

    library = KernelLibrary


class LaunchedCompiler(KernelCompiler):
    """`KernelCompiler`, of kernels that take their arguments as a block of words."""

    lowering = LaunchedLowering
