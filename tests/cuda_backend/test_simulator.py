"""The CUDA launcher in Numba's simulator: the very kernels, as Python, thread by thread."""

import numpy as np
import pytest
from needs import numba_cuda
from scenes import blob, everything, scene
from simulated import SEED, check_same, films_of, on_cpu

from vtkmcvr.lights import ConstantEnvironment, DirectionalLight, RectangleLight
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film

pytestmark = numba_cuda

SIZE = (8, 6)
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
    return films_of(SCENES, COUNTS, tmp_path_factory.mktemp("simulated"))


@pytest.mark.parametrize("name", SCENES)
def test_simulated_picture_is_that_of_the_cpu(films, name):
    cpu, simulated = films[name]
    assert (simulated.count == COUNTS).all()
    assert cpu.mean.max() > 0.05
    assert 0 < cpu.hits.sum() < COUNTS.sum()
    check_same(cpu, simulated)


def test_another_seed_would_be_noticed(films):
    name = "multiple scattering, albedo and normal"
    planned = plan(SCENES[name])
    film = on_cpu(planned.packed, empty_film(planned), COUNTS, SEED + 1)
    _, simulated = films[name]
    assert not np.allclose(film.mean, simulated.mean, rtol=1e-5, atol=1e-5)
