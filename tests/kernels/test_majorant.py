"""Macrocell majorants: never below the extinction, exactly zero where nothing is."""

import numpy as np
import pytest
from scenes import WHITE, medium, render, scene, volume
from scipy.ndimage import distance_transform_cdt

import vtkmcvr.voxels
from vtkmcvr.curves import Curve
from vtkmcvr.kernels import light_stages, stages, surface_stages
from vtkmcvr.kernels.cpu import render_tile
from vtkmcvr.kernels.grid import trilinear
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.launch import Launched
from vtkmcvr.kernels.majorant import mark_empty_cubes, range_maxima
from vtkmcvr.kernels.packets import walk_queue
from vtkmcvr.kernels.transfer import extinction
from vtkmcvr.lights import ConstantEnvironment
from vtkmcvr.plan import plan
from vtkmcvr.scene import Camera, Cone, HenyeyGreenstein, Rayleigh, Schlick, TransferFunction
from vtkmcvr.voxels import SMALLEST_CELL as CELL

f32 = np.float32
POINTS = 10_000


@entry_point
def extinction_and_majorant(medium, transfer, points):
    """Both at index positions, with the macrocell that the walker would look in."""
    out = np.empty((len(points), 2), np.float32)
    nz, ny, nx = medium.majorant.shape
    for i in range(len(points)):
        p = (points[i, 0], points[i, 1], points[i, 2])
        x = min(int(p[0] * medium.cells_per_index), nx - 1)
        y = min(int(p[1] * medium.cells_per_index), ny - 1)
        z = min(int(p[2] * medium.cells_per_index), nz - 1)
        out[i, 0] = extinction(transfer, trilinear(medium.values, p))
        out[i, 1] = medium.majorant[z, y, x]
    return out


def random_values(rng, dtype):
    """Random volume: noise, smooth, plateaus or mostly empty; sizes around whole macrocells."""
    shape = rng.choice([2, 3, 8, 9, 10, 16, 17, 18, 23], 3)
    noise = rng.random(shape)
    kind = rng.integers(4)
    if kind == 1:
        z, y, x = np.ogrid[: shape[0], : shape[1], : shape[2]]
        noise = (x + 2 * y + 3 * z) / 80 + 0.01 * noise
    elif kind == 2:
        noise = np.round(noise * 2) / 2
    elif kind == 3:
        noise = noise * (noise > 0.97)
    low, high = {"uint8": (0, 255), "int16": (-1000, 3000), "uint16": (0, 65535)}.get(
        dtype, (-1e-3, 2e-3)
    )
    return (low + np.clip(noise, 0, 1) * (high - low)).astype(dtype)


def random_curve(rng, low, high):
    """Nodes at random places, some spikes far narrower than the gaps between voxel values."""
    x = low + (high - low) * rng.uniform(-0.1, 1.1, rng.integers(1, 8))
    y = rng.choice([0.0, 1.0, 5.0], len(x)) * rng.random(len(x))
    nodes = list(zip(x, y, strict=True))
    for at in low + (high - low) * rng.random(3):
        width = (high - low) * 10.0 ** rng.uniform(-6, -2)
        nodes += [(at - width, 0), (at, 50 * rng.random()), (at + width, 0)]
    return Curve(nodes)


def index_points(rng, shape):
    """Everywhere, on voxels, on macrocell borders, on the outer faces."""
    last = np.array(shape[::-1]) - 1
    p = rng.random((POINTS, 3)) * last
    whole = rng.random(p.shape) < 0.2
    p[whole] = np.round(p[whole])
    border = rng.random(p.shape) < 0.1
    p[border] = np.round(p[border] / CELL) * CELL
    return np.minimum(p, last).astype(f32)


@pytest.mark.parametrize("dtype", ["uint8", "int16", "uint16", "float32"])
def test_majorant_is_nowhere_below_the_extinction(dtype):
    rng = np.random.default_rng(7)
    for _ in range(4):
        values = random_values(rng, dtype)
        low, high = float(values.min()), float(values.max())
        vol = volume(values)
        for _ in range(3):
            curve = random_curve(rng, low, high)
            parts = plan(scene(vol, TransferFunction(None, WHITE, extinction=curve))).packed
            sigma_t, majorant = extinction_and_majorant(
                parts.medium, parts.transfer, index_points(rng, values.shape)
            ).T
            # An empty cell holds minus the radius of the empty cube around it
            majorant = np.maximum(majorant, 0)
            assert (sigma_t <= majorant).all(), (curve, values.shape)


@pytest.mark.parametrize("dtype", ["uint8", "int16", "uint16", "float32"])
def test_majorant_is_tight(dtype):
    # The largest table entry between the two that enclose the cell's range: never above the largest
    # of the curve over a slightly wider range
    rng = np.random.default_rng(8)
    values = random_values(rng, dtype)
    vol = volume(values)
    low, high = float(values.min()), float(values.max())
    curve = Curve([(low, 0.0), (high, 1.0)])
    planned = plan(scene(vol, TransferFunction(None, WHITE, extinction=curve)))
    cells = vtkmcvr.voxels.voxels_of(vol).cell_highest
    expected = curve(cells + (high - low) * 2.1 / 4096)
    assert (planned.packed.medium.majorant <= expected + 2e-6).all()


