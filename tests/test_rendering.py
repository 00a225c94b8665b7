"""Passes, tiles, threads and stop rules: no pixel depends on them."""

import time
from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, frontal, medium, noise, render, scene

from vtkmcvr import Layer, Plane, PlaneReceiver, schedule
from vtkmcvr.lights import ConstantEnvironment, RectangleLight
from vtkmcvr.pictures.picture import Display
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film, render_scene
from vtkmcvr.schedule import StopRules
from vtkmcvr.sight import nothing_seen

LIT = scene(noise(), lights=(ConstantEnvironment(1.0),), size=(61, 47))
# Takes seconds at the least on any machine
LONG = scene(
    noise(33), medium(40.0), frontal(1.0), lights=(ConstantEnvironment(1.0),), size=(640, 480)
)


def assert_same(picture, other):
    for name, a, b in zip(picture.film._fields, picture.film, other.film, strict=True):
        np.testing.assert_array_equal(a, b, err_msg=name)


def assert_valid(picture):
    assert not np.isnan(np.concatenate([a.ravel() for a in picture.arrays().values()])).any()
    assert (picture.film.count >= 0).all()
    untouched = picture.film.count == 0
    assert not picture.radiance[untouched].any()
    assert not picture.alpha[untouched].any()
    assert np.isinf(picture.standard_error[picture.film.count < 2]).all()


@pytest.fixture(scope="module")
def picture():
    return render(LIT, samples=64, seed=5)


def test_picture_says_what_it_is(picture):
    assert picture.samples == 64
    assert (picture.film.count == 64).all()
    assert picture.size == (61, 47)
    assert picture.radiance.shape == (47, 61, 3)
    assert picture.stopped_by == "samples"
    assert picture.rejected_samples == 0
    assert picture.seed == 5
    assert picture.seconds > 0
    assert picture.paths_per_second == pytest.approx(64 * 61 * 47 / picture.seconds)
    assert 0 < picture.nrms < 0.5
    assert picture.facts()["samples"] == 64


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_bits_do_not_depend_on_threads(picture, threads):
    assert_same(picture, render(LIT, samples=64, seed=5, threads=threads))


@pytest.mark.parametrize(("first", "largest"), [(4, 4), (5, 7), (1000, 1000)])
def test_bits_do_not_depend_on_tiles(picture, monkeypatch, first, largest):
    monkeypatch.setattr(schedule, "FIRST_TILE", first)
    monkeypatch.setattr(schedule, "LARGEST_TILE", largest)
    assert_same(picture, render(LIT, samples=64, seed=5, threads=3))


def test_bits_do_not_depend_on_passes(picture, monkeypatch):
    monkeypatch.setattr(schedule, "PASS_SECONDS", 1e-3)
    assert_same(picture, render(LIT, samples=64, seed=5))


def test_continued_picture_is_the_uninterrupted_one(picture):
    half = render(LIT, samples=32, seed=5)
    whole = half.refine(64)
    assert_same(whole, picture)
    # The first half stays as it was
    assert half.samples == 32
    assert_same(half, render(LIT, samples=32, seed=5))
    assert whole.seconds > half.seconds
    # It is already there
    assert_same(whole.refine(10), picture)


def test_picture_stopped_by_the_user_and_continued_is_the_uninterrupted_one(picture, monkeypatch):
    # Slow and small passes, so that it stops in the middle of one
    monkeypatch.setattr(schedule, "POLL_SECONDS", 1e-4)
    calls = []
    stopped = render(
        LIT, samples=64, seed=5, threads=2, abort=lambda: calls.append(1) or len(calls) > 3
    )
    assert stopped.stopped_by == "user"
    assert stopped.film.count.sum() < 64 * 61 * 47
    assert_valid(stopped)
    assert_same(stopped.refine(64), picture)


def test_picture_stopped_by_time_and_continued_is_the_uninterrupted_one(picture, monkeypatch):
    monkeypatch.setattr(schedule, "POLL_SECONDS", 1e-4)
    stopped = render(LIT, samples=64, seed=5, seconds=2e-3)
    assert stopped.stopped_by == "seconds"
    assert_valid(stopped)
    assert_same(stopped.refine(64), picture)


def test_refine_for_some_seconds_adds_samples():
    start = render(LIT, samples=2, seed=5)
    more = start.refine(seconds=0.1)
    assert more.stopped_by == "seconds"
    assert more.samples > 2
    assert_same(more.refine(more.film.count.max()), render(LIT, more.film.count.max(), seed=5))


def test_other_seeds_give_other_pictures(picture):
    other = render(LIT, samples=64, seed=6)
    assert np.mean(other.radiance == picture.radiance) < 0.2
    # Each is within 5 combined standard errors of the other, 1e-6 x 2867 pixels
    error = np.hypot(other.standard_error, picture.standard_error)[..., 0]
    difference = np.abs(other.radiance - picture.radiance)[..., 0]
    assert (difference <= 5 * error + 1e-6).mean() > 0.999


