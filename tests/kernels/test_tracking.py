"""Delta and ratio tracking against quadrature, in media that are hard on both.

z-scores are compared with 4.8: chance exceeds it in less than 100 x 1.6e-6 of all choices of seeds.
"""

import math

import numpy as np
import pytest
from compiled import compiled
from scenes import WHITE, mean_and_error, medium, noise, render, scene, slab, volume, z_score
from scipy import stats
from scipy.ndimage import map_coordinates

from vtkmcvr import packed
from vtkmcvr.curves import Curve
from vtkmcvr.kernels.grid import box_interval
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.rng import start
from vtkmcvr.kernels.tracking import sample_collision, transmittance
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.scene import TransferFunction

f32, f64 = np.float32, np.float64
N = 100_000
FAR = packed.Shadows(f32(1e30))
RATIO = packed.RatioTracking(f32(0.05))


@entry_point
def draw_transmittance(medium, transfer, shadows, ratio, o, d, length, n):
    out = np.empty(n, np.float32)
    for i in range(n):
        out[i], _ = transmittance(
            shadows, None, medium, transfer, ratio, o, d, length, start(3, i, 0)
        )
    return out


@entry_point
def draw_collision(medium, transfer, o, d, length, n):
    out = np.empty((n, 2), np.float32)
    for i in range(n):
        out[i, 0], out[i, 1], _, _ = sample_collision(
            None, medium, transfer, o, d, length, start(4, i, 0)
        )
    return out


SPIKY = Curve([(0, 0), (0.4, 0), (0.41, 4), (0.42, 0), (0.7, 0.5), (0.8, 0.05), (1, 0.8)])


def big(seed=1, n=21):
    """3 x 3 x 3 macrocells of noise, some of them empty."""
    values = np.random.default_rng(seed).random((n, n, n), np.float32)
    values[:8, :, :] *= 0.3
    return values


def rays():
    """Index-space rays: inside, through the whole grid, along an axis, along a face and an edge."""
    rng = np.random.default_rng(5)
    for _ in range(4):
        a, b = rng.random((2, 3)) * 20
        yield a, b
    yield (0, 0, 0), (20, 20, 20)
    yield (20, 13.2, 0.5), (0, 13.2, 0.5)
    yield (0, 0, 0), (0, 0, 20)
    yield (20, 3, 20), (20, 17, 20)
    yield (6, 6, 1), (6, 6, 19)
    yield (18, 3, 18), (0, 19, 0)


def optical_depth(values, a, b, curve, length):
    """Midpoint rule in float64, with SciPy's interpolation and the curve itself."""
    t = (np.arange(200_000) + 0.5) / 200_000
    p = np.asarray(a, f64)[:, None] * (1 - t) + np.asarray(b, f64)[:, None] * t
    scalar = map_coordinates(values.astype(f64), p[::-1], order=1, mode="nearest")
    return curve(scalar).mean() * length


def check_transmittance(values, curve, ratio, pairs):
    parts = plan(scene(volume(values), TransferFunction(None, WHITE, extinction=curve))).packed
    seen = []
    for a, b in pairs:
        step = np.subtract(b, a, dtype=f64)
        length = np.linalg.norm(step)
        T = draw_transmittance(
            parts.medium, parts.transfer, FAR, ratio,
            tuple(map(f32, a)), tuple(map(f32, step / length)), f32(length), N,
        ).astype(f64)  # fmt: skip
        expected = math.exp(-optical_depth(values, a, b, curve, length))
        # Of this run, or the binomial one where hardly a ray came through
        deviation = T.std() if ratio else max(T.std(), math.sqrt(expected * (1 - expected)))
        # 1e-3: nodes 0.01 apart lie between table entries; 1e-5: float32
        bound = 4.8 * deviation / math.sqrt(N) + 1e-3 * expected + 1e-5
        assert abs(T.mean() - expected) < bound, (a, b)
        assert ratio is not None or set(np.unique(T)) <= {0.0, 1.0}
        seen.append(expected)
    return np.array(seen)


@pytest.mark.parametrize("ratio", [None, RATIO], ids=["delta", "ratio"])
@pytest.mark.parametrize("curve", [Curve([(0, 0.05), (1, 0.3)]), SPIKY], ids=["smooth", "spiky"])
def test_transmittance_is_that_of_quadrature(ratio, curve):
    check_transmittance(big(), curve, ratio, rays())


