"""Rays that hurt: along faces, edges and corners, with zeros of either sign, from cell borders.

Every ray must come back: a walk that does not advance ends the run by the watchdog. And it must say
something true: a collision inside its interval, a transmittance from 0 to 1.
"""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scenes import WHITE, scene, slab, volume
from techniques import SKY

from vtkmcvr import packed
from vtkmcvr.curves import Curve
from vtkmcvr.kernels.event import ray_interval
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.rng import start, uniform
from vtkmcvr.kernels.tracking import sample_collision, transmittance
from vtkmcvr.kernels.vec import at, narrow
from vtkmcvr.plan import plan
from vtkmcvr.scene import TransferFunction

f32 = np.float32
FAR = packed.Shadows(f32(1e30))
RATIO = packed.RatioTracking(f32(0.3))
# What can be wrong with a ray
BAD = ("collision outside of its interval", "not finite", "majorant violated", "transmittance")


@entry_point
def tortured(medium, transfer, shadows, ratio, seed, n):  # noqa: C901 - one loop for Numba
    """Walk n random rays; count collisions and what is wrong.

    Each component of origin and direction is, by chance, anything, a whole number (a voxel's plane,
    and often a cell's), 0, -0, or so small that it hardly moves.
    """
    nz, ny, nx = medium.values.shape
    counts = np.zeros(5, np.int64)
    size = (np.float64(nx - 1), np.float64(ny - 1), np.float64(nz - 1))
    o, d = np.zeros(3), np.zeros(3)
    for i in range(n):
        rng = start(seed, i, 0)
        for axis in range(3):
            rng, u = uniform(rng)
            rng, v = uniform(rng)
            o[axis] = (v * 3.0 - 1.0) * size[axis]
            if u < 0.4:
                o[axis] = math.floor(v * (size[axis] + 1.0))
            elif u < 0.5:
                o[axis] = 0.0 if v < 0.5 else size[axis]
            rng, u = uniform(rng)
            rng, v = uniform(rng)
            d[axis] = 2.0 * v - 1.0
            if u < 0.3:
                d[axis] = 0.0 if v < 0.5 else -0.0
            elif u < 0.5:
                d[axis] = 1.0 if v < 0.5 else -1.0
            elif u < 0.6:
                d[axis] *= 1e-12
        most = max(abs(d[0]), max(abs(d[1]), abs(d[2])))
        if most == 0.0:
            d[0], most = 1.0, 1.0
        # In world units a direction has length 1, whatever its smallest components are
        for axis in range(3):
            d[axis] /= most
        origin, heading = (o[0], o[1], o[2]), (d[0], d[1], d[2])
        enter, leave = ray_interval(medium, origin, heading)
        enter = max(enter, 0.0)
        length = np.float32(min(leave, 1e30) - enter)
        if length > np.float32(0.0):
            p = narrow(at(origin, heading, enter))
            step = narrow(heading)
            t, _, sigma_t, rng = sample_collision(None, medium, transfer, p, step, length, rng)
            counts[4] += t >= np.float32(0.0)
            counts[0] += t > length
            counts[1] += math.isnan(t)
            counts[2] += sigma_t == np.float32(math.inf)
            T, rng = transmittance(shadows, None, medium, transfer, ratio, p, step, length, rng)
            counts[2] += T == np.float32(-math.inf)
            counts[3] += not (np.float32(0.0) <= T <= np.float32(1.0))
    return counts


