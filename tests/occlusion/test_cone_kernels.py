"""Small parts of the occlusion kernels against NumPy."""

import math

import numpy as np
import pytest
from compiled import compiled

from vtkmcvr import packed
from vtkmcvr.kernels.cone_beams import mean_transmitted, opacity, transmitted
from vtkmcvr.kernels.cone_blur import blur_columns, blur_rows
from vtkmcvr.kernels.cone_buffer import held, held_throughout, ring_row
from vtkmcvr.kernels.cone_trace import rows_of_band
from vtkmcvr.kernels.cone_transfer import mean_albedo, mean_extinction
from vtkmcvr.occlusion.medium import integrals_of

f32 = np.float32


def test_transmittance_without_branches():
    # The Taylor polynomial of degree 3 at x/64, to the power 64, and 70 float32 roundings
    depth = np.concatenate([[0.0], np.geomspace(1e-8, 1e4, 400)]).astype(f32)
    call = compiled(transmitted)
    T = np.array([call(x) for x in depth])
    assert np.abs(T - np.exp(-depth.astype(np.float64))).max() < 1e-5
    assert T[0] == 1 and T[-1] < 1e-20


def test_opacity_of_faint_and_of_dense_layers():
    # Six squarings of e^-(depth / 64), each of which keeps a relative error and adds 2 roundings
    depth = np.concatenate([[0.0], np.geomspace(1e-12, 1e4, 400)]).astype(f32)
    call = compiled(opacity)
    found = np.array([call(x) for x in depth])
    exact = -np.expm1(-depth.astype(np.float64))
    assert found[0] == 0
    assert np.abs(found[1:] / exact[1:] - 1).max() < 1.5e-6
    assert found.max() <= 1


def test_mean_transmittance_of_a_layer():
    x = np.concatenate([[0.0], np.geomspace(1e-7, 1e4, 400)]).astype(f32)
    call = compiled(mean_transmitted)
    mean = np.array([call(v) for v in x])
    y = np.maximum(x.astype(np.float64), 1e-12)
    assert np.abs(mean * y / -np.expm1(-y) - 1).max() < 1e-3


@pytest.fixture
def integrals():
    rng = np.random.default_rng(4)
    n = 64
    sigma_t = rng.random(n).astype(f32)
    sigma_t[:9] = 0
    none = (None,) * 7
    colour = rng.random((n, 3)).astype(f32)
    return integrals_of(
        packed.Transfer(
            sigma_t, colour, f32(-2), f32(10), *none, np.int32(0), np.int32(len(sigma_t))
        )
    )


def mean(integrals, x, y):
    """Mean extinction between two table positions."""
    i = integrals
    return compiled(mean_extinction)(i.sigma_t, i.depth, np.int32(0), i.last, f32(x), f32(y))


def test_no_extinction_is_known_up_to_its_first_entry(integrals):
    assert integrals.clear == 8


@pytest.mark.parametrize(("x", "y"), [(3.0, 40.2), (40.2, 3.0), (12.3, 12.9), (20.0, 20.01)])
def test_mean_extinction_is_that_of_many_points(integrals, x, y):
    along = np.linspace(x, y, 20001)
    expected = np.interp(along, np.arange(64), integrals.sigma_t).mean()
    found = mean(integrals, x, y)
    assert found == pytest.approx(expected, rel=1e-3)


def test_half_of_a_stretch_without_data_is_empty(integrals):
    found = mean(integrals, -1, 20)
    assert found == pytest.approx(integrals.sigma_t[20] / 2)


def test_albedo_is_weighted_by_extinction(integrals):
    along = np.linspace(10, 30, 20001)
    entries = np.arange(64)
    sigma_t = np.interp(along, entries, integrals.sigma_t)
    found = compiled(mean_albedo)(integrals, np.int32(0), f32(10), f32(30))
    for c in range(3):
        # Products of linear pieces are integrated by trapezia
        lit = np.interp(along, entries, integrals.sigma_t * integrals.colour[:, c])
        assert found[c] == pytest.approx(lit.mean() / sigma_t.mean(), rel=0.05)


def test_a_moved_buffer_keeps_its_rays():
    rng, move, kept = np.random.default_rng(0), compiled(held), compiled(ring_row)
    rows, columns, room = 5, 7, 6
    buffer = np.zeros((rows + 2, columns + room), f32)
    origin = np.array([0, -3, 0])
    rays, held_before = {}, set()
    y = x = 0
    for _ in range(400):
        move(buffer, origin, y, x, rows, columns)
        there = {(j, i) for j in range(-y, rows - y) for i in range(-x, columns - x)}
        for j, i in sorted(there):
            place = kept(buffer, origin, j), i - origin[1]
            # Rays that were beyond the film come back clear or as they were
            assert buffer[place] == rays.get((j, i), 0) or (
                buffer[place] == 0 and (j, i) not in held_before
            )
            rays[j, i] = buffer[place] = rng.random(dtype=f32)
        held_before = there
        y, x = y + rng.integers(-2, 3), x + rng.integers(-4, 5)