@pytest.mark.parametrize("ratio", [None, RATIO], ids=["delta", "ratio"])
def test_rays_leap_over_empty_space_and_miss_nothing(ratio):
    # Single voxels and a thin wall in 41^3 of nothing, met from all sides
    rng = np.random.default_rng(9)
    values = (rng.random((41, 41, 41)) < 0.004).astype(np.float32)
    values[:, 25, 5:] = 0.4
    ends = np.concatenate([rng.random((12, 2, 3)) * 40, rng.integers(0, 2, (8, 2, 3)) * 40.0])
    ends[12:, 0] = 20.3
    ends[5:9, 1, 0] = ends[5:9, 0, 0]
    ends[7:9, 1, 2] = ends[7:9, 0, 2]
    # A ray through a voxel on purpose, along an axis
    k, j, i = np.argwhere(values == 1)[0]
    through = [((i, j, 0), (i, j, 40)), ((40, j, k), (0, j, k)), ((i, 40, k), (i, 0, k))]
    seen = check_transmittance(values, Curve([(0, 0), (1, 2.0)]), ratio, [*ends, *through])
    assert np.count_nonzero((seen > 0.01) & (seen < 0.99)) >= 8


def test_ratio_tracking_has_the_smaller_variance():
    parts = plan(scene(volume(big()), medium(0.3))).packed
    o, d = (f32(0), f32(3), f32(3)), (f32(1), f32(0), f32(0))
    delta, ratio = (
        draw_transmittance(parts.medium, parts.transfer, FAR, r, o, d, f32(20), N).std()
        for r in (None, RATIO)
    )
    assert ratio < 0.85 * delta


def test_shadows_off_or_of_no_reach_cost_no_walk():
    parts = plan(scene(volume(big()), medium(9.0))).packed
    o, d = (f32(1), f32(3), f32(3)), (f32(1), f32(0), f32(0))
    off = draw_transmittance(parts.medium, parts.transfer, None, None, o, d, f32(20), 10)
    none = draw_transmittance(
        parts.medium, parts.transfer, packed.Shadows(f32(0)), None, o, d, f32(20), 10
    )
    assert (off == 1).all()
    assert (none == 1).all()


@pytest.mark.parametrize("d", [(1, 0, 0), (0, -1, 0), (0.6, 0, 0.8), (0.48, -0.6, 0.64)])
@pytest.mark.parametrize("sigma", [0.1, 2.0])
def test_collision_distances_are_exponential(sigma, d):
    # 33 points: 4 macrocells an axis
    parts = plan(scene(slab((32, 32, 32), 33), medium(sigma))).packed
    o = (f32(0.5), f32(31), f32(1.5))
    length = 25.0
    t = draw_collision(
        parts.medium, parts.transfer, o, tuple(map(f32, d)), f32(length), N
    )[:, 0].astype(f64)  # fmt: skip
    escaped = t < 0
    p = math.exp(-sigma * length)
    assert abs(escaped.sum() - N * p) < 4.8 * math.sqrt(N * p) + 1
    hit = t[~escaped]
    assert hit.max() <= length
    cdf = lambda x: np.expm1(-sigma * x) / math.expm1(-sigma * length)  # noqa: E731
    # 1e-5: Bonferroni over the tests of this file
    assert stats.kstest(hit, cdf).pvalue > 1e-5


def test_collisions_in_a_spiky_medium_follow_sigma_times_transmittance():
    values = big(2)
    parts = plan(scene(volume(values), TransferFunction(None, WHITE, extinction=SPIKY))).packed
    a, b = np.array((0.3, 2.0, 0.7)), np.array((19.0, 15.0, 19.5))
    step = b - a
    length = np.linalg.norm(step)
    out = draw_collision(
        parts.medium, parts.transfer, tuple(map(f32, a)), tuple(map(f32, step / length)),
        f32(length), N,
    ).astype(f64)  # fmt: skip
    t, scalar = out[out[:, 0] >= 0].T
    s = (np.arange(200_000) + 0.5) / 200_000
    p = a[:, None] * (1 - s) + b[:, None] * s
    sigma = SPIKY(map_coordinates(values.astype(f64), p[::-1], order=1, mode="nearest"))
    cdf = -np.expm1(-np.cumsum(sigma) * length / len(s))
    assert abs(len(t) - N * cdf[-1]) < 4.8 * math.sqrt(N * cdf[-1] * (1 - cdf[-1])) + 1e-3 * N
    # A table entry is 6e-5 wide, against spikes of 0.01: a bias of 1e-3 at most beside the noise
    distance = stats.kstest(t, lambda x: np.interp(x, s * length, cdf / cdf[-1])).statistic
    assert distance < 2.4 / math.sqrt(len(t)) + 1e-3  # 2 exp(-2 2.4^2) = 2e-5
    # The scalar that comes back is the one at the collision
    q = a[:, None] + np.outer(step / length, t)
    np.testing.assert_allclose(
        scalar, map_coordinates(values.astype(f64), q[::-1], order=1, mode="nearest"), atol=1e-4
    )


