"""Noise reduction on a device: the CPU's in the simulator, no double in PTX, and the way back."""

import os
import pickle
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from needs import compiler, numba_cuda

from vtkmcvr import backends
from vtkmcvr.gpu import smoothing
from vtkmcvr.gpu.errors import CudaError
from vtkmcvr.pictures import denoise

PROGRAM = """
import pickle, sys
from vtkmcvr import backends
from vtkmcvr.pictures import denoise
backends.missing = lambda: None
source, target = sys.argv[1:]
pictures = pickle.load(open(source, "rb"))
pickle.dump([denoise.knn(*p, backend="cuda") for p in pictures], open(target, "wb"))
"""


def picture():
    """Noisy edge with a hole that nothing is known of, 7 x 11 pixels."""
    random = np.random.default_rng(3)
    light = np.where(np.arange(11) < 5, 0.2, 0.8)[None, :, None] * np.ones((7, 1, 3))
    error = np.full((7, 11, 3), 0.1)
    error[3, 3] = np.inf
    radiance = light + error[0, 0] * random.standard_normal((7, 11, 3))
    return (
        np.abs(radiance).astype(np.float32), np.ones((7, 11), np.float32),
        error.astype(np.float32), 0.5,
    )  # fmt: skip


@numba_cuda
def test_simulated_filter_is_that_of_the_cpu(tmp_path):
    (tmp_path / "in").write_bytes(pickle.dumps([picture()]))
    subprocess.run(
        [sys.executable, "-c", PROGRAM, tmp_path / "in", tmp_path / "out"], check=True,
        env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1"}, timeout=200,
    )  # fmt: skip
    [(light, coverage)] = pickle.loads((tmp_path / "out").read_bytes())
    expected_light, expected_coverage = denoise.knn(*picture())
    assert np.abs(expected_light - picture()[0]).max() > 0.05
    np.testing.assert_allclose(light, expected_light, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(coverage, expected_coverage, rtol=1e-5, atol=1e-6)


@compiler
@pytest.mark.parametrize("capability", [(7, 5), (9, 0)])
def test_filter_compiles_without_doubles(capability, monkeypatch):
    from numba.cuda.typing.typeof import typeof
    from ptx import doubles, pretend, ptx_of

    from vtkmcvr.kernels.knn_cuda import knn_pixels

    pretend(monkeypatch, capability)
    three, two = np.zeros((2, 2, 4), np.float32), np.zeros((2, 2), np.float32)
    types = tuple(map(typeof, (three, three, two, two, three)))
    ptx = ptx_of(knn_pixels.py_func, types, capability)
    assert "sm_{}{}".format(*capability) in ptx
    assert not doubles(ptx)


def test_cpu_does_it_where_the_device_fails(monkeypatch, caplog):
    def lost(*planes):
        raise CudaError("CUDA failed: lost")

    monkeypatch.setattr(backends, "missing", lambda: None)
    monkeypatch.setattr(smoothing, "SmoothingDevice", lambda: SimpleNamespace(knn=lost))
    found = denoise.knn(*picture(), backend="auto")
    assert "CUDA failed: lost" in caplog.text
    assert np.array_equal(found[0], denoise.knn(*picture())[0])
    with pytest.raises(CudaError):
        denoise.knn(*picture(), backend="cuda")


def test_device_takes_what_a_picture_of_the_device_needs(monkeypatch):
    taken = []

    def knn(guide, values, share, tolerance):
        taken.append((guide.shape, values.shape, share.shape, tolerance.shape))
        assert {a.dtype for a in (guide, values, share, tolerance)} == {np.dtype(np.float32)}
        return values

    monkeypatch.setattr(backends, "missing", lambda: None)
    monkeypatch.setattr(smoothing, "SmoothingDevice", lambda: SimpleNamespace(knn=knn))
    light, _ = denoise.knn(*picture(), backend="auto")
    assert taken == [((7, 11, 4), (7, 11, 4), (7, 11), (7, 11))]
    assert np.array_equal(light, picture()[0])
