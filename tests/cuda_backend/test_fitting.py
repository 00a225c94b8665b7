"""A scene that does not fit: smaller voxels of the same values, else the CPU; never in silence."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from fake_device import FakeDevice
from fake_sweep import FakeSweepDevice
from scenes import blob, everything, noise, volume

from vtkmcvr import backends
from vtkmcvr.gpu import device, fitting, sweeps
from vtkmcvr.gpu.errors import CudaError, OutOfDeviceMemory, translated
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene

WHOLE = volume(np.round(255 * blob(5).values).astype(np.float32), (0.5,) * 3)


def lit(vol):
    return everything(vol=vol, size=(16, 12))


class Small(FakeDevice):
    """Has no room for voxels of more than `most` bytes; says so when asked, or when copied to."""

    def __init__(self, most, when="asked"):
        super().__init__()
        self.most, self.when, self.types = most, when, []

    def _check(self, part):
        medium = getattr(part, "medium", None)
        if medium is not None and medium.values.itemsize > self.most:
            raise RuntimeError("Call to cuMemAlloc results in CUDA_ERROR_OUT_OF_MEMORY")

    def room_for(self, *parts):
        if self.when == "asked":
            with translated("its memory was measured"):
                self._check(parts[0])

    def upload(self, part):
        with translated("scene and film were copied to the device"):
            self._check(part)
        if hasattr(part, "medium"):
            self.types.append(part.medium.values.dtype)
        return super().upload(part)


@pytest.fixture
def use(monkeypatch):
    def with_device(fake):
        monkeypatch.setattr(backends, "missing", lambda: None)
        monkeypatch.setattr(device, "CudaDevice", lambda: fake)
        return fake

    return with_device


@pytest.mark.parametrize("when", ["asked", "copied"])
def test_whole_numbers_go_in_bytes_to_the_same_bits(use, when):
    fake = use(Small(1, when))
    picture = render_scene(lit(WHOLE), samples=2, backend="cuda")
    assert fake.types == [np.dtype(np.uint8)]
    on_cpu = render_scene(lit(WHOLE), samples=2, backend="cpu")
    assert np.array_equal(picture.film.mean, on_cpu.film.mean)
    assert picture.plan.packed.medium.values.dtype == np.float32


def test_what_fits_stays_as_it_is(use):
    fake = use(Small(4))
    render_scene(lit(WHOLE), samples=1, backend="cuda")
    assert fake.types == [np.dtype(np.float32)]


def test_fractions_have_no_smaller_type(use, caplog):
    use(Small(1))
    with pytest.raises(OutOfDeviceMemory, match="crop the volume"):
        render_scene(lit(blob(5)), samples=1, backend="cuda")
    with caplog.at_level(logging.WARNING):
        picture = render_scene(lit(blob(5)), samples=1)
    assert picture.backend == "cpu"
    assert "rendered on the CPU: out of device memory" in caplog.text


def test_too_small_for_bytes_too(use):
    use(Small(0))
    with pytest.raises(OutOfDeviceMemory):
        render_scene(lit(WHOLE), samples=1, backend="cuda")


def test_other_errors_are_not_tried_again():
    class Lost(FakeDevice):
        asked = 0

        def room_for(self, *parts):
            self.asked += 1
            raise CudaError("lost")

    lost = Lost()
    with pytest.raises(CudaError, match="lost"):
        fitting.uploaded(lost, plan(lit(WHOLE)).packed)
    assert lost.asked == 1


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        (np.float32([0, 255]), np.uint8), (np.float32([-1024, 3071]), np.int16),
        (np.float32([0, 65535]), np.uint16), (np.float32([0, 65536]), np.float32),
        (np.float32([0, 0.5]), np.float32), (np.float32([1, np.nan]), np.float32),
        (np.float32([-np.inf, 1]), np.float32), (np.uint16([0, 255]), np.uint8),
        (np.int16([-1, 300]), np.int16), (np.uint8([0, 255]), np.uint8),
    ],
)  # fmt: skip
def test_smallest_type_of_the_same_values(values, kind):
    found = fitting.smaller_type(values)
    assert found.dtype == kind
    assert found is values or np.array_equal(found, values)


def test_further_volumes_shrink_too():
    from vtkmcvr.layers import Layer

    two = replace(lit(blob(5)), layers=(Layer(WHOLE, lit(WHOLE).transfer),))
    packed = plan(two).packed
    smaller = fitting.shrunk(packed)
    assert smaller.more[0].medium.values.dtype == np.uint8
    assert smaller.medium is packed.medium
    nothing = plan(lit(noise(5))).packed
    assert fitting.shrunk(nothing) is nothing


def test_layers_of_occlusion_shrink_too(monkeypatch):
    class SmallSweep(FakeSweepDevice):
        def room_for(self, tables):
            if tables.volumes[0].medium.values.itemsize > 1:
                raise OutOfDeviceMemory("too large")

        def download(self, part):
            kind = self.tables.volumes[0].medium.values.dtype
            assert kind == np.uint8
            return super().download(part)

    settings = Occlusion(directions=4, slices=20)
    film = render_film(settings)
    monkeypatch.setattr(backends, "missing", lambda: None)
    monkeypatch.setattr(sweeps, "SweepDevice", lambda: SmallSweep(film))
    picture = render_occlusion(lit(WHOLE), settings, backend="cuda")
    assert picture.backend == "cuda"


def render_film(settings):
    from vtkmcvr.occlusion.carry_out import sweep
    from vtkmcvr.occlusion.rendering import layout, parts_of

    planned, raster, _ = layout(lit(WHOLE), settings)
    return sweep("cpu", parts_of(lit(WHOLE), planned, raster, settings), 1).film
