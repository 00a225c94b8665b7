"""Live pictures by a device: what is shown is copied, no film; the way back to the CPU."""

import logging
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from fake_device import FakeDevice
from needs import numba_cuda
from scenes import blob, everything

from vtkmcvr.gpu.errors import CudaError, CudaUnavailable
from vtkmcvr.gpu.kept import KeptArrays
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.live import work
from vtkmcvr.live.job import Job, is_compiled
from vtkmcvr.live.preview import Preview
from vtkmcvr.live.settings import LiveSettings
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film

PLANNED = plan(everything(ConstantEnvironment(0.5), vol=blob(5), size=(20, 43)))


PROGRAM = """
import pickle, sys
from vtkmcvr.gpu.kept import KeptDevice
scene, film = pickle.load(open(sys.argv[1], "rb"))
device = KeptDevice()
first, second = device.upload(scene), device.upload(scene)
assert first.medium.values is second.medium.values
assert first.medium.values.copy_to_host().sum() == scene.medium.values.sum()
assert device.upload(film).mean is not device.upload(film).mean
device.room_for(scene, film)
"""


@numba_cuda
def test_simulated_device_copies_a_scene_once_and_a_film_each_time(tmp_path):
    (tmp_path / "in").write_bytes(pickle.dumps((PLANNED.packed, empty_film(PLANNED))))
    subprocess.run(
        [sys.executable, "-c", PROGRAM, tmp_path / "in"], check=True, timeout=200,
        env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1"},
    )  # fmt: skip


@pytest.fixture
def use(monkeypatch):
    def with_device(fake):
        monkeypatch.setattr(work, "missing", lambda: None)
        monkeypatch.setattr(work, "device", lambda: fake)
        return fake

    monkeypatch.setattr(work.DeviceWork, "given_up", False)
    return with_device


def job(**settings):
    return Job(PLANNED, LiveSettings(samples=4, **settings))


def finished(**settings):
    made = job(**settings)
    made.finish()
    return made


def same(found, expected):
    apart = np.abs(found.newest.shown.pixels.astype(int) - expected.newest.shown.pixels)
    assert apart.max() <= 1 and expected.newest.shown.pixels.max() > 50
    assert found.newest.samples == expected.newest.samples == 4
    assert found.newest.error == pytest.approx(expected.newest.error, rel=1e-9)
    assert found.newest.done and found.stopped_by == "samples"


@pytest.mark.parametrize("backend", ["auto", "cuda"])
def test_live_picture_of_a_device_is_that_of_the_cpu(use, backend):
    device = use(FakeDevice())
    found, expected = finished(backend=backend), finished(backend="cpu")
    same(found, expected)
    assert device.launched and device.downloads == 0 and device.compiled == 1
    picture = found.picture()
    assert (picture.backend, picture.device) == ("cuda", FakeDevice.name)
    assert np.array_equal(picture.film.mean, expected.picture().film.mean)
    assert expected.picture().backend == "cpu"


def test_preview_is_a_sample_of_each_pixel_by_the_device(use):
    device = use(FakeDevice())
    made = Preview().estimate(PLANNED, LiveSettings(backend="cuda"))
    assert made.samples == 1 and made.shown.pixels.shape == (43, 20, 4) and not made.done
    assert device.launched and device.downloads == 0


def test_kernels_of_a_device_are_compiled_apart(use):
    finished(backend="cpu")
    assert is_compiled(PLANNED, LiveSettings(backend="cpu"))
    use(FakeDevice())
    before = is_compiled(PLANNED, LiveSettings(backend="cuda"))
    finished(backend="cuda")
    assert is_compiled(PLANNED, LiveSettings(backend="cuda")) >= before


@pytest.mark.parametrize("failing", [dict(room=False), dict(fail_at=1, error=CudaError("lost"))])
def test_auto_goes_over_to_the_cpu_and_stays_there(use, caplog, failing):
    from vtkmcvr.gpu.errors import OutOfDeviceMemory

    device = use(FakeDevice(**failing))
    with caplog.at_level(logging.WARNING, "vtkmcvr"):
        found = finished()
    same(found, finished(backend="cpu"))
    assert "live pictures are rendered on the CPU" in caplog.text
    assert found.picture().backend == "cpu"
    asked = len(device.launched)
    same(finished(), found)
    assert len(device.launched) == asked
    with pytest.raises((OutOfDeviceMemory, CudaError)):
        finished(backend="cuda")


def test_cuda_by_name_without_a_device_says_what_is_missing(monkeypatch):
    monkeypatch.setattr(work, "missing", lambda: "there is no NVIDIA driver")
    with pytest.raises(CudaUnavailable, match="no NVIDIA driver"):
        job(backend="cuda")
    assert isinstance(job().work, work.HostWork)
    with pytest.raises(ValueError, match="CPU only"):
        LiveSettings(technique="emission-absorption", backend="cuda")


def test_copies_are_kept_as_long_as_the_arrays():
    kept, copies = KeptArrays(), []

    def copied(array):
        copies.append(array.sum())
        return array + 1

    volume, other = np.ones(3), np.zeros(3)
    first = kept.copy_of(volume, copied)
    assert kept.copy_of(volume, copied) is first and volume in kept and other not in kept
    assert len(copies) == 1
    del volume
    for _ in range(50):
        # One of them may be where the first one was
        again = np.full(3, 5.0)
        assert (kept.copy_of(again, copied) == 6).all()
        del again
    assert len(kept._copies) == 1
