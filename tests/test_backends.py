"""Who renders: the choice, what the picture says of it, and what happens where CUDA fails."""

import logging
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from scenes import blob, everything

sys.path.insert(0, str(Path(__file__).parent / "cuda_backend"))

from fake_device import FakeDevice

from vtkmcvr import backends, render, replay
from vtkmcvr.cli import main
from vtkmcvr.gpu import available, device, errors
from vtkmcvr.recipes.recipe import recipe_of
from vtkmcvr.rendering import render_scene

SCENE = everything(vol=blob(5), size=(16, 12))


@pytest.fixture
def with_device(monkeypatch):
    """Make a device available; returns what to call with the one to use."""

    def use(fake):
        monkeypatch.setattr(backends, "missing", lambda: None)
        monkeypatch.setattr(device, "CudaDevice", lambda: fake)

    return use


@pytest.fixture
def without_device(monkeypatch):
    monkeypatch.setattr(backends, "missing", lambda: "there is no NVIDIA driver")


def test_auto_is_the_cpu_without_a_device(without_device, caplog):
    with caplog.at_level(logging.WARNING):
        picture = render_scene(SCENE, samples=2)
    assert (picture.backend, picture.device) == ("cpu", "")
    assert "CUDA" not in caplog.text


def test_cuda_by_name_without_a_device_says_what_is_missing(without_device):
    with pytest.raises(errors.CudaUnavailable, match="no NVIDIA driver"):
        render_scene(SCENE, samples=2, backend="cuda")


@pytest.mark.parametrize("backend", ["auto", "cuda"])
def test_picture_says_which_device_made_it(with_device, backend):
    with_device(FakeDevice())
    picture = render_scene(SCENE, samples=2, seed=5, backend=backend)
    assert picture.facts()["backend"] == "cuda"
    assert picture.facts()["device"] == FakeDevice.name
    assert FakeDevice.name in picture.rendered_on
    assert recipe_of(picture)["replay"]["backend"] == "cuda"
    assert recipe_of(picture)["measured"]["device"] == FakeDevice.name
    on_cpu = render_scene(SCENE, samples=2, seed=5, backend="cpu")
    assert on_cpu.rendered_on == f"{on_cpu.threads} threads"
    assert np.array_equal(picture.radiance, on_cpu.radiance)


FAILURES = {
    "too large": dict(room=False),
    "at the first launch": dict(fail_at=0, error=errors.CudaError("CUDA failed: lost")),
    "later": dict(fail_at=1, error=errors.CudaError("CUDA failed: lost")),
}


@pytest.mark.parametrize("failure", FAILURES)
def test_auto_goes_over_to_the_cpu_and_says_so(with_device, caplog, failure):
    with_device(FakeDevice(**FAILURES[failure]))
    with caplog.at_level(logging.WARNING):
        picture = render_scene(SCENE, samples=2, seed=5)
    assert picture.backend == "cpu"
    assert "rendered on the CPU: " in caplog.text
    assert any("rendered on the CPU: " in note for note in picture.facts()["notes"])
    assert np.array_equal(
        picture.film.mean, render_scene(SCENE, samples=2, seed=5, backend="cpu").film.mean
    )


@pytest.mark.parametrize("failure", FAILURES)
def test_cuda_by_name_does_not_go_over_to_the_cpu(with_device, failure):
    with_device(FakeDevice(**FAILURES[failure]))
    with pytest.raises(errors.CudaError):
        render_scene(SCENE, samples=2, backend="cuda")


def test_continued_picture_stays_on_its_backend(with_device):
    with_device(FakeDevice())
    assert render_scene(SCENE, samples=1).refine(samples=2).backend == "cuda"
    assert render_scene(SCENE, samples=1, backend="cpu").refine(samples=2).backend == "cpu"


def test_replay_takes_the_recorded_backend(with_device, monkeypatch):
    with_device(FakeDevice())
    recipe = recipe_of(render_scene(SCENE, samples=2))
    data = [SCENE.volume, *(light.pixels for light in SCENE.lights if hasattr(light, "pixels"))]
    again = replay(recipe, data)
    assert (again.picture.backend, again.identical, again.notes) == ("cuda", True, ())
    monkeypatch.setattr(backends, "missing", lambda: "gone")
    elsewhere = replay(recipe, data)
    assert elsewhere.picture.backend == "cpu"
    assert any("CUDA" in note for note in elsewhere.notes)


def test_emission_and_absorption_is_the_cpus_alone():
    with pytest.raises(ValueError, match="runs on the CPU only"):
        render(SCENE, technique="emission-absorption", backend="cuda")


