"""CUDA launcher: one thread a pixel, for the samples that the CPU takes too.

Importing it takes numba-cuda, of the extra `cuda`; `vtkmcvr.gpu` knows whether it is there, moves
scene and film to the device and decides how much a launch does.
"""

from contextlib import nullcontext
from types import FunctionType

from numba import cuda
from numba.cuda import types
from numba.cuda.core import config

from .bricks_cuda import read_bricks
from .event import collide_more, layer_vertex
from .jit import source_stamp
from .sample import take_sample
from .visibility import through_more

# Threads of a block along columns and rows: a warp covers 8 x 4 pixels, whose paths are alike
BLOCK = (8, 8)


class AbsentEffects:
    """Passes on the Nones of a packed tuple, which numba-cuda compiles but does not launch with.

    A parameter of that type is a pointer that nobody reads.
    """

    def prepare_args(self, ty, val, stream, retr):
        """Return type and value of a parameter as they are launched with."""
        if isinstance(ty, types.NoneType):
            return types.uint64, 0
        return ty, val


# Division, square root and elementary functions are approximate, as FAST_MATH allows on the CPU;
# NaN and infinity keep their meaning. The simulator knows neither linking nor extensions.
OPTIONS = {"fastmath": True}
# A context to compile in
compiling = nullcontext
if not config.ENABLE_CUDASIM:
    from .lowering_cuda import variables_as_values as compiling  # noqa: F401

    OPTIONS |= {"lto": False, "extensions": [AbsentEffects()]}


@cuda.jit(**OPTIONS)
def render_rows(film, scene, row_0, row_1, goal, cap, seed, every):
    """Bring every pixel of some rows up to its `goal` of samples, or to `cap` where that is less.

    Continues where the film is. Of the rows, in bands as high as a block, the first band is taken
    and `every` so manieth: the others are other devices'.
    """
    column = cuda.blockIdx.x * cuda.blockDim.x + cuda.threadIdx.x
    row = row_0 + cuda.blockIdx.y * cuda.blockDim.y * every + cuda.threadIdx.y
    if row < row_1 and column < film.count.shape[1]:
        for sample in range(film.count[row, column], min(goal[row, column], cap)):
            take_sample(film, scene, row, column, sample, seed)


def _unrolls(function):
    """Have numba-cuda compile a function that loops over a tuple with its own `literal_unroll`.

    It does not know that of Numba. What it compiles for a CPU function is kept where it looks for
    it, under a name that it does not document.
    """
    plain = function.py_func
    known = {**plain.__globals__, "literal_unroll": cuda.literal_unroll}
    own = FunctionType(plain.__code__, known, plain.__name__, plain.__defaults__)
    options = {**function.targetoptions, "device": True, "debug": False, "opt": True}
    function._CUDATypingContext__dispatcher = CUDADispatcher(own, options)


def keep_on_disk(dispatcher):
    """Keep machine code on disk, fresh while neither numba-cuda nor a kernel source has changed."""
    if config.ENABLE_CUDASIM:
        return
    dispatcher.enable_caching()
    index = dispatcher._cache._cache_file
    index._version = f"{index._version} {source_stamp()}"


if not config.ENABLE_CUDASIM:
    from numba.cuda.dispatcher import CUDADispatcher

    for function in (collide_more, layer_vertex, through_more):
        if hasattr(function, "py_func"):
            _unrolls(function)
read_bricks()
keep_on_disk(render_rows)
