"""Kernels as plain Python, with the warnings of NumPy's scalars as errors.

Runs with NUMBA_DISABLE_JIT=1 (`make sanitize`), where every index is checked and every operation on
a number tells what it did: a division by zero, an invalid operation or an overflow that nobody
meant fails the test. Random numbers overflow on purpose.
"""

import os
import sys
from dataclasses import replace

import numpy as np
import pytest
from scenes import blob, everything, frontal, medium, noise, scene
from techniques import SKY

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.kernels.cpu import render_tile
from vtkmcvr.lights import DirectionalLight, PointLight, RectangleLight, SphereLight
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.plan import plan
from vtkmcvr.rendering import empty_film
from vtkmcvr.scene import Camera, Lens, Schlick, Surface, TransferFunction, Volume

pytestmark = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") != "1", reason="for NUMBA_DISABLE_JIT=1: make sanitize"
)
WRAPS = ("rng.py", "sobol.py")
COAT = Surface(0.9, specular=0.3, exponent=20)
GLOWING = TransferFunction(
    None, ColourCurve([(0, 0.5, 0.5, 0.5)]), extinction=Curve([(0, 0), (1, 3)]),
    emission=ColourCurve([(0, 1, 1, 1)]),
)  # fmt: skip
HOLED = blob(9).values.copy()
HOLED[4, 4, 4] = np.nan
SCENES = {
    "everything": everything(DirectionalLight((1, 2, -1.5), 2.0), vol=blob(9), surface=COAT),
    "multiple": everything(
        PointLight((-1, -2, 1), 8.0), vol=blob(9), surface=COAT, scattering="multiple",
        max_scatterings=20,
    ),
    "area lights": scene(
        blob(9), medium(9.0), phase=Schlick(-0.5),
        lights=(
            RectangleLight((2, -2, 2), (0, 0, 0), (1, 1), 9.0),
            SphereLight((0, -1, 2), 0.3, 9.0),
        ),
    ),
    "lens": scene(
        blob(9), lights=SKY, aovs=("albedo", "normal"),
        camera=Camera((0, -5, 0), (0, 0, 0), view_angle=20, lens=Lens(0.1)),
    ),
    "emission, missing data": scene(Volume(HOLED, blob(9).index_to_world), GLOWING, lights=SKY),
    "march": scene(blob(9), lights=SKY, estimator="ray-march"),
    "dense, inside": scene(
        noise(5), medium(1e12), Camera((0, 0, 0), (0, 1, 0), view_angle=90), lights=SKY
    ),
    "faint": scene(blob(9), medium(1e-30), frontal(0.9), lights=SKY),
}  # fmt: skip


class Floats:
    """Collects floating-point errors outside of the modules that overflow on purpose."""

    def __init__(self):
        self.found = []

    def __call__(self, kind, _flag):
        frame = sys._getframe(1)
        if not frame.f_code.co_filename.endswith(WRAPS):
            self.found.append(f"{kind} in {frame.f_code.co_filename}:{frame.f_lineno}")


@pytest.fixture
def floats():
    collected = Floats()
    before = np.seterrcall(collected)
    with np.errstate(divide="call", over="call", invalid="call", under="ignore"):
        yield collected
    np.seterrcall(before)
    assert not collected.found, sorted(set(collected.found))


@pytest.mark.parametrize("name", SCENES)
def test_monte_carlo(floats, name):
    # In this thread, because NumPy's error state is that of a thread
    planned = plan(replace(SCENES[name], size=(6, 5)))
    film = empty_film(planned)
    render_tile(film, planned.packed, 0, 5, 0, 6, np.full((5, 6), 2), 1)
    assert (film.count == 2).all()
    assert not film.rejected.any()
    assert np.isfinite(film.mean).all()


@pytest.mark.parametrize("mode", ["default", "fast", "paper"])
def test_occlusion(floats, mode):
    lit = scene(blob(5), medium(9.0), lights=SKY, size=(4, 4))
    picture = render_occlusion(
        lit, Occlusion(60, mode, directions=3, grid=2, slices=6, shaded=True), threads=1
    )
    assert picture.rejected_samples == 0


def test_errors_of_floats_would_be_noticed():
    collected = Floats()
    before = np.seterrcall(collected)
    with np.errstate(divide="call", invalid="call", over="call"):
        np.float32(1) / np.float32(0)
        np.float32(np.inf) - np.float32(np.inf)
        np.float32(1e38) * np.float32(1e38)
    np.seterrcall(before)
    assert [text.split(" in ")[0] for text in collected.found] == [
        "divide by zero", "invalid value", "overflow"
    ]  # fmt: skip
