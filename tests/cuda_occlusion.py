"""Sweeps layers in Numba's CUDA simulator; to be run as a program, see `test_occlusion_simulated`.

Reads a pickled list of what sweeps take, writes the films and the work they took.
"""

import os
import pickle
import sys
from pathlib import Path
from types import SimpleNamespace


def main(source, target):
    from numba import cuda

    from vtkmcvr import backends
    from vtkmcvr.occlusion.carry_out import sweep

    # The simulator works at once; its events know no query
    cuda.event = lambda timing: SimpleNamespace(record=lambda queue: None, query=lambda: True)
    backends.missing = lambda: None
    done = [sweep("cuda", parts, 1) for parts in pickle.loads(Path(source).read_bytes())]
    Path(target).write_bytes(pickle.dumps(done))


if __name__ == "__main__":
    assert os.environ["NUMBA_ENABLE_CUDASIM"] == os.environ["NUMBA_DISABLE_JIT"] == "1"
    main(*sys.argv[1:])
