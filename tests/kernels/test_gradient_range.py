"""Classification by gradient: what it computes, and majorants that are never below it."""

import math

import numpy as np
import pytest
from scenes import WHITE, blob, noise, scene, volume

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.kernels.grid import gradient
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.transfer import classify, colour
from vtkmcvr.plan import plan
from vtkmcvr.scene import TransferFunction, TransferTable, Volume

f32 = np.float32
RNG = np.random.default_rng(5)


@entry_point
def classified(medium, transfer, points, m):
    """Extinction, majorant, gradient magnitude and colour at index positions."""
    out = np.empty((len(points), 6), np.float32)
    majorant = medium.majorant
    nz, ny, nx = majorant.shape
    for i in range(len(points)):
        p = (points[i, 0], points[i, 1], points[i, 2])
        scalar, out[i, 0] = classify(
            transfer.gradient_opacity, transfer.table_2d, medium, transfer, p
        )
        x = min(int(p[0] * medium.cells_per_index), nx - 1)
        y = min(int(p[1] * medium.cells_per_index), ny - 1)
        z = min(int(p[2] * medium.cells_per_index), nz - 1)
        out[i, 1] = max(majorant[z, y, x], np.float32(0))
        g = gradient(medium.values, m, p)
        out[i, 2] = math.sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2])
        # Colours are asked for where something is
        out[i, 3:] = np.float32(0)
        if out[i, 0] > 0:
            out[i, 3:] = colour(
                transfer.colour_grid, transfer.table_2d, medium, transfer, p, scalar
            )
    return out


def look_at(vol, transfer, n=20_000):
    """Classification at random points, many of them in the outermost voxels; and the plan."""
    planned = plan(scene(vol, transfer))
    parts = planned.packed
    by_gradient = parts.transfer.gradient_opacity or parts.transfer.table_2d
    last = np.array(vol.shape) - 1
    points = RNG.random((n, 3)) * last
    border = RNG.random((n, 3)) < 0.2
    points = np.where(border, np.clip(np.round(RNG.random((n, 3)) * last), 0, last), points)
    points = points.astype(f32)
    m = by_gradient.world_from_index_gradient
    return classified(parts.medium, parts.transfer, points, m), points, parts


def sheared():
    """Noise on an oblique, stretched, sheared grid."""
    matrix = np.eye(4)
    matrix[:3, :3] = [[0.3, 0.05, 0.0], [0.1, 1.2, 0.2], [-0.2, 0.0, 0.7]]
    return Volume(noise(12).values, matrix)


def gappy():
    """Noise with missing data."""
    values = noise(12).values.copy()
    values[RNG.random(values.shape) < 0.02] = np.nan
    return Volume(values, np.diag([0.1, 0.2, 0.3, 1.0]))


VOLUMES = {"blob": blob, "noise": lambda: noise(12), "sheared": sheared, "gappy": gappy}
BANDS = Curve([(0, 0.0), (0.1, 0.0), (0.12, 1.0), (0.2, 0.9), (0.22, 0.0), (0.3, 0.3), (0.5, 1)])
TABLE = TransferTable(RNG.random((9, 17, 4)) * (RNG.random((9, 17, 1)) < 0.4), (0, 1), (0, 0.5))
TRANSFERS = {
    "gradient opacity": TransferFunction(
        None, WHITE, extinction=Curve([(0.2, 0), (0.5, 5), (0.6, 1)]), gradient_opacity=BANDS
    ),
    "table": TransferFunction(table=TABLE),
}


@pytest.mark.parametrize("transfer", TRANSFERS)
@pytest.mark.parametrize("vol", VOLUMES)
def test_majorant_is_nowhere_below_the_extinction(vol, transfer):
    found, _, _ = look_at(VOLUMES[vol](), TRANSFERS[transfer])
    sigma_t, majorant = found[:, 0], found[:, 1]
    assert (sigma_t > 0).any()
    assert (sigma_t <= majorant).all()


def test_bounds_by_gradient_are_worth_having():
    # Only steep places are dense: far fewer cells than by the scalar alone
    steep = Curve([(0.12, 0), (0.13, 1)])
    vol = blob(49)
    dense = TransferFunction(None, WHITE, extinction=Curve([(0.05, 0), (0.1, 5)]))
    edges = TransferFunction(None, WHITE, extinction=dense.extinction, gradient_opacity=steep)
    whole, shell = (plan(scene(vol, t)).packed.medium.majorant for t in (dense, edges))
    assert (shell > 0).sum() < 0.5 * (whole > 0).sum()


