"""Directional occlusion on a device: launches, progress, abort, errors, the way back to the CPU."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from fake_sweep import FakeSweepDevice
from scenes import blob, medium, scene

from vtkmcvr import backends, render, replay
from vtkmcvr.gpu import errors, launches, sweeps
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.occlusion.carry_out import sweep
from vtkmcvr.occlusion.rendering import layout, parts_of
from vtkmcvr.occlusion.tables import blocks_in, tables_of
from vtkmcvr.recipes.files import read_recipe
from vtkmcvr.scene import Volume

SETTINGS = Occlusion(directions=4, slices=50)
SCENE = scene(blob(5), medium(6.0), size=(12, 9))
BLOCKS = 7


@pytest.fixture(scope="module")
def parts():
    planned, raster, _ = layout(SCENE, SETTINGS)
    return parts_of(SCENE, planned, raster, SETTINGS)


@pytest.fixture(scope="module")
def film(parts):
    return sweep("cpu", parts, 1).film


@pytest.fixture
def with_device(monkeypatch):
    def use(fake):
        monkeypatch.setattr(backends, "missing", lambda: None)
        monkeypatch.setattr(sweeps, "SweepDevice", lambda: fake)
        return fake

    return use


def copied(film):
    return type(film)(*(None if a is None else a.copy() for a in film))


def run(device, parts, **options):
    tables = tables_of(*parts)
    return sweeps.run(device, tables, blocks_in(parts.raster), **options)


def test_every_block_is_swept_once_in_order(parts, film):
    device = FakeSweepDevice(film)
    found, work, ended = run(device, parts)
    assert found is film and ended and work == (3, 2)
    firsts, lasts = zip(*device.swept, strict=True)
    assert firsts[0] == 0 and lasts[-1] == blocks_in(parts.raster) == BLOCKS
    assert firsts[1:] == lasts[:-1]
    assert device.compiled == 1
    assert device.most_in_flight <= launches.QUEUED


def test_launches_grow_to_the_time_they_should_take(parts, film, monkeypatch):
    monkeypatch.setattr(sweeps, "LAUNCH_SECONDS", 1e6)
    device = FakeSweepDevice(film)
    run(device, parts)
    assert device.swept[0] == (0, 1)
    assert len(device.swept) <= 4
    monkeypatch.setattr(sweeps, "LAUNCH_SECONDS", 0.0)
    device = FakeSweepDevice(film)
    run(device, parts)
    assert len(device.swept) == BLOCKS


def test_progress_rises_to_one(parts, film, monkeypatch):
    monkeypatch.setattr(sweeps, "LAUNCH_SECONDS", 0.0)
    seen = []
    run(FakeSweepDevice(film), parts, progress=seen.append)
    assert seen == sorted(seen) and len(seen) == BLOCKS and seen[-1] == 1.0


def test_abort_ends_after_what_is_queued(parts, film, monkeypatch):
    monkeypatch.setattr(sweeps, "LAUNCH_SECONDS", 0.0)
    asked = iter([False, True])
    device = FakeSweepDevice(film)
    _, _, ended = run(device, parts, abort=lambda: next(asked))
    assert not ended
    assert len(device.swept) <= 2 + launches.QUEUED < BLOCKS


def test_what_is_blank_is_not_copied_and_shared_arrays_stay_one():
    faint = replace(SCENE, transfer=medium(0.1))
    planned, raster, _ = layout(faint, SETTINGS)
    tables = tables_of(*parts_of(faint, planned, raster, SETTINGS))
    blank = [
        *(a for a in tables.film if a is not None), *tables.eye, tables.sheets.depth,
        tables.light.beams.buffers,
    ]  # fmt: skip
    assert all(not any(a.strides) for a in blank)
    assert tables.sheets.whole is tables.sheets.depth


@pytest.mark.parametrize("backend", ["auto", "cuda"])
def test_picture_says_which_device_made_it(with_device, film, backend):
    with_device(FakeSweepDevice(copied(film)))
    picture = render_occlusion(SCENE, SETTINGS, backend=backend)
    assert (picture.backend, picture.facts()["backend"]) == ("cuda", "cuda")
    assert picture.facts()["device"] == FakeSweepDevice.name
    assert f"CUDA ({FakeSweepDevice.name})" in str(picture)
    assert (picture.work.looked_up, picture.work.seen) == (3, 2)
    on_cpu = render_occlusion(SCENE, SETTINGS, backend="cpu")
    assert "threads" in str(on_cpu) and on_cpu.backend == "cpu"
    assert np.array_equal(picture.radiance, on_cpu.radiance)


FAILURES = {
    "too large": dict(room=False),
    "at the first launch": dict(fail_at=0, error=errors.CudaError("CUDA failed: lost")),
    "later": dict(fail_at=2, error=errors.CudaError("CUDA failed: lost")),
}


@pytest.mark.parametrize("failure", FAILURES)
def test_auto_goes_over_to_the_cpu_and_says_so(with_device, caplog, film, failure):
    with_device(FakeSweepDevice(**FAILURES[failure]))
    with caplog.at_level(logging.WARNING):
        picture = render_occlusion(SCENE, SETTINGS)
    assert picture.backend == "cpu"
    assert "rendered on the CPU: " in caplog.text
    assert any("rendered on the CPU: " in note for note in picture.facts()["notes"])
    expected = render_occlusion(SCENE, SETTINGS, backend="cpu")
    assert np.array_equal(picture.radiance, expected.radiance)


@pytest.mark.parametrize("failure", FAILURES)
def test_cuda_by_name_does_not_go_over_to_the_cpu(with_device, failure):
    with_device(FakeSweepDevice(**FAILURES[failure]))
    with pytest.raises(errors.CudaError):
        render_occlusion(SCENE, SETTINGS, backend="cuda")


def test_cuda_by_name_without_a_device_says_what_is_missing(monkeypatch):
    monkeypatch.setattr(backends, "missing", lambda: "there is no NVIDIA driver")
    with pytest.raises(errors.CudaUnavailable, match="no NVIDIA driver"):
        render(SCENE, technique="occlusion", backend="cuda")


def test_a_scene_without_medium_takes_no_launch(with_device):
    device = with_device(FakeSweepDevice())
    empty = replace(SCENE, volume=Volume(np.zeros((5, 5, 5), np.float32), np.eye(4)))
    picture = render_occlusion(empty, SETTINGS, backend="cuda")
    assert picture.backend == "cuda" and not picture.alpha.any()
    assert not device.swept


def test_replay_takes_the_recorded_backend(with_device, monkeypatch, film, tmp_path):
    fake = with_device(FakeSweepDevice(copied(film)))
    render(SCENE, technique="occlusion", occlusion=SETTINGS).save(tmp_path / "a.npz")
    recipe = read_recipe(tmp_path / "a.npz")
    assert recipe["replay"]["backend"] == "cuda"
    fake.film = copied(film)
    again = replay(recipe, [SCENE.volume])
    assert (again.picture.backend, again.identical, again.notes) == ("cuda", True, ())
    monkeypatch.setattr(backends, "missing", lambda: "gone")
    elsewhere = replay(recipe, [SCENE.volume])
    assert elsewhere.picture.backend == "cpu"
    assert any("CUDA" in note for note in elsewhere.notes)
