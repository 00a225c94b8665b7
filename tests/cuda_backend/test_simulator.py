"""The CUDA launcher in Numba's simulator: the very kernels, as Python, thread by thread."""

import os
import pickle
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from scenes import blob, everything, scene

from vtkmcvr import schedule
from vtkmcvr.film import copy_film
from vtkmcvr.lights import ConstantEnvironment, DirectionalLight, RectangleLight
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film

pytestmark = pytest.mark.skipif(
    find_spec("numba_cuda") is None, reason="numba-cuda is not installed (extra cuda)"
)

TESTS = Path(__file__).parents[1]
SIZE, SEED = (8, 6), 7
SKY = (ConstantEnvironment(0.5),)
SCENES = {
    "single scattering, hybrid, all kinds of light": everything(
        DirectionalLight((1, 2, -1.5), 2.0), RectangleLight((2, -2, 2), (0, 0, 0), (1, 1), 3.0),
        vol=blob(9), size=SIZE,
    ),
    "multiple scattering, albedo and normal": scene(
        blob(9), lights=SKY, aovs=("albedo", "normal"), scattering="multiple", size=SIZE
    ),
}  # fmt: skip
# Two samples of each pixel, and one more of some, as in a picture that was cut off
COUNTS = np.full(SIZE[::-1], 2, np.int64)
COUNTS[1, 3:] = 3


@pytest.fixture(scope="module")
def films(tmp_path_factory):
    """Films by name: (of the CPU, of the simulator)."""
    jobs = [(plan(s).packed, empty_film(plan(s)), COUNTS, SEED) for s in SCENES.values()]
    folder = tmp_path_factory.mktemp("simulated")
    (folder / "jobs").write_bytes(pickle.dumps(jobs))
    subprocess.run(
        [sys.executable, TESTS / "cuda_simulation.py", folder / "jobs", folder / "films"],
        env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1",
             # Random numbers overflow on purpose
             "PYTHONWARNINGS": "ignore::RuntimeWarning"},
        check=True,
    )  # fmt: skip
    simulated = pickle.loads((folder / "films").read_bytes())
    return {
        name: (on_cpu(*job), film)
        for name, job, film in zip(SCENES, jobs, simulated, strict=True)
    }


def on_cpu(packed, film, counts, seed):
    film = copy_film(film)
    rules = schedule.StopRules(int(counts.min()), None, None)
    schedule.run(packed, film, rules, seed, 1)
    schedule.fill_up(packed, film, counts, seed)
    return film


@pytest.mark.parametrize("name", SCENES)
def test_simulated_picture_is_that_of_the_cpu(films, name):
    cpu, simulated = films[name]
    assert (simulated.count == COUNTS).all()
    assert cpu.mean.max() > 0.05
    assert 0 < cpu.hits.sum() < COUNTS.sum()
    for field in cpu._fields:
        expected, found = getattr(cpu, field), getattr(simulated, field)
        if isinstance(expected, np.ndarray):
            least = 1e-5 * abs(expected).max()
            np.testing.assert_allclose(found, expected, rtol=1e-5, atol=least, err_msg=field)


def test_another_seed_would_be_noticed(films):
    name = "multiple scattering, albedo and normal"
    planned = plan(SCENES[name])
    film = on_cpu(planned.packed, empty_film(planned), COUNTS, SEED + 1)
    _, simulated = films[name]
    assert not np.allclose(film.mean, simulated.mean, rtol=1e-5, atol=1e-5)