def test_gradient_opacity_is_a_factor_by_change_over_the_mean_spacing():
    vol = VOLUMES["sheared"]()
    transfer = TRANSFERS["gradient opacity"]
    found, _, parts = look_at(vol, transfer)
    plain = TransferFunction(None, WHITE, extinction=transfer.extinction)
    bare = plan(scene(vol, plain)).packed
    _, points, _ = look_at(vol, transfer, 100)
    m = parts.transfer.gradient_opacity.world_from_index_gradient
    full = classified(bare.medium, bare.transfer, points, m)
    found = classified(parts.medium, parts.transfer, points, m)
    expected = full[:, 0] * BANDS(full[:, 2] * vol.spacing.mean())
    np.testing.assert_allclose(found[:, 0], expected, atol=0.01 * full[:, 0].max())


def test_gradient_distance_is_in_world_units():
    transfer = TRANSFERS["gradient opacity"]
    vol = blob()
    same = TransferFunction(
        None, WHITE, extinction=transfer.extinction,
        gradient_opacity=BANDS, gradient_distance=float(vol.spacing.mean()),
    )  # fmt: skip
    a, b = (plan(scene(vol, t)).packed.transfer.gradient_opacity for t in (transfer, same))
    np.testing.assert_array_equal(a.factor, b.factor)


def test_table_is_bilinear_between_middles_of_its_intervals():
    vol = blob()
    found, points, parts = look_at(vol, TRANSFERS["table"], 500)
    dense = found[:, 0] > 0
    values = map_values(vol, points)
    magnitude = found[:, 2] * vol.spacing.mean()
    column = np.clip(values * 17 - 0.5, 0, 16)
    row = np.clip(magnitude / 0.5 * 9 - 0.5, 0, 8)
    i, j = np.minimum(column.astype(int), 15), np.minimum(row.astype(int), 7)
    u, v = (column - i)[:, None], (row - j)[:, None]
    rgba = TABLE.rgba
    alpha = rgba[..., 3]
    sigma = (-np.log1p(-alpha))[..., None]
    table = np.concatenate([sigma, rgba[..., :3]], axis=-1)
    low = table[j, i] * (1 - u) + table[j, i + 1] * u
    high = table[j + 1, i] * (1 - u) + table[j + 1, i + 1] * u
    expected = low * (1 - v) + high * v
    np.testing.assert_allclose(found[:, 0], expected[:, 0], atol=2e-4)
    np.testing.assert_allclose(found[dense, 3:], expected[dense, 1:], atol=2e-4)
    assert parts.transfer.table_2d is not None


def map_values(vol, points):
    from scipy.ndimage import map_coordinates

    return map_coordinates(vol.values.astype(float), points[:, ::-1].T.astype(float), order=1)


def test_gradient_opacity_of_one_is_no_lookup():
    one = TransferFunction(
        None, WHITE, extinction=Curve([(0, 1)]), gradient_opacity=Curve([(0, 1)])
    )
    assert plan(scene(transfer=one)).packed.transfer.gradient_opacity is None


def test_constant_volume_has_gradient_zero():
    vol = volume(np.ones((4, 4, 4), np.float32))
    half = TransferFunction(
        None, WHITE, extinction=Curve([(0, 2)]), gradient_opacity=Curve([(0, 0.5), (1, 1)])
    )
    found, _, _ = look_at(vol, half, 100)
    np.testing.assert_allclose(found[:, 0], 1.0)
    np.testing.assert_allclose(found[:, 1], 1.0, rtol=1e-5)


def test_colours_of_points_replace_those_of_the_transfer_function():
    rgb = RNG.random((5, 6, 7, 3)).astype(f32)
    for colours, scale in ((rgb, 1.0), ((rgb * 255).astype(np.uint8), 1 / 255)):
        vol = Volume(np.ones((5, 6, 7), f32), colours=colours)
        red = TransferFunction(Curve([(0, 0.5)]), ColourCurve([(0, 1, 0, 0)]))
        parts = plan(scene(vol, red)).packed
        points = (RNG.random((200, 3)) * (6, 5, 4)).astype(f32)
        m = ((f32(1), f32(0), f32(0)),) * 3
        found = classified(parts.medium, parts.transfer, points, m)[:, 3:]
        for c in range(3):
            expected = map_values(Volume(colours[..., c] * scale), points)
            np.testing.assert_allclose(found[:, c], expected, atol=1e-5)