def random_medium(seed):
    """Volume and transfer function of any density, emptiness and shape."""
    rng = np.random.default_rng(seed)
    shape = rng.integers(2, [4, 40, 40][seed % 3], 3)
    values = rng.random(shape).astype(f32)
    values[rng.random(shape) < [0.0, 0.9, 0.999][seed // 3 % 3]] = 0
    x = np.sort(rng.random(5))
    heights = 10.0 ** rng.uniform(-3, 1.5, 5) * (rng.random(5) < 0.7)
    curve = Curve([(0, 0), *zip(x, heights, strict=True)])
    vol = volume(values, tuple(10.0 ** rng.uniform(-1, 1, 3)))
    lit = scene(vol, TransferFunction(None, WHITE, extinction=curve), lights=SKY)
    return plan(lit).packed


def torture(rays, volumes):
    """Counts over random media, on two threads."""
    each = rays // volumes

    def one(seed):
        parts = random_medium(seed)
        by_ratio = RATIO if seed % 4 else None
        return tortured(parts.medium, parts.transfer, FAR, by_ratio, seed, each)

    tortured(*_first(RATIO))
    tortured(*_first(None))
    with ThreadPoolExecutor(2) as pool:
        return sum(pool.map(one, range(volumes)))


def _first(ratio):
    parts = random_medium(0)
    return parts.medium, parts.transfer, FAR, ratio, 0, 0


def check(record, counts, rays):
    for what, count in zip(BAD, counts, strict=False):
        record("rays", f"{what}, of {rays:.0e} rays", "monte-carlo", 0, count, 0)
    assert 0.01 * rays < counts[4] < rays


def test_random_rays_come_back(record, watchdog):
    check(record, torture(1_000_000, 36), 1_000_000)


@pytest.mark.slow
def test_a_hundred_million_random_rays_come_back(record, watchdog):
    check(record, torture(100_000_000, 360), 100_000_000)


@entry_point
def share_of_collisions(medium, transfer, o, d, length, n):
    count = 0
    for i in range(n):
        t, _, _, _ = sample_collision(None, medium, transfer, o, d, length, start(4, i, 0))
        count += t >= np.float32(0.0)
    return count


AXES = [(1, 0.0, 0.0), (-1, -0.0, 0.0), (0.0, 1, -0.0), (-0.0, -1, -0.0), (0, 0, 1), (0, -0.0, -1)]
DIAGONALS = [(1, 1, 0.0), (-1, 1, -0.0), (1, 1, 1), (-1, -1, -1)]


@pytest.mark.parametrize("d", AXES + DIAGONALS)
@pytest.mark.parametrize("at", [0.0, 3.0, 6.0, 9.0, 18.0])
def test_rays_on_faces_edges_and_corners_of_cells(record, d, at):
    # A 19-point grid has cells of 3; all starts are on their borders. Beer-Lambert to the far side
    even = TransferFunction(None, WHITE, extinction=Curve([(0, 0.1)]))
    parts = plan(scene(slab((18, 18, 18), 19), even)).packed
    o = np.array([9.0 if x == 0 and at == 9 else at for x in d])
    inside = [(18 - c if x > 0 else c) / abs(x) for c, x in zip(o, d, strict=True) if x]
    length = min(inside)
    n = 20_000
    hits = share_of_collisions(
        parts.medium, parts.transfer, tuple(map(f32, o)), tuple(map(f32, d)), f32(length), n
    )
    p = -math.expm1(-0.1 * length)
    # 4.5 binomial standard errors: 50 x 6.8e-6
    assert abs(hits - n * p) <= 4.5 * math.sqrt(n * p * (1 - p)) + 1e-9


def test_t_that_no_longer_advances_in_float32(record, watchdog):
    # Voxels of 1e-7 beside ones of 1: the ulp of t is larger than a free path at the bound of 64
    # optical depths a voxel; limited by the diagonal, walks take the expected time
    values = np.zeros((12, 12, 12), f32)
    values[::2] = 1
    vol = volume(values, (1.0, 1.0, 1e-7))
    opaque = TransferFunction(Curve([(0.5, 0), (0.5, 1)]), WHITE, unit_distance=1e-7)
    parts = plan(scene(vol, opaque)).packed
    # Along x in an empty plane, between two opaque ones: cells hold both
    hits = share_of_collisions(
        parts.medium, parts.transfer, (f32(0), f32(5.5), f32(5)), (f32(1), f32(0), f32(0)),
        f32(11), 20,
    )  # fmt: skip
    record("rays", "collisions in an empty plane between opaque ones", "monte-carlo", 0, hits, 0)
