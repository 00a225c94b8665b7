import numpy as np
import pytest
from scenes import render, scene, volume

from vtkmcvr.plan import plan
from vtkmcvr.voxels import MOST_CELLS, NATIVE, cell_edge, voxels_of
from vtkmcvr.voxels import SMALLEST_CELL as CELL


def ramp(dtype, high=100):
    z, y, x = np.ogrid[:9, :10, :11]
    return ((7 * x + 3 * y + 5 * z) % (high + 1)).astype(dtype)


@pytest.mark.parametrize(
    ("dtype", "stored"),
    [("uint8", "uint8"), ("int8", "uint8"), ("int16", "int16"), ("uint16", "uint16"),
     ("int32", "uint8"), ("uint32", "uint8"), ("int64", "uint8"), ("float32", "float32"),
     ("float64", "float32"), ("float16", "float32"), (">i2", "int16"), (">f4", "float32")],
)  # fmt: skip
def test_values_are_kept_in_a_native_type(dtype, stored):
    raw = ramp(dtype)
    voxels = voxels_of(volume(raw))
    assert voxels.values.dtype == np.dtype(stored)
    assert voxels.values.dtype.isnative
    assert voxels.values.flags.c_contiguous
    np.testing.assert_array_equal(voxels.values + voxels.offset, raw.astype(float))
    assert (voxels.lowest, voxels.highest) == (raw.min(), raw.max())


@pytest.mark.parametrize(
    ("values", "stored"),
    [
        ((-5, 300), "int16"),
        ((0, 40_000), "uint16"),
        ((-1, 40_000), "float32"),
        ((0, 2**24), "float32"),
    ],
)
def test_integers_are_narrowed_without_loss(values, stored):
    raw = np.resize(np.array(values, np.int64), (3, 3, 3))
    voxels = voxels_of(volume(raw))
    assert voxels.values.dtype == stored
    np.testing.assert_array_equal(voxels.values.astype(np.int64), raw)


@pytest.mark.parametrize(
    "raw",
    [
        1e9 + np.arange(27.0),
        2**31 + np.arange(27),
        1e-6 * np.arange(27.0),
        -7e12 + 3 * np.arange(27.0),
    ],
)
def test_narrow_ranges_far_from_zero_keep_their_steps(raw):
    voxels = voxels_of(volume(raw.reshape(3, 3, 3)))
    step = float(raw[1] - raw[0])
    np.testing.assert_allclose(
        voxels.values.ravel() + (voxels.offset - float(raw[0])), raw - raw[0], atol=1e-6 * step * 27
    )


def test_values_beyond_float32_are_refused():
    with pytest.raises(ValueError, match=r"1e\+300; rescale"):
        voxels_of(volume(np.resize([0, 1e300], (3, 3, 3))))


def test_volume_is_converted_once_and_not_copied_if_native():
    raw = np.ascontiguousarray(ramp("float32"))
    vol = volume(raw)
    assert voxels_of(vol) is voxels_of(vol)
    assert np.shares_memory(voxels_of(vol).values, raw)


def test_nan_and_infinite_voxels_are_counted_and_out_of_the_range():
    for dtype in ("float32", "float64"):
        raw = ramp(dtype)
        raw[0, 0, 0], raw[4, 4, 4], raw[5, 5, 5] = np.nan, np.inf, -np.inf
        voxels = voxels_of(volume(raw))
        assert voxels.not_finite == 3
        assert np.isnan(voxels.values).sum() == 3
        assert (voxels.lowest, voxels.highest) == (np.nanmin(ramp(dtype)), 100)
        assert "3 voxels are NaN" in plan(scene(volume(raw))).explain()
        # The user's array is as it was
        assert raw[4, 4, 4] == np.inf


def test_volume_of_nan_alone_is_transparent():
    picture = render(scene(volume(np.full((5, 5, 5), np.nan))), samples=4)
    assert not picture.alpha.any()
    assert picture.plan.empty


def test_cells_share_their_border_voxels():
    raw = np.zeros((CELL + 2, 2 * CELL + 1, CELL + 1), np.float32)
    raw[0, CELL, 0] = 5
    raw[CELL, 0, CELL] = -3
    voxels = voxels_of(volume(raw))
    np.testing.assert_array_equal(voxels.cell_highest, [[[5], [5]], [[0], [0]]])
    np.testing.assert_array_equal(voxels.cell_lowest, [[[-3], [0]], [[-3], [0]]])


def test_cells_grow_where_there_would_be_too_many():
    assert cell_edge((10, 10, 10)) == CELL
    for shape in [(2048, 2048, 2048), (513, 511, 700), (2, 30_000, 30_000)]:
        assert np.prod(shape) / cell_edge(shape) ** 3 <= MOST_CELLS


def test_native_types_are_what_kernels_read():
    assert NATIVE == ("uint8", "int16", "uint16", "float32")


# The same values make the same picture


def alpha_of(dtype, values=None):
    values = ramp("uint8") if values is None else values
    return render(scene(volume(values.astype(dtype), (0.2,) * 3)), samples=16).alpha


def test_picture_does_not_depend_on_the_type_of_whole_numbers():
    first = alpha_of("uint8")
    assert 0.3 < first.mean() < 1.0
    for dtype in ("int16", "uint16", "int32", "uint32", "int64", ">i2"):
        np.testing.assert_array_equal(alpha_of(dtype), first)


def test_picture_does_not_depend_on_the_type_of_floats():
    first = alpha_of("float32")
    for dtype in ("float64", "float16", ">f8"):
        np.testing.assert_array_equal(alpha_of(dtype), first)
    # Whole numbers have another table. It gives the same numbers but for rounding, which flips the
    # fate of a path with a probability of some 1e-6
    assert np.mean(alpha_of("uint8") != first) < 0.01


def test_picture_of_booleans_is_that_of_zeros_and_ones():
    mask = ramp("uint8") > 50
    np.testing.assert_array_equal(alpha_of(bool, mask), alpha_of("uint8", mask))


def test_nan_voxels_are_transparent():
    # The right half is missing; a voxel's support is two voxels wide
    raw = np.ones((11, 11, 11), np.float32)
    raw[:, :, 6:] = np.nan
    alpha = render(scene(volume(raw, (0.2,) * 3)), samples=64).alpha
    film_x = np.linspace(-0.9, 0.9, 33)
    left, right = film_x[1:] <= 0, film_x[:-1] >= 0
    assert not alpha[:, right].any()
    # 1 - exp(-3 x 2) = 0.9975 in 32 x 16 pixels of 64 samples, 4.5 standard errors
    assert abs(alpha[:, left].mean() - 0.99752) < 4.5 * np.sqrt(0.0025 / (32 * 16 * 64))
