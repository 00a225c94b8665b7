"""Figures to watch from version to version: `make bench-compare` beside those of `baseline.json`.

Timings of one process on one thread, of synthetic volumes, so that they need no data. Compare them
on one machine only; `make bench-baseline` writes the baseline of yours.
"""

from dataclasses import replace

import numpy as np
import pytest

import vtkmcvr
from vtkmcvr.curves import Curve
from vtkmcvr.front import scene_of
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene

pytest.importorskip("pytest_benchmark", reason="timings take pip install 'vtkmcvr[bench]'")
pytestmark = pytest.mark.bench

SIZE, SAMPLES = (160, 120), 8
# An edit of the transfer function of a 512^3 volume is to be as quick as this, in seconds
EDIT_SECONDS = 0.05


@pytest.fixture(scope="module")
def look():
    head = vtkmcvr.Volume.from_grid(*vtkmcvr.head_phantom(96))
    return scene_of(head, preset="ct-bone", size=SIZE).scene


def paths(benchmark, scene):
    """Time 8 samples of each pixel."""
    planned = plan(scene)
    render_scene(planned, samples=1, threads=1, backend="cpu")
    benchmark.extra_info["paths"] = SIZE[0] * SIZE[1] * SAMPLES
    picture = benchmark(lambda: render_scene(planned, samples=SAMPLES, threads=1, backend="cpu"))
    assert picture.alpha.any()


def test_look_as_it_is(benchmark, look):
    paths(benchmark, look)


def test_one_light_without_surfaces(benchmark, look):
    paths(benchmark, replace(look, lights=look.lights[1:2], surface=None))


def test_many_scatterings(benchmark, look):
    paths(benchmark, replace(look, scattering="multiple"))


def test_occlusion(benchmark, look):
    render_occlusion(look, Occlusion(60), threads=1)
    picture = benchmark(lambda: render_occlusion(look, Occlusion(60), threads=1))
    assert picture.alpha.any()


def test_plan_of_a_new_view(benchmark, look):
    planned = plan(look)
    moved = replace(look, camera=replace(look.camera, view_angle=20.0))
    assert benchmark(lambda: plan(moved, like=planned)).packed.medium is planned.packed.medium


def test_edit_of_the_transfer_function_of_512_cubed(benchmark):
    x = np.linspace(-1, 1, 512, dtype=np.float32)
    values = np.empty((512, 512, 512), np.uint16)
    for k in range(512):
        radius = np.sqrt(x[k] ** 2 + x[:, None] ** 2 + x**2)
        values[k] = np.clip(3000 - 2500 * radius + 200 * np.sin(20 * x), 0, 4095)
    volume = vtkmcvr.Volume.from_grid(values, (1.0, 1.0, 1.0))
    scene = scene_of(volume, preset="solid", size=(800, 600)).scene
    plan(scene)
    edits = iter(range(1, 10_000))

    def edit():
        step = next(edits)
        opacity = Curve([(1500 + step, 0.0), (1600 + step, 1.0)])
        return plan(replace(scene, transfer=replace(scene.transfer, opacity=opacity)))

    planned = benchmark.pedantic(edit, rounds=15, warmup_rounds=1)
    assert not planned.empty
    # The least of the rounds, which other programs disturb least
    assert benchmark.stats.stats.min < EDIT_SECONDS
