"""Hard cases of free paths (HC-01 to HC-16): extreme, thin, empty, far away, odd types.

Alpha is compared with closed forms or with quadrature in float64 (`brute`).
"""

import math
from dataclasses import replace

import brute
import numpy as np
import pytest
from compiled import compiled
from scenes import WHITE, blob, frontal, medium, noise, scene, slab, volume
from techniques import (
    OCCLUSION,
    SKY,
    by_monte_carlo,
    cameras,
    deviation,
    every_camera,
    every_technique,
    picture_by,
    relative_difference,
)

from vtkmcvr.curves import Curve
from vtkmcvr.kernels.grid import trilinear
from vtkmcvr.kernels.rng import minus_logarithm
from vtkmcvr.occlusion import Occlusion, render_occlusion
from vtkmcvr.plan import plan
from vtkmcvr.rendering import render_scene
from vtkmcvr.scene import TransferFunction, Volume

f32 = np.float32


def lit(vol, transfer, camera, size=(16, 16), **options):
    return scene(vol, transfer, camera, size, lights=SKY, **options)


def check_alpha(record, case, what, technique, lit_scene, samples=64, expected=None, slices=2e-3):
    picture = picture_by(technique, lit_scene, samples)
    expected = brute.alpha(lit_scene) if expected is None else expected
    got = float(picture.alpha.mean(dtype=np.float64))
    record(case, what, technique, expected, got, deviation(technique, picture, expected, slices))
    return picture


@every_camera
@every_technique
def test_hc01_a_plate_of_one_voxel_is_opaque(record, technique, view):
    values = np.zeros((20, 20, 20), f32)
    values[:, 15, :] = 1
    vol = volume(values)
    opaque = TransferFunction(Curve([(0.5, 0), (0.5, 1)]), WHITE, unit_distance=1.0)
    seen = lit(vol, opaque, cameras(vol, 5.0)[view])
    # 24 ln 2 optical depths: a miss has probability 6e-8 a sample
    check_alpha(record, "HC-01", f"opaque plate of one voxel, {view}", technique, seen, 16, 1.0)


@every_camera
@every_technique
def test_hc02_density_enters_once(record, technique, view):
    # Opacity 0.3 per 0.5 world units at half the density
    vol = slab((20, 2, 20), 33)
    transfer = TransferFunction(Curve([(1, 0.3)]), WHITE, unit_distance=0.5, density_scale=0.5)
    seen = lit(vol, transfer, cameras(vol, 0.9)[view])
    # Inside, the first quarter of a slice before the eye is missing
    slices = 0.01 if view == "inside" else 2e-3
    what = f"slab of half the density, {view}"
    check_alpha(record, "HC-02", what, technique, seen, slices=slices)


@every_technique
def test_hc03_extinction_between_two_voxel_values(record, technique):
    # Voxels are 0 or 1: only interpolated scalars meet the spike
    values = (np.random.default_rng(3).random((9, 9, 9)) > 0.5).astype(f32)
    vol = volume(values, (0.25,) * 3)
    spike = TransferFunction(
        None, WHITE, extinction=Curve([(0, 0), (0.4, 0), (0.42, 30), (0.44, 0), (1, 0)])
    )
    seen = lit(vol, spike, frontal(0.9))
    # Slices take scalars to be linear between them
    check_alpha(
        record, "HC-03", "spike between the voxels' values", technique, seen, 256, slices=0.02
    )


@by_monte_carlo
def test_hc04_no_extinction_is_above_its_majorant(record, technique):
    # Noise, spikes, coincident nodes: what is above is counted, whatever the sample becomes
    rng = np.random.default_rng(4)
    violations = 0
    for _ in range(20):
        nodes = np.sort(rng.random(6))
        curve = Curve([(x, 40 * y**4) for x, y in zip(nodes, rng.random(6), strict=True)])
        spiky = TransferFunction(None, WHITE, extinction=curve)
        seen = lit(noise(7, int(rng.integers(99))), spiky, frontal(0.9), (32, 32))
        violations += picture_by(technique, seen, 16).majorant_violations
    record("HC-04", "violated majorants in 20 noises", technique, 0, violations, 0)


