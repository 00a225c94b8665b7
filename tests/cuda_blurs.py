"""Blurs a buffer in Numba's CUDA simulator; to be run as a program, see `test_occlusion_simulated`.

Reads a pickled (buffer, widths of windows), writes the blurred buffers: along columns and along
rows for each width.
"""

import os
import pickle
import sys
from pathlib import Path

import numpy as np
from numba import cuda


def main(source, target):
    from vtkmcvr.kernels.cone_cuda import THREADS
    from vtkmcvr.kernels.cone_cuda_blurred import ROOM, blur_along

    @cuda.jit
    def blur(source, target, down, across, width):
        room = cuda.shared.array(ROOM, np.float32)
        blur_along(source, target, down, across, width, room)

    buffer, widths = pickle.loads(Path(source).read_bytes())
    blurred = []
    for width in widths:
        for down, across in ((0, 1), (1, 0)):
            out = np.zeros_like(buffer)
            blur[2, THREADS](buffer, out, down, across, np.float32(width))
            blurred.append(out)
    Path(target).write_bytes(pickle.dumps(blurred))


if __name__ == "__main__":
    assert os.environ["NUMBA_ENABLE_CUDASIM"] == os.environ["NUMBA_DISABLE_JIT"] == "1"
    main(*sys.argv[1:])
