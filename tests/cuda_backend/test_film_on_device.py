"""Films on a device: pictures and errors of them without copying them; refined step by step."""

import math
import os
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fake_device import FakeDevice
from needs import compiler, numba_cuda
from scenes import blob, everything

from vtkmcvr import schedule
from vtkmcvr.accuracy import error_of, image_error, totals_of
from vtkmcvr.film import moments
from vtkmcvr.gpu import launches
from vtkmcvr.gpu.progressive import DevicePicture
from vtkmcvr.packed import BATCH, Batches
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.schedule import StopRules
from vtkmcvr.screen import Display, packed_screen, shown

PROGRAM = Path(__file__).parents[1] / "cuda_film.py"
SIZE, SEED = (20, 43), 3
PLANNED = plan(everything(vol=blob(5), size=SIZE))
SMALL = (9, 18)


def film_of(batched=True, cover=False, count=5 * BATCH + 3):
    """A film of noise around all kinds of light: none, little, much; and coverage."""
    random = np.random.default_rng(11)
    film = moments.new_film(*SMALL[::-1], veils=cover)
    film.count[:] = count
    film.count[3, 2:5] = 2, 3, 3 * BATCH
    film.mean[:] = np.exp(random.uniform(-9, 1, film.mean.shape))
    film.mean[0, :4] = 0
    film.m2[:] = random.uniform(0, 1, film.m2.shape)
    film.hits[:] = random.integers(0, film.count + 1)
    film.hits[0, :3] = 0, 1, film.count[0, 2]
    if cover:
        film.cover[:] = film.hits / film.count * random.uniform(0, 1, SMALL)
    if batched:
        m2 = random.uniform(0, 1, film.m2.shape)
        film = film._replace(batches=Batches(film.mean.copy(), m2))
    return film


DISPLAYS = {
    "plain": Display(),
    "brighter, on a background": Display(2.5, background=(0.2, 0.4, 0.9)),
    "film filter": Display(1.0, film_filter="gaussian-5x5"),
    "gamma, film filter, on white": Display(
        1.0, background=(1, 1, 1), gamma=2.2, film_filter="gaussian-5x5"
    ),
    "no curve": Display(-1.0, curve="none", gamma=1.0),
    "exposed beyond all measure": Display(1000.0),
}
FILMS = {
    "batches": film_of(),
    "independent samples, veils": film_of(batched=False, cover=True),
    "one sample": film_of(count=1),
}
CASES = {
    **{name: ("batches", display, 1) for name, display in DISPLAYS.items()},
    "veils": ("independent samples, veils", DISPLAYS["film filter"], 1),
    "unknown": ("one sample", Display(), 1),
    "three devices": ("batches", Display(), 3),
    "three devices, film filter": ("batches", DISPLAYS["film filter"], 3),
}


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("films")
    jobs = [(FILMS[film], packed_screen(display), n) for film, display, n in CASES.values()]
    (folder / "in").write_bytes(pickle.dumps(jobs))
    subprocess.run(
        [sys.executable, PROGRAM, folder / "in", folder / "out"], check=True, timeout=200,
        env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1",
             "PYTHONWARNINGS": "ignore::RuntimeWarning"},
    )  # fmt: skip
    return dict(zip(CASES, pickle.loads((folder / "out").read_bytes()), strict=True))


def shown_on_cpu(film, display):
    return shown(film.mean.astype(np.float32), moments.alpha(film), display)


def check_shown(found, film, display):
    expected = shown_on_cpu(film, display)
    assert found.dtype == np.uint8
    apart = np.abs(found.astype(int) - expected)
    # Bytes are rounded from values that differ by roundings
    assert apart.max() <= 1 and np.mean(apart > 0) < 0.01


@numba_cuda
@pytest.mark.parametrize("name", CASES)
def test_simulated_picture_is_that_of_the_cpu(simulated, name):
    film, display, _ = CASES[name]
    picture, _ = simulated[name]
    check_shown(picture, FILMS[film], display)
    if "beyond" not in name:
        assert np.unique(picture[..., :3]).size > 30


@numba_cuda
@pytest.mark.parametrize("name", CASES)
def test_simulated_error_is_that_of_the_cpu(simulated, name):
    film = FILMS[CASES[name][0]]
    _, totals = simulated[name]
    expected = totals_of(film)
    known = 4 if expected.unknown else len(expected)
    np.testing.assert_allclose(totals[:known], expected[:known], rtol=1e-12)
    assert error_of(totals, film.mean.size).nrms == pytest.approx(image_error(film).nrms, rel=1e-12)


