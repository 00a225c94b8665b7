import numpy as np
import pytest

from vtkmcvr.phantom import HeadPhantom, head_phantom


@pytest.fixture(scope="module")
def head() -> HeadPhantom:
    return head_phantom()


@pytest.fixture(scope="module")
def coarse() -> HeadPhantom:
    return head_phantom(64)


def voxel(head, point):
    i, j, k = ((p - o) / s for p, o, s in zip(point, head.origin, head.spacing, strict=True))
    return round(k), round(j), round(i)


def around(head, point, voxels=1):
    return head.values[tuple(slice(n - voxels, n + voxels + 1) for n in voxel(head, point))]


def left_and_right(point):
    return [point, (-point[0], *point[1:])]


def test_geometry(head):
    assert head.values.dtype == np.int16
    assert head.values.shape == (192, 192, 192)
    assert head.values.flags.c_contiguous
    assert head.origin == (-100, -115, -120)
    last = [o + 191 * s for o, s in zip(head.origin, head.spacing, strict=True)]
    assert last == pytest.approx([100, 115, 120])


def test_same_bytes_twice_whatever_the_global_random_state(coarse):
    np.random.seed(0)  # noqa: NPY002
    assert head_phantom(64).values.tobytes() == coarse.values.tobytes()


@pytest.mark.parametrize("size", [16, 33, 64])
def test_odd_and_small_sizes_hold_a_head(size):
    small = head_phantom(size)
    assert small.values.shape == (size,) * 3
    assert 0.24 < np.mean(small.values > -500) < 0.3


@pytest.mark.parametrize("size", [15, 0, -1])
def test_too_small_is_refused(size):
    with pytest.raises(ValueError, match="at least 16"):
        head_phantom(size)


def test_air_around_the_head_has_no_noise(head):
    assert np.all(head.values[-6:] == -1000)
    assert np.all(head.values[:, :4] == -1000)
    assert np.all(head.values[:, :, :8] == -1000)
    assert head.values.min() == -1000


@pytest.mark.parametrize(
    ("part", "point", "low", "high"),
    [
        ("white or grey matter", (25, 10, 50), 25, 42),
        ("cerebellum", (20, 45, 0), 25, 42),
        ("lateral ventricle", (10, 14, 42), 0, 18),
        ("vitreous", (31, -56, 6), 2, 22),
        ("orbital fat", (27, -40, 2), -95, -50),
        ("tongue", (5, -34, -54), 50, 70),
        ("vertebra", (0, 22, -79), 400, 1600),
    ],
)
def test_tissue_is_in_its_range(head, part, point, low, high):
    for side in left_and_right(point):
        assert low <= around(head, side).mean() <= high, part


@pytest.mark.parametrize(
    ("part", "point"),
    [
        ("frontal sinus", (9, -68, 27)),
        ("maxillary sinus", (27, -47, -22)),
        ("sphenoid sinus", (6, -17, 4)),
        ("mastoid cells", (47, 28, -21)),
        ("nasal cavity", (5, -30, -18)),
        ("pharynx", (0, -1, -70)),
    ],
)
def test_air_cells_are_air(head, part, point):
    for side in left_and_right(point):
        assert head.values[voxel(head, side)] < -900, part


@pytest.mark.parametrize("x", [-20, 0, 20])
def test_a_ray_through_the_forehead_meets_table_diploe_table(head, x):
    k, _, i = voxel(head, (x, 0, 60))
    ray = head.values[k, :, i].astype(float)
    bone = np.flatnonzero(ray[:96] > 300)
    assert np.all(np.diff(bone) == 1)
    wall = ray[bone[0] : bone[-1] + 1]
    middle = wall.size // 2
    outer, inner = wall[:middle].max(), wall[middle:].max()
    assert 1200 <= outer <= 1800
    assert 1200 <= inner <= 1800
    assert 400 <= wall[middle - 1 : middle + 2].min() <= 900
    assert ray[bone[-1] + 6 :][:10].mean() == pytest.approx(34, abs=12)


def test_teeth_are_the_densest_and_the_filling_is_on_the_left(head):
    filling = np.argwhere(head.values > 2700)
    x = head.origin[0] + filling[:, 2] * head.spacing[0]
    assert len(filling) > 10
    assert np.all((x > 18) & (x < 30))
    for side in left_and_right((4, -71, -48)):
        assert around(head, side).max() > 2000


def test_right_half_mirrors_the_left_but_for_noise_and_filling(head):
    apart = np.abs(head.values.astype(int) - head.values[:, :, ::-1])
    assert np.mean(apart > 40) < 1e-3
    assert apart.max() > 400


def test_noise_is_about_six_units(head):
    inside = around(head, (20, 20, 60), 4).astype(float)
    assert 4 < inside.std() < 9


def test_coarse_head_is_the_same_head(head, coarse):
    # voxel k of 64 lies at k * 191 / 63 of 192
    nearest = np.rint(np.arange(64) * 191 / 63).astype(int)
    thinned = head.values[np.ix_(nearest, nearest, nearest)].astype(float)
    assert np.corrcoef(thinned.ravel(), coarse.values.ravel())[0, 1] > 0.97
    for point in [(27, -47, -22), (0, -1, -70)]:
        assert coarse.values[voxel(coarse, point)] < -700
    assert around(coarse, (25, 10, 50)).mean() == pytest.approx(33, abs=8)


def test_skin_of_the_face_lies_in_front(head):
    k, _, i = voxel(head, (0, 0, -24))
    nose = head.origin[1] + np.argmax(head.values[k, :, i] > -300) * head.spacing[1]
    k = voxel(head, (0, 0, 40))[0]
    brow = head.origin[1] + np.argmax(head.values[k, :, i] > -300) * head.spacing[1]
    assert nose == pytest.approx(-105, abs=3)
    assert brow == pytest.approx(-82, abs=4)
