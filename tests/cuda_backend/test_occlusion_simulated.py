"""Directional occlusion by the CUDA launcher in Numba's simulator: the CPU's pictures."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import sweeps
from compiled import compiled
from needs import numba_cuda
from simulated import check_same

from vtkmcvr.kernels.cone_rays import window_mean
from vtkmcvr.occlusion.carry_out import sweep
from vtkmcvr.occlusion.single import BLUR

pytestmark = numba_cuda


BLURS = Path(__file__).parents[1] / "cuda_blurs.py"
OPAQUE = "a wall that fills the picture"


def compared(cases, folder):
    """(of the CPU, of the simulator) by name."""
    jobs = [sweeps.parts(*case) for case in cases.values()]
    found = sweeps.simulated(jobs, folder)
    return {
        name: (sweep("cpu", job, 1), done)
        for name, job, done in zip(cases, jobs, found, strict=True)
    }


@pytest.fixture(scope="module")
def modes(tmp_path_factory):
    return compared({**sweeps.MODES, OPAQUE: sweeps.WALL}, tmp_path_factory.mktemp("modes"))


@pytest.fixture(scope="module")
def more(tmp_path_factory):
    return compared(sweeps.MORE, tmp_path_factory.mktemp("more"))


def check(cpu, cuda, volumes=1):
    assert (cuda.backend, cuda.ended, cuda.note) == ("cuda", True, "")
    assert cpu.film.radiance.max() > 0.01
    assert all(np.isfinite(plane).all() for plane in cuda.film if plane is not None)
    check_same(cpu.film, cuda.film)
    assert (cuda.work.naive, cuda.work.seen) == (cpu.work.naive, cpu.work.seen)
    # Nothing behind the last view ray
    assert 0 < cuda.work.looked_up <= cpu.work.looked_up <= cuda.work.naive * volumes


@pytest.mark.parametrize("name", sweeps.MODES)
def test_modes_give_the_pictures_of_the_cpu(modes, name):
    check(*modes[name])


@pytest.mark.slow
@pytest.mark.parametrize("name", sweeps.MORE)
def test_effects_and_hard_cases_give_the_pictures_of_the_cpu(more, name):
    check(*more[name], volumes=1 + len(sweeps.MORE[name][0].layers))


def test_scenes_reach_all_that_is_to_be_compared():
    default, _, _ = (sweeps.parts(*case) for case in sweeps.MODES.values())
    far = sweeps.parts(*sweeps.MORE["far away, shaded, albedo and normal, clipped"])
    assert default.light.tiers and default.raster.columns > 16 and default.raster.rows > 8
    assert far.raster.perspective.span > 16
    assert sweeps.parts(*sweeps.MORE["HC-09 extinction of 1e12"]).filling.limited
    fast = sweeps.parts(*sweeps.MODES["fast"])
    assert sum(fast.light.variance_at(k) for k in range(fast.raster.count)) > 2 * BLUR


def test_nothing_is_looked_up_behind_the_last_view_ray(modes):
    cpu, opaque = modes[OPAQUE]
    check(cpu, opaque)
    assert opaque.film.alpha.min() > 0.99
    # One block of eight of the 33 layers
    assert 33 * opaque.work.looked_up == 8 * opaque.work.naive


def test_another_cone_would_be_noticed(modes):
    described, settings = sweeps.MODES["fast"]
    other = sweep("cpu", sweeps.parts(described, replace(settings, half_angle=58)), 1)
    _, found = modes["fast"]
    assert not np.allclose(other.film.radiance, found.film.radiance, rtol=1e-5, atol=1e-5)


def test_windows_have_the_same_means_by_shared_memory_and_beyond_it(tmp_path):
    # Tiles are cut off below; the last two windows reach further than shared memory has room for
    buffer = np.random.default_rng(7).random((2, 13, 48), np.float32)
    widths = 1.0, 1.7, 9.3, 64.9, 65.0, 90.5
    found = sweeps.simulated((buffer, widths), tmp_path, BLURS)
    mean = compiled(window_mean)
    for (width, (down, across)), blurred in zip(
        product(widths, ((0, 1), (1, 0))), found, strict=True
    ):
        for c, row, column in np.ndindex(buffer.shape):
            expected = mean(buffer[c], row, column, down, across, np.float32(width))
            assert abs(blurred[c, row, column] - expected) < 2e-6
