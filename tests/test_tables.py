import math

import numpy as np
import pytest
from compiled import compiled
from scenes import WHITE, scene, volume

from vtkmcvr.curves import ColourCurve, Curve
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.transfer import extinction, rgb
from vtkmcvr.plan import plan
from vtkmcvr.scene import TransferFunction
from vtkmcvr.tables import DEEPEST_VOXEL, FEWEST, MOST, OPAQUE_DEPTH, build_tables, table_entries
from vtkmcvr.voxels import voxels_of


@entry_point
def look_up(transfer, scalars):
    out = np.empty((len(scalars), 4), np.float32)
    for i in range(len(scalars)):
        s = np.float32(scalars[i])
        out[i, 0] = extinction(transfer, s)
        out[i, 1:] = rgb(transfer.colour, transfer, s)
    return out


def span(low, high, dtype, spacing=1.0):
    values = np.full((2, 2, 3), low, dtype)
    values[0, 0, 0] = high
    return volume(values, (spacing,) * 3)


CURVE = Curve([(-50, 0.3), (10, 0.0), (10, 2.0), (77, 0.5, 0.2, 0.7), (200, 1.0), (60_000, 7.0)])
COLOUR = ColourCurve([(0, 1, 0.5, 0), (100, 0, 0.2, 1, 0.5, 1.0), (50_000, 1, 1, 1)])


@pytest.mark.parametrize(
    ("dtype", "low", "high"),
    [("uint8", 0, 255), ("uint8", 7, 10), ("int16", -1024, 3071), ("int16", -32768, 32767),
     ("uint16", 0, 65535)],
)  # fmt: skip
def test_tables_are_exact_at_every_integer(dtype, low, high):
    transfer = TransferFunction(None, COLOUR, extinction=CURVE)
    parts = plan(scene(span(low, high, dtype), transfer)).packed
    x = np.arange(low, high + 1)
    out = look_up(parts.transfer, x)
    # float32 of the table, and of its position where it has up to 131072 entries
    np.testing.assert_allclose(out[:, 0], CURVE(x), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(out[:, 1:], COLOUR(x), rtol=1e-6, atol=1e-6)


def test_tables_of_floats_follow_the_curve():
    # 0.02 between the closest nodes: well above the pitch
    curve = Curve([(0, 0), (0.4, 0), (0.42, 5), (0.44, 0), (1, 1)])
    parts = plan(
        scene(span(0, 1, "float32"), TransferFunction(None, WHITE, extinction=curve))
    ).packed
    x = np.random.default_rng(1).random(5000).astype(np.float32)
    pitch = 1 / 16384
    # A kink inside a table interval costs at most its change of slope times a quarter of the pitch
    np.testing.assert_allclose(
        look_up(parts.transfer, x)[:, 0], curve(x), atol=500 * pitch / 4 + 1e-5
    )


@pytest.mark.parametrize("integer", [True, False])
@pytest.mark.parametrize("finest", [1e-7, 0.5, 10, math.inf])
@pytest.mark.parametrize("width", [1, 255, 4095, 65535])
def test_number_of_entries(width, finest, integer):
    n = table_entries(width, finest, integer)
    pitch = width / (n - 1)
    assert n > FEWEST
    assert n <= MOST + width + 1
    assert pitch <= max(finest / 4, width / MOST) * (1 + 1e-9)
    if integer:
        assert (n - 1) % width == 0
    assert table_entries(0, finest, integer) == 2


def test_nan_has_no_extinction():
    parts = plan(scene(span(0, 10, "float32"), TransferFunction(Curve([(0, 1)]), COLOUR))).packed
    assert compiled(extinction)(parts.transfer, np.float32(np.nan)) == 0


def opaque_tables(spacing, unit, density=1.0, alpha=1.0):
    transfer = TransferFunction(
        Curve([(0, 0), (1, alpha)]), WHITE, unit_distance=unit, density_scale=density
    )
    return build_tables(transfer, voxels_of(span(0, 1, "uint8", spacing)), spacing)


@pytest.mark.parametrize(("spacing", "unit"), [(1.0, 1.0), (0.5, 1.0), (1.0, 0.25)])
def test_full_opacity_is_the_documented_depth(spacing, unit):
    assert pytest.approx(24 * math.log(2)) == OPAQUE_DEPTH
    tables = opaque_tables(spacing, unit)
    depth = min(OPAQUE_DEPTH / min(spacing, unit), DEEPEST_VOXEL / spacing)
    assert tables.sigma_t[-1] == pytest.approx(depth, rel=1e-6)
    assert tables.opacity_distance == unit
    # Transmittance of the shorter of the two distances: 2^-24
    if not tables.capped:
        assert math.exp(-tables.sigma_t[-1] * min(spacing, unit)) == pytest.approx(2**-24, rel=1e-4)


@pytest.mark.parametrize("alpha", [1e-9, 0.3, 0.999])
def test_opacity_becomes_extinction_without_loss(alpha):
    tables = opaque_tables(1.0, 2.5, 1.5, alpha)
    assert tables.sigma_t[-1] == pytest.approx(-math.log1p(-alpha) / 2.5 * 1.5, rel=1e-6)
    assert not tables.capped


def test_cut_off_extinction_is_noted():
    tables = opaque_tables(0.5, 1.0, density=100)
    assert tables.capped
    assert tables.sigma_t.max() == pytest.approx(DEEPEST_VOXEL / 0.5)
    transfer = TransferFunction(Curve([(0, 0), (1, 1)]), WHITE, density_scale=100)
    assert "cut off at 64" in plan(scene(span(0, 1, "uint8", 0.5), transfer)).explain()
    assert "cut off" not in plan(scene(span(0, 1, "uint8", 0.5))).explain()


def test_nodes_finer_than_the_table_are_noted():
    fine = Curve([(0, 0), (0.5, 0), (0.5 + 1e-6, 1), (0.5 + 2e-6, 0), (1, 0)])
    planned = plan(scene(span(0, 1, "float32"), TransferFunction(None, WHITE, extinction=fine)))
    assert any("closer than the table" in note for note in planned.notes)


def test_constant_volume_has_its_value():
    transfer = TransferFunction(None, COLOUR, extinction=CURVE)
    parts = plan(scene(span(20, 20, "int16"), transfer)).packed
    np.testing.assert_allclose(
        look_up(parts.transfer, np.array([20]))[0], [CURVE(20), *COLOUR(20)], rtol=1e-6
    )
    assert parts.medium.majorant.max() == pytest.approx(CURVE(20), rel=1e-5)
