"""Has numba-cuda read voxels in bricks where kernels read those of an array.

What is in bricks is a type of its own, so that kernels are compiled for it where it is there, and
those of whole volumes stay as they are. Importing it takes numba-cuda.
"""

import operator

from numba import cuda
from numba.cuda import types
from numba.cuda.core import config

from ..packed import Bricks, voxel


def read_bricks():
    """Have numba-cuda compile `bricks[k, j, i]`; the simulator runs it as Python does."""
    if config.ENABLE_CUDASIM:
        return
    from numba.cuda.extending import overload

    compiled = cuda.jit(device=True)(voxel)

    def read(bricks, place):
        return compiled(bricks, place)

    @overload(operator.getitem)
    def reader(bricks, place):
        if getattr(bricks, "instance_class", None) is Bricks and isinstance(place, types.BaseTuple):
            return read
        return None