def test_unknown_backend():
    with pytest.raises(ValueError, match="backend is one of auto, cpu, cuda; got 'gpu'"):
        render_scene(SCENE, samples=1, backend="gpu")


def test_command_line_refuses_cuda_without_a_device(without_device, tmp_path, capsys):
    target = tmp_path / "a.png"
    status = main(
        ["demo", "--backend", "cuda", "--size", "16x12", "--samples", "1", "-o", str(target)]
    )
    assert status != 0
    assert "no NVIDIA driver" in capsys.readouterr().err
    assert not target.exists()


# What is missing


@pytest.fixture
def asked_anew():
    available.missing.cache_clear()
    yield
    available.missing.cache_clear()


def test_missing_extra(monkeypatch, asked_anew):
    monkeypatch.setattr(available, "find_spec", lambda name: None)
    assert 'pip install "vtkmcvr[cuda]"' in available.missing()


def test_missing_driver(monkeypatch, asked_anew):
    monkeypatch.setattr(available, "find_spec", lambda name: True)
    monkeypatch.setattr(available, "_driver_name", lambda: "libno-such-driver.so")
    assert "libno-such-driver.so" in available.missing()


@pytest.mark.parametrize("text", ["no device", "no NVVM"])
def test_missing_device_or_compiler(monkeypatch, asked_anew, text):
    monkeypatch.setattr(available, "find_spec", lambda name: True)
    monkeypatch.setattr(available, "_driver_found", lambda: True)
    monkeypatch.setattr(available, "_device_missing", lambda: text if text == "no device" else None)
    monkeypatch.setattr(available, "_toolkit_missing", lambda: text)
    assert available.missing() == text


def test_broken_installation_is_no_traceback(monkeypatch, asked_anew):
    def broken():
        raise OSError("bad symbol")

    monkeypatch.setattr(available, "find_spec", lambda name: True)
    monkeypatch.setattr(available, "_driver_found", lambda: True)
    monkeypatch.setattr(available, "_device_missing", broken)
    assert "OSError: bad symbol" in available.missing()


def test_nvvm_that_cannot_be_loaded(monkeypatch):
    if find_spec("numba_cuda") is None:
        pytest.skip("numba-cuda is not installed (extra cuda)")
    from numba.cuda.cudadrv import nvvm

    def absent():
        raise OSError("libnvvm.so: not found")

    monkeypatch.setattr(nvvm, "NVVM", absent)
    found = available._toolkit_missing()
    assert "NVVM was not found (libnvvm.so: not found)" in found
    assert "vtkmcvr[cuda]" in found


def test_nvrtc_that_cannot_be_loaded(monkeypatch):
    if find_spec("numba_cuda") is None:
        pytest.skip("numba-cuda is not installed (extra cuda)")
    from numba.cuda.cudadrv import nvrtc, nvvm

    def absent():
        raise OSError("libnvrtc.so: not found")

    monkeypatch.setattr(nvvm, "NVVM", lambda: None)
    monkeypatch.setattr(nvrtc, "get_supported_ccs", absent)
    found = available._toolkit_missing()
    assert "NVRTC was not found (libnvrtc.so: not found)" in found
    assert "vtkmcvr[cuda]" in found


def test_driver_without_a_device(monkeypatch):
    if find_spec("numba_cuda") is None:
        pytest.skip("numba-cuda is not installed (extra cuda)")
    from numba import cuda

    monkeypatch.setattr(cuda, "cuda_error", lambda: None)
    monkeypatch.setattr(cuda, "gpus", [])
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "7")
    found = available._device_missing()
    assert "CUDA_VISIBLE_DEVICES is '7'" in found and "backend='cpu'" in found
    monkeypatch.setattr(cuda, "cuda_error", lambda: "driver too old")
    assert "driver too old" in available._device_missing()


@pytest.mark.parametrize(
    ("raised", "kind", "words"),
    [
        (RuntimeError("Call to cuMemAlloc results in CUDA_ERROR_OUT_OF_MEMORY"),
         errors.OutOfDeviceMemory, "crop the volume"),
        (RuntimeError("Call to cuLaunchKernel results in CUDA_ERROR_ILLEGAL_ADDRESS"),
         errors.CudaError, "a kernel ran: RuntimeError: Call to cuLaunchKernel"),
        (errors.OutOfDeviceMemory("as it is"), errors.OutOfDeviceMemory, "as it is"),
    ],
)  # fmt: skip
def test_errors_say_what_to_do(raised, kind, words):
    with pytest.raises(kind, match=words), errors.translated("a kernel ran"):
        raise raised
