"""Many rays and paths at once: what one at a time gives, up to roundings."""

from dataclasses import replace

import numpy as np
import pytest
from numba import config
from scenes import everything, medium, noise, render, scene, volume

from vtkmcvr import tiles
from vtkmcvr.curves import Curve
from vtkmcvr.kernels.cpu import render_tile as render_one_by_one
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.rng import start, stratified_exponential
from vtkmcvr.kernels.tracking import walk
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.packed import RatioTracking
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.scene import Surface, TransferFunction

pytestmark = pytest.mark.skipif(
    config.DISABLE_JIT, reason="lanes exist in compiled code only: without it, paths go one by one"
)
if not config.DISABLE_JIT:
    from vtkmcvr.kernels.packets import walk_queue
    from vtkmcvr.kernels.pool import (
        DISTANCE,
        FOUND_SCALAR,
        FOUND_SIGMA,
        THROUGH,
        enqueue,
        new_pool,
        new_queue,
    )

N = 3000
RATIO = RatioTracking(np.float32(0.25))


@entry_point
def one_by_one(medium, transfer, ratio, rays, out):
    for i in range(len(rays)):
        o, d = (rays[i, 0], rays[i, 1], rays[i, 2]), (rays[i, 3], rays[i, 4], rays[i, 5])
        rng = start(5, i, 0)
        out[i, 0], out[i, 1], out[i, 2], _, _ = walk(medium, transfer, o, d, rays[i, 6], None, rng)
        _, _, _, out[i, 3], _ = walk(medium, transfer, o, d, rays[i, 6], ratio, rng)


@entry_point
def fill(rays, queue):
    for i in range(len(rays)):
        o, d = (rays[i, 0], rays[i, 1], rays[i, 2]), (rays[i, 3], rays[i, 4], rays[i, 5])
        rng, tau = stratified_exponential(start(5, i, 0))
        enqueue(queue, i, o, d, rays[i, 6], tau, rng.counter)
    queue.size[0] = len(rays)


def at_once(medium, transfer, ratio, rays, queue, pool, out):
    found = queue.found[:, : len(rays)]
    fill(rays, queue)
    walk_queue(medium, transfer, np.bool_(False), np.float32(0), queue, pool)
    out[:, :3] = found[[DISTANCE, FOUND_SCALAR, FOUND_SIGMA]].T
    # What delta tracking lets through
    open_way = found[DISTANCE] < 0
    np.testing.assert_array_equal(found[THROUGH], open_way)
    fill(rays, queue)
    walk_queue(medium, transfer, np.bool_(True), ratio.roulette, queue, pool)
    out[:, 3] = found[THROUGH]


def voxels(kind):
    """Noise with empty corners; a part of it missing where the type has a NaN."""
    values = np.random.default_rng(3).random((23, 19, 27))
    values[:9, :, :14] = 0
    if kind == "float32":
        values[15:18, 5:9, 5:9] = np.nan
        return values.astype(kind)
    info = np.iinfo(kind)
    return (info.min + values * (float(info.max) - info.min)).astype(kind)


def planned(kind):
    """Plan of a spiky medium of these voxels."""
    values = voxels(kind)
    low, high = np.nanmin(values), np.nanmax(values)
    nodes = [(0, 0), (0.3, 0), (0.31, 0.8), (0.5, 0.1), (1, 0.6)]
    curve = Curve([(low + x * (float(high) - low), y) for x, y in nodes])
    transfer = TransferFunction(None, medium(1.0).colour, extinction=curve)
    return plan(scene(volume(values), transfer))