def test_a_ray_that_stays_on_the_film_is_never_lost():
    buffer, origin = np.zeros((14, 20), f32), np.array([0, -5, 0])
    move, kept = compiled(held), compiled(ring_row)
    move(buffer, origin, 0, 0, 10, 10)
    buffer[kept(buffer, origin, 4), 4 - origin[1]] = 1
    for shift in range(5):
        move(buffer, origin, shift, -shift, 10, 10)
        assert buffer[kept(buffer, origin, 4), 4 - origin[1]] == 1
        assert buffer.sum() == 1


def test_far_moves_clear_the_whole_ring():
    buffer, origin = np.ones((14, 20), f32), np.array([0, -5, 0])
    compiled(held)(buffer, origin, -40, 0, 10, 10)
    assert not buffer.any()
    assert origin[0] + 14 == 40 + 10


def test_bands_hold_every_row_once():
    part = compiled(rows_of_band)
    for rows, bands in ((5, 1), (37, 4), (64, 3)):
        for moved in (-100, -9, 0, 1, 12, 100):
            parts = [part(band, bands, rows, moved) for band in range(bands)]
            assert [row for a, b in parts for row in range(a, b)] == list(range(rows))
            # The same rays: rows that moved as they did
            inner = [a - moved for a, _ in parts[1:] if 0 < a < rows]
            assert set(inner) <= {rows * band // bands for band in range(bands)}


def test_room_for_all_places_of_a_block():
    move = compiled(held_throughout)
    buffer, origin = np.zeros((30, 30), f32), np.array([-10, -10, 0])
    places = np.array([(0, 0), (4, -3), (9, -6)])
    assert move(buffer, origin, places, 10, 10)
    for y, x in places:
        assert 0 <= -y - origin[0] <= 20
        assert 0 <= -x - origin[1] <= 20
    assert not move(buffer, origin, np.array([(0, 0), (21, 0)]), 10, 10)


@pytest.mark.parametrize("width", [1.0, 1.7, 3.0, 8.4, 60.0])
@pytest.mark.parametrize("axis", [0, 1])
def test_running_blur_is_the_direct_sum(width, axis):
    a = np.random.default_rng(1).random((23, 31)).astype(f32)
    out, whole = np.empty_like(a), (0, 23, 0, 31)
    if axis:
        part = compiled(blur_rows)(a, out, f32(width), whole)
    else:
        part = compiled(blur_columns)(a, out, np.zeros((2, 31), f32), f32(width), whole)
    assert part == whole
    reach = int((width - 1) / 2)
    rest = (width - 1) / 2 - reach
    kernel = np.array([rest, *[1.0] * (2 * reach + 1), rest]) / width
    padded = np.pad(a.astype(np.float64), [(reach + 1, reach + 1) if k == axis else (0, 0)
                                           for k in (0, 1)])  # fmt: skip
    expected = np.apply_along_axis(lambda v: np.convolve(v, kernel, "valid"), axis, padded)
    assert np.abs(out - expected).max() < 2e-6


@pytest.mark.parametrize("width", [1.7, 5.3, 40.0])
def test_a_blur_of_a_part_is_that_of_the_whole(width):
    a = np.zeros((37, 45), f32)
    a[12:19, 3:21] = np.random.default_rng(2).random((7, 18))
    found = []
    for part in ((12, 19, 3, 21), (0, 37, 0, 45)):
        across, out = np.zeros_like(a), np.zeros_like(a)
        reached = compiled(blur_rows)(a, across, f32(width), part)
        reached = compiled(blur_columns)(across, out, np.zeros((2, 45), f32), f32(width), reached)
        found.append(out)
        beyond = np.ones(a.shape, bool)
        beyond[reached[0] : reached[1], reached[2] : reached[3]] = False
        assert not out[beyond].any()
    assert np.abs(found[0] - found[1]).max() < 2e-6


def test_the_blurs_variance_is_the_windows():
    a, out = np.zeros((1, 101), f32), np.zeros((1, 101), f32)
    a[0, 50] = 1
    blur = compiled(blur_rows)
    for width in (2.5, 9.0, 13.2):
        blur(a, out, f32(width), (0, 1, 50, 51))
        variance = (out[0] * (np.arange(101) - 50) ** 2).sum()
        assert out.sum() == pytest.approx(1, abs=1e-5)
        # Between whole widths the end pixels are thicker than a box's: at most 1/6 pixel^2
        assert abs(variance - (width * width - 1) / 12) < 1 / 6 + math.ulp(1)