def test_seconds_are_honoured():
    render(LONG, samples=1)
    start = time.perf_counter()
    picture = render_scene(LONG, seconds=0.5, seed=1)
    elapsed = time.perf_counter() - start
    assert picture.stopped_by == "seconds"
    assert 0.4 < picture.seconds < 1.5
    assert elapsed < 3
    assert_valid(picture)


def test_seconds_are_kept_within_a_tenth():
    # The least delay of five: other programs on the machine only add to it
    render(LONG, samples=1)
    late = [render_scene(LONG, seconds=0.4, seed=seed).seconds - 0.4 for seed in range(5)]
    assert 0 <= min(late) <= 0.1


def test_abort_ends_promptly():
    start = time.perf_counter()
    wanted = []

    def abort():
        if not wanted and time.perf_counter() - start > 0.3:
            wanted.append(time.perf_counter())
        return bool(wanted)

    picture = render_scene(LONG, samples=10_000, abort=abort)
    assert picture.stopped_by == "user"
    assert time.perf_counter() - wanted[0] < 0.5
    assert_valid(picture)


def test_abort_in_the_first_pass_gives_a_valid_picture():
    picture = render_scene(LONG, samples=4, abort=lambda: True)
    assert picture.stopped_by == "user"
    assert picture.samples == 0
    assert_valid(picture)
    assert np.isinf(picture.nrms)
    assert picture.facts()["nrms"] is None
    assert picture.rgba.shape == (480, 640, 4)


def test_the_last_sample_counts_as_done():
    # Aborting after the goal is reached does not take it away
    picture = render_scene(LIT, samples=1, abort=lambda: False, seconds=1000)
    assert picture.stopped_by == "samples"


def test_progress_rises_to_the_end():
    seen = []
    render(LIT, samples=64, seed=5, progress=seen.append)
    fractions = [p.fraction for p in seen]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    assert seen[-1].samples == 64
    assert all(0 <= f <= 1 for f in fractions)


def test_exception_in_a_callback_ends_the_render():
    def fail(_):
        raise KeyError("from the callback")

    with pytest.raises(KeyError, match="from the callback"):
        render_scene(LONG, samples=100, progress=fail)


def test_plan_can_be_rendered_and_display_costs_no_ray():
    planned = plan(LIT)
    picture = render(planned, samples=2, display=Display(exposure=1.0))
    assert picture.plan is planned
    brighter = picture.show(Display(exposure=3.0))
    assert brighter[..., :3].mean() > picture.rgba[..., :3].mean()
    assert picture.samples == 2


@pytest.mark.parametrize("size", [(1, 1), (1, 70), (70, 1), (33, 65)])
def test_films_of_odd_sizes_are_filled(size):
    small = scene(noise(), lights=(ConstantEnvironment(1.0),), size=size)
    picture = render(small, samples=3)
    assert (picture.film.count == 3).all()
    assert picture.alpha.shape == size[::-1]


def test_empty_scene_returns_at_once():
    empty = scene(transfer=medium(0.0), lights=(ConstantEnvironment(1.0),), size=(400, 300))
    render(empty, samples=1)
    start = time.perf_counter()
    picture = render(empty, samples=16)
    assert time.perf_counter() - start < 2
    assert not picture.alpha.any()
    assert picture.nrms == 0


BLANK = {
    "transparent": scene(transfer=medium(0.0), lights=(ConstantEnvironment(),)),
    "transparent, with a second one": scene(
        transfer=medium(0.0), layers=(Layer(blob(), medium(0.0)),), aovs=("albedo",)
    ),
    "cut off": scene(clip=(Plane((9, 0, 0), (1, 0, 0)),), sampler="independent"),
}  # fmt: skip


@pytest.mark.parametrize("name", BLANK)
def test_transparent_view_returns_at_once_with_the_film_of_a_long_run(name):
    planned = plan(replace(BLANK[name], size=(400, 300)))
    film = empty_film(planned)
    seen = []
    start = time.perf_counter()
    rules = StopRules(10**9, None, None)
    assert schedule.run(planned.packed, film, rules, 1, 2, seen.append) == ("samples", 0.0)
    assert time.perf_counter() - start < 0.5
    assert [progress.fraction for progress in seen] == [1.0]
    assert (film.count == 10**9).all()
    for part in (film.mean, film.m2, film.hits, film.rejected):
        assert not part.any()


def test_transparent_view_without_a_number_of_samples_ends_dark():
    picture = render_scene(BLANK["transparent"], seconds=100.0, adaptive=True)
    assert picture.stopped_by == "dark"
    assert picture.seconds < 1
    assert (picture.alpha == 0).all()
    again = picture.refine(samples=64)
    assert (again.samples, again.stopped_by) == (64, "samples")


@pytest.mark.parametrize(
    "changes",
    [
        {"lights": (ConstantEnvironment(),), "environment_visible": True},
        {"lights": (RectangleLight((0, 3, 0), (0, 0, 0), (1, 1), visible=True),)},
        {"receivers": (PlaneReceiver((0, 0, -1), (0, 0, 1), (4, 4)),)},
        {"layers": (Layer(blob(), medium(3.0)),)},
    ],
)
def test_what_is_seen_beside_a_transparent_volume_is_traced(changes):
    assert not nothing_seen(plan(scene(transfer=medium(0.0), **changes)).packed)
