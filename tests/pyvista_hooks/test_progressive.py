"""Pictures that are refined while the interface goes on."""

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from plotters import add, look, pixels, plotter
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

from vtkmcvr import schedule
from vtkmcvr.live import refiner


@pytest.fixture
def target():
    result = plotter()
    add(result)
    look(result)
    result.mcvr.enable(samples=32, progressive=True, text=True)
    result.show(auto_close=False)
    yield result
    result.close()


def view_of(target):
    return target.mcvr._live.views[0]


def frame_of(target):
    """What the window shows, without drawing it anew."""
    window, values = target.render_window, vtkUnsignedCharArray()
    width, height = window.GetSize()
    window.GetPixelData(0, 0, width - 1, height - 1, 1, values, 0)
    return vtk_to_numpy(values).copy()


def test_wait_draws_the_finished_picture(target):
    assert target.mcvr.wait(timeout=120)
    assert target.mcvr.done and target.mcvr.samples == 32
    words = view_of(target).shown.words
    assert words.startswith("32 samples, error ") and words.endswith(" %")
    refined = target.mcvr.picture.radiance
    target.mcvr.enable(progressive=False)
    pixels(target)
    np.testing.assert_array_equal(target.mcvr.picture.radiance, refined)


def test_a_new_view_is_shown_within_its_frame_and_then_refined(target):
    target.mcvr.wait(timeout=120)
    look(target, (3.0, 2.0, 6.0))
    target.render()
    assert not target.mcvr.done and target.mcvr.samples <= 1
    view = view_of(target)
    assert not view.settled and not view.waiting
    # The next event without a change begins the refinement
    view.look_on()
    assert view.settled
    assert target.mcvr.wait(timeout=120)
    assert target.mcvr.samples == 32


def test_a_headlight_goes_with_the_camera_and_begins_nothing_anew(target):
    target.renderer.add_light(pv.Light(light_type="headlight"))
    target.render()
    look(target, (3.0, 2.0, 6.0))
    target.render()
    view = view_of(target)
    restarts = view.restarts
    view.look_on()
    assert view.settled and not view.waiting
    target.render()
    assert view.restarts == restarts


def test_what_has_changed_before_the_refinement_takes_another_frame(target):
    target.mcvr.wait(timeout=120)
    look(target, (3.0, 2.0, 6.0))
    target.render()
    look(target, (2.0, 3.0, 6.0))
    view = view_of(target)
    view.look_on()
    assert not view.settled and view.waiting
    target.render()
    view.look_on()
    assert view.settled and not view.waiting


def test_what_is_looked_at_between_frames_leaves_the_window_as_it_is(target):
    """The window keeps its frame, and its next one, while meshes are drawn beside it."""
    target.add_mesh(pv.Sphere(radius=0.6, center=(0.0, 0.0, 1.2)), color="gold", render=False)
    target.render()
    before, view, looks = frame_of(target), view_of(target), 0
    while not view.settled:
        view.look_on()
        looks += 1
        np.testing.assert_array_equal(frame_of(target), before)
    # One at least for the meshes, one to begin the picture
    assert looks > 1 and np.ptp(before) > 100
    assert view.job.edges.where.any()


def test_a_change_stops_the_refinement_at_once(target):
    target.mcvr.enable(samples=2**30)
    target.render()
    target.render()
    job = view_of(target).job
    assert not job.cancelled
    look(target, (3.0, 2.0, 6.0))
    begin = time.perf_counter()
    target.render()
    assert job.cancelled
    assert time.perf_counter() - begin < 5
    samples = job.samples
    time.sleep(0.3)
    assert job.samples - samples <= 1