@every_technique
def test_hc05_a_ray_may_cross_a_thousand_cells(record, technique):
    # 3000 voxels, over 1000 macrocells, of faint haze before an opaque wall
    values = np.full((2, 3000, 2), 0.1, f32)
    values[:, -8:, :] = 1
    vol = volume(values, (4.0, 0.04, 4.0))
    faint = TransferFunction(
        None, WHITE, extinction=Curve([(0, 0), (0.1, 1e-3), (0.2, 1e-3), (0.21, 1e3)])
    )
    seen = lit(vol, faint, frontal(1.0, distance=100), (8, 8))
    check_alpha(record, "HC-05", "wall behind 1000 macrocells", technique, seen, 16, 1.0)


def test_hc06_long_free_paths_are_drawn(record):
    # -log(u) on 32 bits: finite at both ends, and beyond 16 for as many words as there should be
    draw = compiled(minus_logarithm)
    record("HC-06", "longest free path", "kernel", 33 * math.log(2), draw(np.uint64(0)), 1e-5)
    shortest = draw(np.uint64(2**32 - 1))
    assert 0 <= shortest < 2.0**-31
    beyond = sum(draw(np.uint64(word)) > 16 for word in range(600))
    record("HC-06", "words of 2^32 beyond 16", "kernel", 2**32 * math.exp(-16), beyond, 1)


@by_monte_carlo
@pytest.mark.parametrize("edge", ["faces", "edges"])
def test_hc07_rays_in_the_faces_of_cells(record, technique, edge):
    # Pixel centres fall on voxel planes, or lines, and the film is too narrow to see beside them
    vol = volume(np.ones((19, 19, 19), f32), (0.1,) * 3)
    aim = (0.3, 0.0, 0.05) if edge == "faces" else (0.3, 0.0, -0.3)
    camera = replace(frontal(1e-12), position=(aim[0], -5.0, aim[2]), focal_point=aim)
    seen = lit(vol, medium(0.5), camera, (8, 8))
    expected = -math.expm1(-0.5 * 1.8)
    check_alpha(record, "HC-07", f"rays along {edge} of cells", technique, seen, 256, expected)


@every_technique
def test_hc07_rays_from_inside_and_from_a_face(record, technique):
    vol = slab((2, 2, 2), 5)
    for y, length in ((0.0, 1.0), (-1.0, 2.0)):
        camera = replace(frontal(0.9), position=(0, y, 0), focal_point=(0, y + 1, 0))
        seen = lit(vol, medium(1.0), camera)
        what = "camera in the middle" if y == 0 else "camera on the front face"
        check_alpha(record, "HC-07", what, technique, seen, 64, -math.expm1(-length))


@every_technique
def test_hc08_far_from_the_origin(record, technique):
    # Shifts that float64 holds exactly
    def picture(shift):
        shift = np.array(shift)
        camera = cameras(blob(centre=shift), 0.9)["perspective"]
        return picture_by(technique, lit(blob(centre=shift), medium(3.0), camera), 8)

    near, far = picture((0.0, 0.0, 0.0)), picture((2.0**22, -(2.0**20), 2.0**21))
    difference = relative_difference(far, near)
    record("HC-08", "scene moved by 4e6 units", technique, 0, difference, 0)


@every_technique
def test_hc09_extreme_extinction_ends(record, technique, watchdog):
    opaque = TransferFunction(Curve([(0, 0), (0.2, 1)]), WHITE, density_scale=1e6)
    seen = lit(slab((2, 2, 2), 9), opaque, frontal(0.9))
    picture = check_alpha(record, "HC-09", "opacity 1, density 1e6", technique, seen, 16, 1.0)
    assert any("cut off" in note for note in picture.plan.notes)
    # The front face, 4 away: 64 optical depths per voxel of 0.25; half a slice of 0.24 voxel
    depth = float(picture.depth.mean(dtype=np.float64))
    expected, tolerance = 4 + 1 / 256, 4.5 / 256 / 64
    if technique in OCCLUSION:
        expected, tolerance = 4 + 0.25 * 0.24 / 2, 1e-3
    record("HC-09", "its depth", technique, expected, depth, tolerance)


