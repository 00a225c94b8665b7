"""Shows films in Numba's CUDA simulator; to be run as a program, see `test_film_on_device`.

Reads a pickled list of (film, screen, number of devices), writes (picture, totals) of each.
"""

import os
import pickle
import sys
from pathlib import Path


def main(source, target):
    from vtkmcvr.gpu.device import CudaDevice
    from vtkmcvr.gpu.several import SeveralDevices
    from vtkmcvr.kernels import film_cuda

    # It makes a thread of the system of each thread
    film_cuda.BLOCKS, film_cuda.THREADS = 2, 16
    done = []
    for film, screen, count in pickle.loads(Path(source).read_bytes()):
        parts = [CudaDevice(0, count, k) for k in range(count)]
        device = SeveralDevices(parts) if count > 1 else parts[0]
        there = device.upload(film)
        done.append((device.shown(there, screen), device.totals(there)))
    Path(target).write_bytes(pickle.dumps(done))


if __name__ == "__main__":
    assert os.environ["NUMBA_ENABLE_CUDASIM"] == os.environ["NUMBA_DISABLE_JIT"] == "1"
    main(*sys.argv[1:])
