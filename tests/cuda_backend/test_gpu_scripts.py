"""The checks of tests/gpu, on a device that is the CPU: they pass there, and can fail."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fake_device import FakeDevice, poisoned

from vtkmcvr import backends, packed
from vtkmcvr.film.moments import copy_film
from vtkmcvr.gpu import available, device
from vtkmcvr.gpu import bricks as needed
from vtkmcvr.occlusion import carry_out

SCRIPTS = Path(__file__).parents[1] / "gpu"
sys.path.insert(0, str(SCRIPTS))

import agreement  # noqa: E402
import film_shown  # noqa: E402
import kept  # noqa: E402
import occluded  # noqa: E402


class Biased(FakeDevice):
    """A device whose light is 10 % too bright."""

    def download(self, film):
        found = copy_film(film)
        found.mean[:] *= 1.1
        return found


SMALL = replace(agreement.SINGLE, size=(32, 24))


@pytest.fixture
def on(monkeypatch):
    monkeypatch.setattr(agreement, "SINGLE", SMALL)
    monkeypatch.setattr(agreement, "SAMPLES", 128)

    def use(kind):
        monkeypatch.setattr(backends, "missing", lambda: None)
        monkeypatch.setattr(device, "CudaDevice", kind)

    return use


def test_devices_that_agree_pass(on):
    on(FakeDevice)
    found = agreement.compared(agreement.SINGLE)
    assert found["passed"] and found["pixels_alike_with_one_seed"] == 1.0
    assert agreement.same_bits() == {"passed": True}


def test_a_bias_is_found(on):
    on(Biased)
    assert not agreement.compared(agreement.SINGLE)["passed"]


def test_films_shown_alike_pass_and_a_bias_is_found(monkeypatch):
    monkeypatch.setattr(film_shown, "CudaDevice", FakeDevice)
    assert film_shown.alike(SMALL)["passed"]
    monkeypatch.setattr(film_shown, "CudaDevice", Biased)
    assert not film_shown.alike(SMALL)["passed"]


def test_live_pictures_alike_pass_and_a_bias_is_found(monkeypatch):
    from vtkmcvr.live import work

    monkeypatch.setattr(kept, "SINGLE", SMALL)
    monkeypatch.setattr(work, "missing", lambda: None)
    # One for each picture: the fake one works when it is waited for, by whoever waits
    monkeypatch.setattr(work, "device", FakeDevice)
    assert kept.live()["passed"]
    monkeypatch.setattr(FakeDevice, "shown", lambda *_: np.zeros((24, 32, 4), np.uint8))
    assert not kept.live()["passed"]


def test_bricks_that_lack_voxels_are_found(monkeypatch):
    monkeypatch.setattr(kept, "SIZE", SMALL.size)
    monkeypatch.setattr(kept, "CudaDevice", FilledUp)
    assert kept.bricks()["same_bits"]
    monkeypatch.setattr(needed, "APRON", -30)
    assert not kept.bricks()["passed"]


class FilledUp(FakeDevice):
    """A device that makes arrays of bricks, for the kernels of the CPU."""

    def upload(self, part):
        values = getattr(getattr(part, "medium", None), "values", None)
        if isinstance(values, packed.Bricks):
            part = part._replace(medium=poisoned(part.medium))
        return super().upload(part)


@pytest.fixture
def sweeping(monkeypatch):
    def use(bias):
        def swept(parts, progress, abort):
            done = carry_out._on_cpu(parts, 1, progress, abort, "")
            done.film.radiance[:] *= bias
            return done._replace(backend="cuda", device="fake")

        monkeypatch.setattr(backends, "missing", lambda: None)
        monkeypatch.setattr(carry_out, "_on_cuda", swept)

    return use


def test_occlusion_that_agrees_passes_and_a_bias_is_found(sweeping):
    settings = occluded.MODES["default"]
    small = replace(occluded.PLAIN, size=(16, 12))
    sweeping(1.0)
    assert occluded.alike(small, settings)["passed"]
    sweeping(1.001)
    assert not occluded.alike(small, settings)["passed"]


def test_one_command_says_that_there_is_no_device(tmp_path):
    if available.missing() is None:
        pytest.skip("there is a device: run tests/gpu")
    done = subprocess.run(
        [sys.executable, SCRIPTS, "-o", tmp_path / "gpu.json"], capture_output=True, text=True
    )
    assert done.returncode == 0
    assert done.stdout.startswith("no GPU checks: ")
    assert not (tmp_path / "gpu.json").exists()
