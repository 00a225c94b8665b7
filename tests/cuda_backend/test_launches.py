"""Passes on a device: sizes of launches, stop rules, abort; on a device that is the CPU."""

import numpy as np
import pytest
from fake_device import FakeDevice
from scenes import blob, everything

from vtkmcvr import schedule
from vtkmcvr.film.moments import copy_film
from vtkmcvr.gpu import launches
from vtkmcvr.gpu.errors import CudaError
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film

SIZE, SEED = (40, 30), 3
PLANNED = plan(everything(vol=blob(5), size=SIZE))


@pytest.fixture(autouse=True)
def small_launches(monkeypatch):
    monkeypatch.setattr(launches, "LEAST_PATHS", 400)
    monkeypatch.setattr(launches, "LAUNCH_SECONDS", 0.0)


def rules(samples=None, seconds=None, abort=None, nrms=None):
    return schedule.StopRules(samples, seconds, abort, nrms)


def run(device, stop, film=None, **options):
    film = empty_film(PLANNED) if film is None else film
    return launches.run(device, PLANNED.packed, film, stop, SEED, **options)


def on_cpu(samples):
    film = empty_film(PLANNED)
    schedule.run(PLANNED.packed, film, rules(samples), SEED, 1)
    return film


def same_bits(film, other):
    fields = "count", "mean", "m2", "hits", "depth", "rejected"
    return all(
        np.array_equal(getattr(film, name), getattr(other, name)) for name in fields
    ) and np.array_equal(film.batches.m2, other.batches.m2)


def test_a_pass_in_bands_is_the_picture_of_the_cpu():
    device = FakeDevice()
    film, stopped_by, seconds = run(device, rules(samples=3))
    assert stopped_by == "samples" and seconds > 0 and device.compiled == 1
    # 400 paths are 10 rows of 40 pixels: 8, a multiple of the rows of a block
    bands = [(0, 8), (8, 16), (16, 24), (24, 30)]
    assert device.launched == [(rows, cap) for cap in (1, 2, 3) for rows in bands]
    assert same_bits(film, on_cpu(3))


def test_the_device_always_has_something_to_do():
    device = FakeDevice()
    run(device, rules(samples=2))
    assert device.most_in_flight == launches.QUEUED == 2


def test_launches_grow_to_the_time_they_should_take(monkeypatch):
    monkeypatch.setattr(launches, "LAUNCH_SECONDS", 1e6)
    device = FakeDevice()
    run(device, rules(samples=40))
    first, later = device.launched[0], device.launched[-1]
    assert first == ((0, 8), 1)
    assert later == ((0, 30), 40)
    assert len(device.launched) < 12


def test_the_film_given_stays_as_it_is():
    film = empty_film(PLANNED)
    run(FakeDevice(), rules(samples=1), film)
    assert not film.count.any()


@pytest.mark.parametrize("looks", [1, 3])
def test_abort_leaves_a_film_that_can_be_continued_to_the_same_bits(looks):
    asked = iter([False] * looks + [True] * 100)
    device = FakeDevice()
    film, stopped_by, _ = run(device, rules(samples=4, abort=lambda: next(asked)))
    assert stopped_by == "user"
    assert 0 < film.count.sum() < 4 * film.count.size
    # No more than what was queued when it was noticed
    assert len(device.launched) <= looks + launches.QUEUED
    film, stopped_by, _ = run(FakeDevice(), rules(samples=4), film)
    assert stopped_by == "samples"
    assert same_bits(film, on_cpu(4))


def test_time_ends_a_run():
    film, stopped_by, seconds = run(FakeDevice(), rules(seconds=0.05))
    assert stopped_by == "seconds"
    assert 0.05 <= seconds < 30
    assert film.count.sum() > 0


def test_error_ends_a_run(monkeypatch):
    monkeypatch.setattr(schedule, "LEAST_PATHS", 1000)
    film, stopped_by, _ = run(FakeDevice(), rules(nrms=0.5))
    assert stopped_by == "nrms"
    assert film.count.min() >= schedule.LEAST_SAMPLES


def test_pixels_with_numbers_of_their_own():
    counts = np.full(SIZE[::-1], 2, np.int64)
    counts[5:9, 7:] = 4
    film, _, _ = run(FakeDevice(), rules(samples=2), counts=counts)
    assert np.array_equal(film.count, counts)
    assert np.array_equal(film.mean[5:9, 7:], on_cpu(4).mean[5:9, 7:])


def test_progress_rises_to_one():
    seen = []
    run(FakeDevice(), rules(samples=3), progress=lambda p: seen.append((p.fraction, p.samples)))
    assert seen == sorted(seen)
    assert seen[-1] == (1.0, 3)


def test_a_broken_launch_is_an_error_and_changes_nothing():
    film = empty_film(PLANNED)
    before = copy_film(film)
    with pytest.raises(CudaError, match="broken"):
        run(FakeDevice(fail_at=2, error=CudaError("broken")), rules(samples=2), film)
    assert same_bits(film, before)


def test_adaptive_samples_are_those_of_the_cpu():
    density = np.full(SIZE[::-1], 3, np.int64)
    density[:, 20:] = 5
    film, _, _ = run(FakeDevice(), rules(samples=9), density=density)
    expected = empty_film(PLANNED)
    schedule.run(PLANNED.packed, expected, rules(9), SEED, 1, density=density)
    assert film.count[0, 0] == 7 and film.count[0, -1] == 12
    assert same_bits(film, expected)
