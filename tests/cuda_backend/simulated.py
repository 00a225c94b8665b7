"""Films of scenes by the CPU and by Numba's CUDA simulator."""

import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np

from vtkmcvr import schedule
from vtkmcvr.film.moments import copy_film
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film

PROGRAM = Path(__file__).parents[1] / "cuda_simulation.py"
SEED = 7


def films_of(scenes, counts, folder, devices=1, there=lambda packed: packed):
    """Films by name of a scene: (of the CPU, of the simulator).

    `there`: what is on the device of a packed scene.
    """
    plans = [plan(s) for s in scenes.values()]
    jobs = [
        (there(planned.packed), empty_film(planned), counts, SEED, devices) for planned in plans
    ]
    (folder / "jobs").write_bytes(pickle.dumps(jobs))
    subprocess.run(
        [sys.executable, PROGRAM, folder / "jobs", folder / "films"],
        env={**os.environ, "NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1",
             # Random numbers overflow on purpose
             "PYTHONWARNINGS": "ignore::RuntimeWarning"},
        check=True,
    )  # fmt: skip
    simulated = pickle.loads((folder / "films").read_bytes())
    return {
        name: (on_cpu(planned.packed, empty_film(planned), counts, SEED), film)
        for name, planned, film in zip(scenes, plans, simulated, strict=True)
    }


def on_cpu(packed, film, counts, seed):
    film = copy_film(film)
    rules = schedule.StopRules(int(counts.min()), None, None)
    schedule.run(packed, film, rules, seed, 1)
    schedule.fill_up(packed, film, counts, seed)
    return film


def check_same(cpu, simulated):
    """All planes of two films to 1e-5."""
    for field in cpu._fields:
        expected, found = getattr(cpu, field), getattr(simulated, field)
        if isinstance(expected, np.ndarray):
            least = 1e-5 * abs(expected).max()
            np.testing.assert_allclose(found, expected, rtol=1e-5, atol=least, err_msg=field)