def test_spike_between_two_voxel_values_is_seen():
    # Voxels are 0 or 100; only interpolated values meet the spike at 40.02 (HC-03)
    n = 2 * CELL + 1
    values = np.zeros((n, n, n), np.uint8)
    values[:, :CELL] = 100
    spike = Curve([(40.01, 0), (40.02, 30), (40.03, 0)])
    parts = plan(scene(volume(values), TransferFunction(None, WHITE, extinction=spike))).packed
    assert (parts.medium.majorant[:, 0] >= 29).all()
    assert (parts.medium.majorant[:, 1] <= 0).all()


@pytest.mark.parametrize("dtype", ["uint8", "int16", "uint16", "float32"])
def test_cells_without_extinction_are_exactly_empty(dtype):
    n = 4 * CELL + 1
    values = np.full((n, n, n), 10, dtype)
    values[CELL // 2, CELL // 2, CELL // 2] = 60
    values[2 * CELL + 1 :, 2 * CELL + 1 :, 2 * CELL + 1 :] = 90
    values[0, 0, n - 1] = 0
    curve = Curve([(50, 0), (90, 1)])
    planned = plan(scene(volume(values), TransferFunction(None, WHITE, extinction=curve)))
    occupied = np.zeros((4, 4, 4), bool)
    occupied[0, 0, 0] = True
    occupied[2:, 2:, 2:] = True
    np.testing.assert_array_equal(planned.packed.medium.majorant > 0, occupied)
    np.testing.assert_array_equal(planned.packed.medium.active_hi, (4 * CELL,) * 3)
    assert "86% of the macrocells are empty" in planned.explain()  # 55 of 64


def test_transfer_function_that_starts_at_a_cells_value_leaves_it_empty():
    # 0 up to and including 10: constant cells of 10 must not be touched by rounding
    for dtype in (np.uint8, np.float32):
        values = np.full((2 * CELL + 1,) * 3, 10, dtype)
        values[-1, -1, -1] = 20
        curve = Curve([(10, 0), (20, 1)])
        parts = plan(scene(volume(values), TransferFunction(None, WHITE, extinction=curve))).packed
        assert np.count_nonzero(parts.medium.majorant > 0) == 1


def test_range_maxima_are_maxima_over_powers_of_two():
    table = np.random.default_rng(1).random(37).astype(f32)
    maxima = range_maxima(table)
    for level in range(len(maxima)):
        for i in range(len(table)):
            assert maxima[level, i] == table[i : i + 2**level].max()


def test_empty_cells_know_the_empty_cube_around_them():
    rng = np.random.default_rng(3)
    for shape in [(1, 1, 1), (7, 9, 8), (30, 2, 17), (20, 20, 20)]:
        for share in (0.0, 0.002, 0.1, 0.9):
            occupied = rng.random(shape) < share
            majorant = np.where(occupied, rng.random(shape) + 0.1, 0).astype(f32)
            marked = majorant.copy()
            mark_empty_cubes(marked)
            np.testing.assert_array_equal(marked[occupied], majorant[occupied])
            if occupied.any():
                # Chessboard distance to the nearest occupied cell, less one
                distance = distance_transform_cdt(~occupied, "chessboard")
                np.testing.assert_array_equal(marked[~occupied], 1 - distance[~occupied])
            else:
                assert (marked <= -(max(shape) - 1)).all()


def test_edit_of_the_transfer_function_reads_no_voxel(monkeypatch):
    calls = []
    prepare = vtkmcvr.voxels._prepare
    monkeypatch.setattr(vtkmcvr.voxels, "_prepare", lambda *raw: calls.append(1) or prepare(*raw))
    vol = volume(np.random.default_rng(2).random((9, 9, 9), np.float32))
    majorants = [plan(scene(vol, medium(s))).packed.medium.majorant.max() for s in (1, 2, 3)]
    assert len(calls) == 1
    assert majorants == pytest.approx(np.multiply(majorants[0], (1, 2, 3)))
    plan(scene(volume(vol.values)))
    assert len(calls) == 2


def test_quantities_compile_nothing():
    kernels = [
        render_tile,
        walk_queue,
        *(
            stage
            for module in (stages, surface_stages, light_stages)
            for stage in vars(module).values()
            if isinstance(stage, Launched)
        ),
    ]
    assert len(kernels) == 14
    lit = {"lights": (ConstantEnvironment(1.0),)}

    def signatures(*args, **options):
        render(scene(*args, **{**lit, **options}), samples=1)
        return sum(len(kernel.signatures) for kernel in kernels)

    before = signatures()
    camera = Camera((3, -9, 2), (0.1, 0, 0), view_angle=20)
    many_nodes = Curve([(x, x % 0.3) for x in np.linspace(0, 1, 2000)])
    assert before == signatures(camera=camera)
    assert before == signatures(transfer=TransferFunction(None, WHITE, extinction=many_nodes))
    assert before == signatures(
        volume(np.asfortranarray(np.random.default_rng(1).random((5, 9, 30))))
    )
    assert before == signatures(lights=(ConstantEnvironment((1, 2, 3)),), shadow_reach=0.7)
    assert before == signatures(size=(5, 3), environment_visible=True)
    read_only = np.ones((4, 4, 4), np.float32)
    read_only.flags.writeable = False
    assert before == signatures(volume(read_only))
    assert before == signatures(estimator="woodcock")
    assert before == signatures(scattering="multiple", max_scatterings=1)
    assert before == signatures(phase=HenyeyGreenstein(0.0))
    # Which phase function, and how many events, are quantities too
    lit.update(scattering="multiple", phase=Rayleigh())
    before = signatures()
    for phase in (HenyeyGreenstein(0.5), Schlick(-0.3), Cone(20)):
        assert before == signatures(phase=phase, max_scatterings=7)
