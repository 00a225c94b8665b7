"""Hard cases by the CUDA launcher: in the simulator they are the CPU's pictures too."""

from dataclasses import replace

import numpy as np
import pytest
from needs import numba_cuda
from scenes import BOX, blob, frontal, medium, scene, volume
from simulated import check_same, films_of

from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.scene import Camera, HenyeyGreenstein

pytestmark = numba_cuda

SIZE, COUNTS = (6, 5), np.full((5, 6), 2, np.int64)
SKY = (ConstantEnvironment(1.0),)


def lit(vol, transfer=None, camera=None, **options):
    return scene(
        vol, transfer or medium(2.0), camera or frontal(0.9), lights=SKY, size=SIZE,
        pixel_filter=BOX, **options,
    )  # fmt: skip


def holes():
    """NaN and infinities among the voxels (HC-15)."""
    values = blob(9).values.copy()
    values[4, 4, :3] = np.nan
    values[2:4, 5, 5] = np.inf, -np.inf
    return volume(values, (0.25,) * 3)


def moved(vol, offset):
    matrix = vol.index_to_world.copy()
    matrix[:3, 3] += offset
    return replace(vol, index_to_world=matrix)


BLOB = blob(9)
FAR, BACK = np.array((2.0**23, 0.0, -(2.0**23))), np.array((0.0, 50.0, 0.0))
SCENES = {
    "HC-07 rays along faces and edges of cells": lit(
        volume(np.ones((9, 9, 9)), (0.25,) * 3), camera=frontal(1.0)
    ),
    "HC-07 from the middle of the volume": lit(
        BLOB, camera=Camera((0, 0, 0), (0, 1, 0), view_angle=60)
    ),
    "HC-08 far from the origin": lit(
        moved(BLOB, FAR), camera=Camera(FAR - BACK, FAR, parallel_scale=0.9)
    ),
    "HC-09 extinction of 1e12": lit(BLOB, medium(1e12)),
    "HC-10 two voxels thin, two hundred long": lit(
        volume(np.ones((200, 2, 2)), (1.0, 1.0, 0.01)), medium(1.0)
    ),
    "HC-15 NaN and infinite voxels": lit(holes()),
    "HC-16 voxels 1000 times longer than thick": lit(
        volume(BLOB.values, (2.0 / 8, 2.0 / 8, 2.0 / 8000)), medium(300.0),
        Camera((0.1, 0.5, -30), (0, 0, 0), (0, 1, 0), parallel_scale=0.9),
    ),
    "HC-32 g of 0.9999 to unlimited scattering": lit(
        BLOB, phase=HenyeyGreenstein(0.9999), scattering="multiple"
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def films(tmp_path_factory):
    return films_of(SCENES, COUNTS, tmp_path_factory.mktemp("simulated"))


@pytest.mark.parametrize("name", SCENES)
def test_hard_case_is_that_of_the_cpu(films, name):
    cpu, simulated = films[name]
    assert cpu.hits.sum() > 0
    assert np.isfinite(simulated.mean).all()
    check_same(cpu, simulated)