@pytest.mark.parametrize("ratio", [1e4, 1e7])
@every_technique
def test_hc09_voxels_far_longer_than_thick(record, technique, ratio, watchdog):
    # Half of it is opaque, seen along the thin axis; shadow rays walk along the long ones, where 64
    # optical depths a voxel would never end
    values = np.zeros((12, 12, 12), f32)
    values[:6] = 1
    vol = volume(values, (1.0, 1.0, 1 / ratio))
    opaque = TransferFunction(Curve([(0.5, 0), (0.5, 1)]), WHITE, unit_distance=1 / ratio)
    camera = replace(frontal(5.0), position=(0, 0, 9.0), focal_point=(0, 0, 0), view_up=(0, 1, 0))
    seen = lit(vol, opaque, camera, (8, 8))
    # At most 2^20 optical depths over the diagonal: little in half a volume as thin as that
    expected = -math.expm1(-(2.0**20) / (2 * vol.radius) * 5.5 / ratio)
    what = f"voxels {ratio:.0e} : 1"
    picture = check_alpha(record, "HC-09", what, technique, seen, 64, expected, slices=0.01)
    assert any("cut off" in note for note in picture.plan.notes)


EMPTY = {
    "all zero": Curve([(0, 0), (1, 0)]),
    "beyond the data": Curve([(5, 0), (6, 9)]),
    "denormal": Curve([(0, 5e-324), (1, 5e-324)]),
}


@pytest.mark.parametrize("kind", EMPTY)
@every_technique
def test_hc10_nothing_to_see(record, technique, kind):
    empty = TransferFunction(None, WHITE, extinction=EMPTY[kind])
    picture = picture_by(technique, lit(noise(), empty, frontal(0.9), (8, 8)), 4)
    total = float(np.abs(picture.radiance).sum() + picture.alpha.sum())
    record("HC-10", f"transfer function {kind}", technique, 0, total, 0)
    assert np.isinf(picture.depth).all()


@every_technique
def test_hc10_constant_volume(record, technique):
    # Range 0: no division by it
    seen = lit(volume(np.full((5, 5, 5), 1e-3, f32), (0.5,) * 3), medium(500.0), frontal(0.9))
    expected = -math.expm1(-1.0)
    check_alpha(record, "HC-10", "constant volume", technique, seen, 64, expected)


@pytest.mark.parametrize("sigma_t", [1.0, 1e2, 1e4])
@pytest.mark.parametrize("technique", ["monte-carlo single", "occlusion default"])
def test_hc11_no_point_shadows_itself(record, technique, sigma_t):
    # A half-space is as bright at any density: (1 - ln 2) / 2 under the whole sky,
    # 1 - ln(2 / (1 + c)) / (1 - c) under a cone of cosine c
    edge = 40.0 / sigma_t
    vol = slab((4 * edge, edge, 4 * edge), 65)
    camera = frontal(edge / 40, (0, -edge / 2, 0), distance=2 * edge)
    picture = picture_by(technique, lit(vol, medium(sigma_t), camera, (8, 8)), 256)
    got = float(picture.radiance.mean(dtype=np.float64))
    what = f"half-space of extinction {sigma_t:g}"
    if technique == "monte-carlo single":
        error = float(np.sqrt((picture.standard_error[..., 0] ** 2).sum()) / 64)
        record("HC-11", what, technique, (1 - math.log(2)) / 2, got, 4.5 * error)
    else:
        expected = 1 - math.log(2 / 1.5) / 0.5
        record("HC-11", what, technique, expected, got, 0.03 * expected)


@every_technique
def test_hc12_thinner_than_any_step(record, technique):
    vol = volume(np.ones((3, 2, 3), f32), (2.0, 1e-5, 2.0))
    seen = lit(vol, medium(1e5), frontal(0.9))
    expected = -math.expm1(-1.0)
    check_alpha(record, "HC-12", "slab of 1e-5", technique, seen, 64, expected)


@by_monte_carlo
def test_hc13_shadows_by_ratio_and_by_delta_tracking(record, technique):
    seen = lit(blob(), medium(3.0, 0.7), frontal(0.9), (32, 32))
    ratio = picture_by(technique, seen, 64, 1)
    delta = picture_by(technique, replace(seen, ratio_tracking=False), 64, 2)

    def moments(picture):
        error = picture.standard_error[..., 0].astype(float)
        return picture.radiance[..., 0].mean(dtype=float), math.sqrt((error**2).sum()) / 1024

    (a, ea), (b, eb) = moments(ratio), moments(delta)
    record("HC-13", "ratio against delta tracking", technique, b, a, 4.5 * math.hypot(ea, eb))
    assert ea < eb


def test_hc14_bytes_interpolate_to_distinct_values(record):
    # 0..10 over 100 positions between the points
    ramp = np.broadcast_to(np.arange(0, 11, dtype=np.uint8), (2, 2, 11)).copy()
    read = compiled(trilinear)
    seen = {read(ramp, (f32(x), f32(0.5), f32(0.5))) for x in np.linspace(0, 10, 101)}
    record("HC-14", "distinct values on a ramp of bytes", "kernel", 101, len(seen), 0)


