"""Renders packed scenes in Numba's CUDA simulator; to be run as a program, see `test_simulator`.

Reads a pickled list of (scene, film, samples of each pixel, seed, number of devices), writes the
films. Several devices are the one that the simulator has.
"""

import os
import pickle
import sys
from pathlib import Path
from types import SimpleNamespace


def main(source, target):
    from numba import cuda

    from vtkmcvr.gpu import launches
    from vtkmcvr.gpu.device import CudaDevice
    from vtkmcvr.gpu.several import SeveralDevices
    from vtkmcvr.schedule import StopRules

    # The simulator works at once; its events know no query
    cuda.event = lambda timing: SimpleNamespace(record=lambda queue: None, query=lambda: True)
    films = []
    for scene, film, counts, seed, count in pickle.loads(Path(source).read_bytes()):
        rules = StopRules(int(counts.min()), None, None)
        parts = [CudaDevice(0, count, k) for k in range(count)]
        device = SeveralDevices(parts) if count > 1 else CudaDevice()
        done, stopped_by, _ = launches.run(device, scene, film, rules, seed, counts=counts)
        assert stopped_by == "samples"
        films.append(done)
    Path(target).write_bytes(pickle.dumps(films))


if __name__ == "__main__":
    assert os.environ["NUMBA_ENABLE_CUDASIM"] == os.environ["NUMBA_DISABLE_JIT"] == "1"
    main(*sys.argv[1:])