def test_films_reach_what_is_to_be_compared():
    assert image_error(FILMS["one sample"]).nrms == math.inf
    assert 0.01 < image_error(FILMS["batches"]).nrms < 1
    before = totals_of(FILMS["batches"])
    film = FILMS["batches"]._replace(batches=None)
    assert totals_of(film).noise != pytest.approx(before.noise, rel=0.01)
    assert before.least == 2
    a, b = (shown_on_cpu(film, DISPLAYS[name]) for name in ("plain", "film filter"))
    assert np.abs(a.astype(int) - b).max() > 20


@compiler
@pytest.mark.parametrize("capability", [(7, 5), (9, 0)])
def test_picture_compiles_without_doubles_but_those_of_the_film(capability, monkeypatch):
    from numba.cuda.typing.typeof import typeof
    from ptx import DOUBLE, doubles, pretend, ptx_of

    from vtkmcvr.kernels.film_cuda import show_pixels, total_pixels

    pretend(monkeypatch, capability)
    film, screen = FILMS["batches"], packed_screen(DISPLAYS["gamma, film filter, on white"])
    types = tuple(map(typeof, (film, screen, np.zeros((2, 2, 4), np.uint8))))
    ptx = ptx_of(show_pixels.py_func, types, capability)
    assert set(doubles(ptx)) <= {"shown.py", "merged"}
    # Means are turned to float32 as they are read
    found = [match[1] for line in ptx.splitlines() if (match := DOUBLE.match(line))]
    assert found and all(name.startswith(("cvt.rn", "ld")) for name in found), found
    types = tuple(map(typeof, (film, np.zeros((2, 9)), np.int64(1), np.int64(0))))
    assert "shared" in ptx_of(total_pixels.py_func, types, capability)


def rules(samples, nrms=None, abort=None):
    return StopRules(samples, None, abort, nrms)


def straight(samples):
    return launches.run(
        FakeDevice(), PLANNED.packed, empty_film(PLANNED), rules(samples), SEED
    )[0]  # fmt: skip


@pytest.fixture
def small_launches(monkeypatch):
    monkeypatch.setattr(launches, "LEAST_PATHS", 400)
    monkeypatch.setattr(launches, "LAUNCH_SECONDS", 0.0)


def test_a_picture_refined_in_steps_is_that_of_one_run(small_launches):
    device = FakeDevice()
    picture = DevicePicture(device, PLANNED.packed, empty_film(PLANNED), SEED)
    assert picture.samples == 0 and picture.error.nrms == math.inf
    for samples in (1, 3, 7):
        assert picture.advance(rules(samples)) == "samples"
        assert picture.samples == samples
    assert device.downloads == 0 and device.compiled == 1 and picture.seconds > 0
    film, expected = picture.film(), straight(7)
    assert np.array_equal(film.mean, expected.mean) and np.array_equal(film.m2, expected.m2)
    assert picture.error == image_error(expected)


def test_what_is_shown_is_the_picture_and_no_film_is_copied(small_launches):
    device = FakeDevice()
    picture = DevicePicture(device, PLANNED.packed, empty_film(PLANNED), SEED)
    picture.advance(rules(4))
    for name in ("brighter, on a background", "film filter"):
        check_shown(picture.shown(DISPLAYS[name]), straight(4), DISPLAYS[name])
    assert device.downloads == 0


def test_a_step_that_was_aborted_can_be_gone_on_with(small_launches):
    picture = DevicePicture(FakeDevice(), PLANNED.packed, empty_film(PLANNED), SEED)
    asked = iter(range(100))
    assert picture.advance(rules(4, abort=lambda: next(asked) > 3)) == "user"
    assert 0 <= picture.samples < 4
    assert picture.advance(rules(4)) == "samples"
    assert np.array_equal(picture.film().mean, straight(4).mean)


def test_a_wanted_error_copies_no_film_before_the_end(monkeypatch):
    monkeypatch.setattr(schedule, "LEAST_PATHS", 1)
    device = FakeDevice()
    film, stopped_by, _ = launches.run(
        device, PLANNED.packed, empty_film(PLANNED), rules(None, nrms=0.5), SEED
    )
    assert stopped_by == "nrms" and image_error(film).high <= 0.5
    assert device.downloads == 1
    other = replace(Display(), exposure=1.0)
    assert packed_screen(other).scale == 2