def test_pictures_by_delta_and_ratio_tracking_agree():
    lit = {"lights": (ConstantEnvironment(1.0),)}
    delta, ratio = (
        render(scene(noise(), medium(3.0), ratio_tracking=r, **lit), samples=256, seed=s)
        for s, r in enumerate((False, True))
    )
    assert abs(z_score(delta, ratio)) < 4.8
    assert mean_and_error(ratio)[1] < mean_and_error(delta)[1]


def test_walk_ends_where_extinction_is_extreme():
    # HC-09: opacity 1 times a density of 1e6 is cut off, and said so
    opaque = TransferFunction(Curve([(0, 0), (0.2, 1)]), WHITE, density_scale=1e6)
    planned = plan(scene(volume(big()), opaque))
    assert any("cut off" in note for note in planned.notes)
    parts = planned.packed
    t = draw_collision(
        parts.medium, parts.transfer, (f32(0), f32(3.3), f32(12.2)), (f32(1), f32(0), f32(0)),
        f32(20), 1000,
    )[:, 0]  # fmt: skip
    assert (t >= 0).all()
    assert t.max() < 4


# Boxes


def test_rays_along_faces_edges_and_through_corners_of_a_box():
    # HC-07: zero components of the direction, origins on faces
    interval = compiled(box_interval)
    lo, hi = (0.0, 0.0, 0.0), (2.0, 3.0, 4.0)
    cases = [
        ((-1, 1, 1), (1, 0, 0), (1, 3)),  # straight through
        ((-1, 0, 1), (1, 0, 0), (1, 3)),  # in a face
        ((-1, 3, 1), (1, -0.0, 0), (1, 3)),  # in the opposite face, negative zero
        ((-1, 0, 4), (1, 0, 0), (1, 3)),  # along an edge
        ((0, 0, 0), (1, 0, 0), (0, 2)),  # from a corner
        ((1, 1, 1), (0, 0, -1), (-3, 1)),  # from inside
        ((2, 1, 1), (1, 0, 0), (-2, 0)),  # outwards from a face
        ((-1, -1, -1), (1, 1, 1), (1, 3)),  # through a corner
    ]
    for o, d, (enter, leave) in cases:
        t = interval(tuple(map(float, o)), tuple(map(float, d)), lo, hi)
        assert t == pytest.approx((enter, leave), abs=1e-6), (o, d)
    for o, d in [((-1, 3.1, 1), (1, 0, 0)), ((-1, 1, -0.1), (1, 0, 0)), ((5, 5, 5), (0, 0, 1))]:
        enter, leave = interval(tuple(map(float, o)), tuple(map(float, d)), lo, hi)
        assert not leave > enter


@pytest.mark.parametrize("start_at", [(0, 0, 0), (0, 6, 0), (18, 18, 0), (18, 9, 0), (6, 6, 0)])
def test_homogeneous_medium_along_faces_and_edges(start_at):
    # Along z on faces, edges and macrocell borders of a 19-point grid: Beer-Lambert like anywhere
    # else
    parts = plan(scene(slab((18, 18, 18), 19), medium(0.1))).packed
    t = draw_collision(
        parts.medium,
        parts.transfer,
        tuple(map(f32, start_at)),
        (f32(0), f32(0), f32(1)),
        f32(18),
        N,
    )[:, 0]
    p = math.exp(-1.8)
    assert abs((t < 0).sum() - N * p) < 4.8 * math.sqrt(N * p * (1 - p))