TYPES = ["i1", "u1", "?", "i2", ">u2", "i4", "u8", "f2", ">f4", "f8"]


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("technique", ["monte-carlo single", "occlusion default"])
def test_hc15_any_type_of_scalars(record, technique, dtype):
    # The same zeros and ones, at the low end and within the upper half of the type's range
    mask = np.random.default_rng(8).random((7, 7, 7)) > 0.6
    low, high = (0, 1) if dtype == "?" else (-60, 63) if dtype == "i1" else (3, 120)
    values = np.where(mask, high, low).astype(dtype)
    transfer = TransferFunction(None, WHITE, extinction=Curve([(low, 0.05), (high, 2.0)]))
    seen = lit(volume(values, (0.3,) * 3), transfer, frontal(0.8))
    check_alpha(record, "HC-15", f"scalars of type {dtype}", technique, seen)


@pytest.mark.parametrize("unit", [1e-300, 1e-42, 1e-30, 1e-9, 1e9, 1e30])
@every_technique
def test_hc15_any_magnitude_of_scalars(record, technique, unit):
    dtype = f32 if unit > 1e-40 else np.float64
    vol = blob()
    scaled = Volume((vol.values * np.float64(unit)).astype(dtype), vol.index_to_world)
    transfer = TransferFunction(None, WHITE, extinction=Curve([(0, 0), (unit, 3.0)]))
    camera = frontal(0.9)
    pictures = (
        picture_by(technique, lit(v, t, camera), 8)
        for v, t in ((scaled, transfer), (vol, medium(3.0)))
    )
    difference = relative_difference(*pictures)
    record("HC-15", f"scalars around {unit:g}", technique, 0, difference, 1e-3)


@every_technique
def test_hc15_voxels_that_are_no_number(record, technique):
    values = np.ones((5, 5, 5), f32)
    values[1, 1, 1], values[3, 3, 3], values[1, 3, 3] = np.nan, np.inf, -np.inf
    vol = volume(values, (0.5,) * 3)
    picture = picture_by(technique, lit(vol, medium(2.0), frontal(0.9)), 64)
    # All cells next to such a voxel are transparent: 8 of 64 each, all apart
    holes = np.ones((4, 4, 4))
    for k, j, i in ((1, 1, 1), (3, 3, 3), (1, 3, 3)):
        holes[k - 1 : k + 1, j - 1 : j + 1, i - 1 : i + 1] = 0
    x = (np.arange(320) + 0.5) / 320 * 1.8 - 0.9
    index = np.floor((x + 1) / 0.5).astype(int)
    through = 0.5 * 2.0 * holes.sum(axis=1)
    expected = float(np.mean(-np.expm1(-through[np.ix_(index, index)])))
    got = float(picture.alpha.mean(dtype=float))
    tolerance = deviation(technique, picture, expected, 0.01)
    record("HC-15", "NaN and infinite voxels", technique, expected, got, tolerance)


@pytest.mark.parametrize("spacing", [(0.1, 0.1, 0.3), (0.1, 100.0, 0.1), (1.0, 1.0, 1e-3)])
@every_technique
def test_hc16_anisotropic_and_sheared_grids(record, technique, spacing):
    rng = np.random.default_rng(6)
    matrix = np.eye(4)
    shear = np.array([[1, 0.3, 0], [0, 1, 0.2], [0, 0, -1.0]])
    matrix[:3, :3] = shear * spacing
    vol = Volume(rng.random((7, 6, 5)), matrix)
    size = vol.radius
    c = vol.centre
    camera = replace(
        frontal(size * 0.2), position=c - (0.3 * size, 3 * size, size), focal_point=tuple(c)
    )
    seen = lit(vol, medium(2.0 / min(size, 8 * min(spacing))), camera)
    what = f"sheared grid of spacing {spacing}"
    check_alpha(record, "HC-16", what, technique, seen, 256)


def test_every_cut_off_is_noted():
    assert not plan(lit(blob(), medium(3.0), frontal(0.9))).notes
    assert render_occlusion(lit(blob(), medium(3.0), frontal(0.9)), Occlusion()).plan.notes
    assert render_scene(lit(blob(), medium(1e12), frontal(0.9)), samples=1).plan.notes