def test_the_refiner_rests_while_a_frame_is_drawn(target, monkeypatch):
    """No tile is begun between the two ends of a frame, and it goes on behind it.

    The end is the window's: software GL draws after the renderer has said what.
    """
    # This frame takes longer than one that only draws
    monkeypatch.setattr(schedule, "PAUSE_SECONDS", 30.0)
    target.mcvr.enable(samples=2**30)
    target.render()
    target.render()
    view, counts = view_of(target), []
    # Kernels are read from the disk within the first tile
    end = time.perf_counter() + 60
    while not view.job.samples:
        assert time.perf_counter() < end
        time.sleep(0.05)

    def look_on(*_):
        # Tiles at work are finished
        time.sleep(0.2)
        for _ in range(2):
            counts.append(int(view.job.film.count.sum()))
            time.sleep(0.2)

    renderer = target.renderer
    tags = [renderer.AddObserver(event, look_on, -1.0) for event in ("StartEvent", "EndEvent")]
    target.render()
    for tag in tags:
        renderer.RemoveObserver(tag)
    assert len(counts) == 4 and len(set(counts)) == 1
    end = time.perf_counter() + 20
    while view.job.film.count.sum() == counts[1]:
        assert time.perf_counter() < end
        time.sleep(0.05)


def test_errors_of_the_thread_reach_the_interface(target, monkeypatch):
    target.mcvr.wait(timeout=120)

    def fail(self, most=None):
        raise MemoryError("no room")

    monkeypatch.setattr("vtkmcvr.live.job.Job.advance", fail)
    look(target, (3.0, 2.0, 6.0))
    target.render()
    with pytest.warns(RuntimeWarning, match="no room"):
        target.render()
        view_of(target).refiner.wait(10)
        target.render()


def test_closing_ends_the_thread(target):
    target.mcvr.enable(samples=2**30)
    target.render()
    target.render()
    assert any(thread.name == "vtkmcvr" for thread in threading.enumerate())
    target.mcvr.disable()
    assert not any(thread.name == "vtkmcvr" for thread in threading.enumerate())


class _Steps:
    """A job of five steps that takes notes."""

    def __init__(self, notes, name):
        self.notes, self.name, self.samples = notes, name, 0
        self.done = self.cancelled = False

    def cancel(self):
        self.cancelled = True

    def advance(self):
        self.notes.append(self.name)
        self.samples += 1
        self.done = self.samples == 5


def test_several_views_are_refined_in_turn():
    notes, worker = [], refiner.Refiner()
    one, other = _Steps(notes, "a"), _Steps(notes, "b")
    with worker._change:
        worker.put("one", one)
        worker.put("other", other)
    assert worker.wait(10)
    worker.close()
    assert sorted(notes) == list("aaaaabbbbb")
    assert notes[:2] == ["a", "b"] and notes[2:4].count("a") == 1


@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="no X server (Xvfb) for a window")
def test_a_window_is_refined_by_its_own_timer(tmp_path):
    server = subprocess.Popen(
        ["Xvfb", "-noreset", "-displayfd", "1", "-screen", "0", "800x600x24"],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        display = ":" + server.stdout.readline().decode().strip()
        script = Path(__file__).with_name("window_script.py")
        done = subprocess.run(
            [sys.executable, str(script), str(tmp_path / "window.png")],
            capture_output=True, text=True, timeout=300, env={**os.environ, "DISPLAY": display},
        )  # fmt: skip
    finally:
        server.terminate()
        server.wait(10)
        server.stdout.close()
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    assert seen["done"]
    assert len(seen["first"]) > 2 and seen["first"] == sorted(seen["first"])
    assert seen["restarted"] >= 7
    assert seen["after_drag"] <= 1
    assert seen["text"].startswith("64 samples")
    # Generous: other programs may be running
    assert np.median(seen["views"]) < 1.0 and seen["gap"] < 1.0
    # A plane widget, whose handles are made anew when they are drawn, begins nothing anew; where
    # there is nothing new to see, nothing is drawn, though charts would be at each timer event
    assert seen["widgets"] == {"restarts": 0, "frames": 0, "done": True}


def test_occlusion_has_a_coarse_picture_first():
    target = plotter()
    add(target)
    look(target)
    target.mcvr.enable(technique="occlusion", progressive=True, text=True)
    target.show(auto_close=False)
    assert view_of(target).shown.samples == 0 and not target.mcvr.done
    assert target.mcvr.wait(timeout=120)
    assert target.mcvr.done and view_of(target).shown.words == "occlusion"
    finished = pixels(target)
    target.mcvr.enable(progressive=False)
    np.testing.assert_array_equal(pixels(target)[:60], finished[:60])
    target.close()