def rays_through(values):
    """Rays from points in a volume, in all directions and along axes, of different lengths."""
    rng = np.random.default_rng(4)
    rays = np.empty((N, 7), np.float32)
    rays[:, :3] = rng.random((N, 3)) * (np.array(values.shape[::-1]) - 1)
    d = rng.standard_normal((N, 3))
    d[: N // 10, rng.integers(3)] = 0
    d[: N // 20] = np.eye(3)[rng.integers(3, size=N // 20)] * rng.choice((-1, 1), (N // 20, 1))
    rays[:, 3:6] = d / np.linalg.norm(d, axis=1, keepdims=True)
    lo, hi = -rays[:, :3], np.array(values.shape[::-1], np.float32) - 1 - rays[:, :3]
    with np.errstate(divide="ignore"):
        leave = np.where(rays[:, 3:6] > 0, hi, lo) / rays[:, 3:6]
    leave[rays[:, 3:6] == 0] = np.inf
    rays[:, 6] = leave.min(1) * np.where(rng.random(N) < 0.5, 1, rng.random(N))
    return rays


@pytest.mark.parametrize(
    "kind",
    ["int16", "float32", *(pytest.param(k, marks=pytest.mark.slow) for k in ("uint8", "uint16"))],
)
def test_rays_at_once_meet_what_they_meet_one_by_one(kind):
    packed = planned(kind).packed
    rays = rays_through(packed.medium.values)
    expected, found = np.zeros((2, N, 4), np.float32)
    one_by_one(packed.medium, packed.transfer, RATIO, rays, expected)
    at_once(packed.medium, packed.transfer, RATIO, rays, new_queue(N + 16), new_pool(), found)
    assert 0.2 < (expected[:, 0] >= 0).mean() < 0.95
    assert 0.05 < expected[:, 3].mean() < 0.9
    # What an escaped ray has met says nothing
    found[found[:, 0] < 0, 1:3] = 0
    span = np.float32(np.nanmax(packed.medium.values)) - np.float32(np.nanmin(packed.medium.values))
    found[:, 1] /= span
    expected[:, 1] /= span
    # A rounding may turn a decision: of tens of decisions a ray, hardly ever
    close = np.isclose(found, expected, rtol=1e-3, atol=1e-3)
    assert close.all(-1).mean() > 0.999
    assert abs(found[:, 3].mean() - expected[:, 3].mean()) < 1e-3


def test_a_ray_does_not_depend_on_the_others():
    packed = planned("int16").packed
    rays = rays_through(packed.medium.values)
    together, alone = np.zeros((2, N, 4), np.float32)
    queue, pool = new_queue(N + 16), new_pool()
    at_once(packed.medium, packed.transfer, RATIO, rays, queue, pool, together)
    some = slice(40, 43)
    # The numbers of a ray are those of its place
    first = np.zeros((43, 4), np.float32)
    at_once(packed.medium, packed.transfer, RATIO, rays[:43], queue, pool, first)
    alone[some] = first[some]
    np.testing.assert_array_equal(alone[some], together[some])


def in_step_and_one_by_one(some, samples=8):
    """Film of a scene by both launchers."""
    made = plan(some)
    assert tiles.goes_in_step(made.packed)
    films = []
    for launch in (tiles.render_tile, render_one_by_one):
        film = empty_film(made)
        height, width = film.count.shape
        goal = np.full_like(film.count, samples)
        launch(film, made.packed, 0, height, 0, width, goal, np.int64(7))
        films.append(film)
    return films


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"scattering": "multiple"},
        {"scattering": "multiple", "max_scatterings": 3},
        {"scattering": "multiple", "max_scatterings": 1},
    ],
    ids=["single", "multiple", "three", "one of many"],
)
def test_paths_in_step_make_the_picture_of_paths_one_by_one(how):
    some = everything(ConstantEnvironment(1.0), surface=Surface(gradient_factor=1.0))
    step, single = in_step_and_one_by_one(replace(some, **how))
    np.testing.assert_array_equal(step.count, single.count)
    np.testing.assert_array_equal(step.hits, single.hits)
    np.testing.assert_allclose(step.depth, single.depth, rtol=1e-5)
    assert step.rejected.sum() == single.rejected.sum() == 0
    # A decision turned by a rounding is rare
    same = np.isclose(step.mean, single.mean, rtol=1e-4, atol=1e-7).all(-1)
    assert same.mean() > 0.99
    error = np.sqrt(single.m2.sum() / 8 / 7)
    assert np.sqrt(((step.mean - single.mean) ** 2).sum()) < 0.1 * error


@pytest.mark.parametrize("scattering", ["single", "multiple"])
def test_more_paths_than_go_in_step_at_once_and_an_interruption_change_no_bit(scattering):
    some = everything(ConstantEnvironment(1.0), vol=noise(), size=(40, 30), scattering=scattering)
    whole = render(some, samples=6).film
    halfway = render(some, samples=2)
    np.testing.assert_array_equal(whole.mean, halfway.refine(6).film.mean)
    made = plan(some)
    film = empty_film(made)
    goal = np.full_like(film.count, 6)
    for row in range(0, 30, 7):
        for column in range(0, 40, 9):
            tiles.render_tile(
                film, made.packed, row, min(row + 7, 30), column, min(column + 9, 40), goal,
                np.int64(1),
            )  # fmt: skip
    np.testing.assert_array_equal(whole.mean, film.mean)


def test_threads_that_come_and_go_share_their_room(monkeypatch):
    rooms = []
    monkeypatch.setattr(tiles, "_free", rooms)
    some = everything(ConstantEnvironment(1.0), vol=noise(), size=(40, 30))
    first = render(some, samples=2, threads=2).film
    kept = list(rooms)
    assert 1 <= len(kept) <= 2
    second = render(some, samples=2, threads=2).film
    assert len(rooms) <= 2 and all(any(room is old for room in rooms) for old in kept)
    np.testing.assert_array_equal(first.mean, second.mean)
