"""Several devices: one picture, bit by bit, whatever their number."""

from contextlib import nullcontext

import numpy as np
import pytest
from fake_device import FakeDevice
from needs import numba_cuda
from scenes import blob, everything
from simulated import check_same, films_of

from vtkmcvr import backends, schedule
from vtkmcvr.gpu import device as one
from vtkmcvr.gpu import launches, several
from vtkmcvr.gpu.errors import CudaError, OutOfDeviceMemory
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film, render_scene
from vtkmcvr.tiles import render_tile

SIZE, SEED = (20, 43), 3
SCENE = everything(vol=blob(5), size=SIZE)
PLANNED = plan(SCENE)


class BandDevice(FakeDevice):
    """A fake device that takes every so manieth band of eight rows."""

    inside = None

    def __init__(self, number=None, every=1, which=0, **trouble):
        super().__init__(**trouble)
        self.number, self.every, self.which = number, every, which

    def alike(self):
        return [0, 2, 3]

    def current(self):
        return nullcontext()

    def finished(self, ticket):
        film, scene, (start, end), goal, cap, seed = ticket
        here = np.minimum(goal, cap)
        for top in range(start, end, launches.ROWS):
            if top // launches.ROWS % self.every == self.which:
                bottom = min(top + launches.ROWS, end)
                render_tile(film, scene, top, bottom, 0, goal.shape[1], here, np.int64(seed))
        self.in_flight -= 1
        return True


def devices(count, **trouble):
    return several.SeveralDevices(
        [BandDevice(k, count, k, **(trouble if k == count - 1 else {})) for k in range(count)]
    )


def run(device, samples=3, **options):
    rules = schedule.StopRules(samples, None, None)
    return launches.run(device, PLANNED.packed, empty_film(PLANNED), rules, SEED, **options)[0]


@pytest.fixture(scope="module")
def expected():
    film = empty_film(PLANNED)
    schedule.run(PLANNED.packed, film, schedule.StopRules(3, None, None), SEED, 1)
    return film


@pytest.mark.parametrize("least", [1, 400, 10**6])
@pytest.mark.parametrize("count", [2, 3, 8])
def test_bits_are_those_of_one_device(count, least, expected, monkeypatch):
    monkeypatch.setattr(launches, "LEAST_PATHS", least)
    monkeypatch.setattr(launches, "LAUNCH_SECONDS", 0.0)
    group = devices(count)
    film = run(group)
    for field in ("count", "mean", "m2", "hits", "depth"):
        assert np.array_equal(getattr(film, field), getattr(expected, field))
    assert film.batches is None or np.array_equal(film.batches.m2, expected.batches.m2)
    assert all(device.launched for device in group.devices)
    assert group.name == f"{count} x {FakeDevice.name}"


def test_each_launch_has_bands_for_all(monkeypatch):
    monkeypatch.setattr(launches, "LEAST_PATHS", 1)
    monkeypatch.setattr(launches, "LAUNCH_SECONDS", 0.0)
    group = devices(2)
    run(group, samples=1)
    starts = [rows for rows, _ in group.devices[0].launched]
    assert starts == [(0, 16), (16, 32), (32, 43)]


def test_pixels_with_numbers_of_their_own(expected):
    counts = np.full(SIZE[::-1], 2, np.int64)
    counts[:, 3:9] = 3
    film = run(devices(3), 2, counts=counts)
    assert np.array_equal(film.count, counts)
    assert np.array_equal(film.mean[:, 3:9], expected.mean[:, 3:9])


@pytest.mark.parametrize(
    ("trouble", "kind"),
    [({"room": False}, OutOfDeviceMemory), ({"fail_at": 1, "error": CudaError("lost")}, CudaError)],
)
def test_trouble_on_one_is_trouble(trouble, kind, monkeypatch):
    monkeypatch.setattr(launches, "LEAST_PATHS", 1)
    monkeypatch.setattr(launches, "LAUNCH_SECONDS", 0.0)
    with pytest.raises(kind):
        run(devices(2, **trouble))


def test_all_devices_alike_are_taken(monkeypatch):
    monkeypatch.setattr(backends, "missing", lambda: None)
    monkeypatch.setattr(one, "CudaDevice", BandDevice)
    picture = render_scene(SCENE, samples=2, seed=SEED, backend="cuda")
    assert picture.device == f"3 x {FakeDevice.name}"
    on_cpu = render_scene(SCENE, samples=2, seed=SEED, backend="cpu")
    assert np.array_equal(picture.radiance, on_cpu.radiance)
    opened = several.opened()
    assert [(d.number, d.every, d.which) for d in opened.devices] == [
        (0, 3, 0),
        (2, 3, 1),
        (3, 3, 2),
    ]


@numba_cuda
def test_simulated_devices_share_a_picture(tmp_path):
    described = everything(vol=blob(9), size=(6, 20))
    counts = np.full((20, 6), 1, np.int64)
    [(cpu, found)] = films_of({"one": described}, counts, tmp_path, devices=2).values()
    assert (found.count == 1).all() and cpu.hits[8:16].sum() > 0
    check_same(cpu, found)
