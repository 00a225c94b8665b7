"""Cuts against membership tests in float64 world coordinates, on a sheared, turned grid."""

import numpy as np
import pytest
from scenes import WHITE, medium, noise, scene
from scipy.spatial.transform import Rotation

from vtkmcvr.curves import Curve
from vtkmcvr.cutting import ALL_REGIONS, CROSS, FENCE, SUBVOLUME, Box, Cropping, Plane, Sphere
from vtkmcvr.kernels.cut import clip_interval, in_regions, outside_holes
from vtkmcvr.kernels.cut_faces import cut_face
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.kernels.tracking import classify
from vtkmcvr.labels import Labels
from vtkmcvr.plan import plan
from vtkmcvr.planning.cutting import face_depth, pack_cuts
from vtkmcvr.scene import TransferFunction, Volume
from vtkmcvr.voxels import SMALLEST_CELL as CELL

f32 = np.float32
TURN = Rotation.from_euler("xyz", (20, -35, 50), degrees=True).as_matrix()


def grid(n=13):
    """Noise on a grid that is turned, sheared and stretched, far from the origin."""
    matrix = np.eye(4)
    matrix[:3, :3] = TURN @ np.array([[0.5, 0.1, 0], [0, 0.7, 0.05], [0, 0, 1.1]])
    matrix[:3, 3] = (1e5, -2e5, 3e4)
    return Volume(np.random.default_rng(3).random((n, n + 2, n + 4), np.float32) + 0.1, matrix)


VOLUME = grid()
CENTRE = VOLUME.centre


def near(*offset):
    return tuple((CENTRE + np.array(offset)).tolist())


KEPT = (
    Plane(near(0.5, 0.3, -1), (0.3, -0.5, 1)),
    Plane(near(2, 1, 3), (-1, 0.1, -0.2)),
    Sphere(near(0.4, 0, 1), 4.5),
    Box(near(0, 0, 0.5), (7, 8, 9), TURN.T),
)
HOLES = (
    Sphere(near(1, 0, 0), 3.5, keep="outside"),
    Box(near(-1, 1, -1), (4, 5, 6), TURN, keep="outside"),
)


def kept(shape, x):
    """Whether world points are kept by a shape."""
    if isinstance(shape, Plane):
        return (x - shape.origin) @ shape.normal >= 0
    if isinstance(shape, Sphere):
        inside = np.linalg.norm(x - shape.centre, axis=-1) <= shape.radius
    else:
        local = (x - shape.centre) @ shape.axes
        inside = (np.abs(local) <= np.array(shape.size) / 2).all(-1)
    return inside if shape.keep == "inside" else ~inside


def kept_regions(crop, p):
    third = np.sum([p > crop.lower, p > crop.upper], axis=0)
    bit = third @ (1, 3, 9)
    return (crop.flags >> bit) & 1 == 1


def world(p, volume=VOLUME):
    return p @ volume.index_to_world[:3, :3].T + volume.index_to_world[:3, 3]


def index_points(n, margin=0.0, seed=4):
    shape = np.array(VOLUME.shape) - 1
    return np.random.default_rng(seed).uniform(-margin, shape + margin, (n, 3))


@entry_point
def intervals(clip, o, d, out):
    for i in range(len(o)):
        out[i, 0], out[i, 1] = clip_interval(
            clip, (o[i, 0], o[i, 1], o[i, 2]), (d[i, 0], d[i, 1], d[i, 2]), -1e3, 1e3
        )


@entry_point
def uncut(holes, regions, p, out):
    for i in range(len(p)):
        q = (p[i, 0], p[i, 1], p[i, 2])
        out[i] = in_regions(regions, q, outside_holes(holes, q, f32(1.0)))


@entry_point
def faces(clip, holes, regions, p, wo, on_face, normals):
    for i in range(len(p)):
        on_face[i], n = cut_face(
            clip, holes, regions, (p[i, 0], p[i, 1], p[i, 2]), (wo[i, 0], wo[i, 1], wo[i, 2])
        )
        normals[i] = n


@pytest.mark.parametrize("shapes", [*((s,) for s in KEPT), KEPT], ids=lambda s: str(len(s)))
def test_rays_are_kept_where_all_shapes_keep_them(shapes):
    cuts = pack_cuts(VOLUME, shapes, None)
    rng = np.random.default_rng(5)
    o = index_points(300, 4.0)
    heading = rng.normal(size=(300, 3))
    heading /= np.linalg.norm(heading, axis=1, keepdims=True)
    heading[:20] = np.eye(3)[rng.integers(0, 3, 20)]
    d = heading @ np.linalg.inv(VOLUME.index_to_world[:3, :3]).T
    found = np.empty((300, 2))
    intervals(cuts.clip, o, d, found)
    t = np.linspace(-20, 20, 4001)
    x = world(o)[:, None] + heading[:, None] * t[:, None]
    expected = np.all([kept(shape, x) for shape in shapes], axis=0)
    enter, leave = found[:, :1], found[:, 1:]
    near_end = np.minimum(np.abs(t - enter), np.abs(t - leave)) < 1e-3
    assert ((((t > enter) & (t < leave)) == expected) | near_end).all()
    assert 0.01 < expected.mean() < 0.99


@pytest.mark.parametrize(
    ("shapes", "crop"),
    [
        (HOLES[:1], None),
        (HOLES[1:], None),
        (HOLES, None),
        ((), Cropping((2.3, 3, 4), (8, 9.5, 10.2), FENCE)),
        ((), Cropping((2.3, 3, 4), (8, 9.5, 10.2), ALL_REGIONS ^ CROSS)),
        ((), Cropping((5, -3, 4), (50, 9.5, 10.2), 0x1234567)),
    ],
)
def test_points_are_transparent_where_they_are_cut_out(shapes, crop):
    cuts = pack_cuts(VOLUME, shapes, crop)
    assert cuts.clip is None
    p = index_points(5000)
    found = np.empty(len(p), f32)
    uncut(cuts.holes, cuts.regions, p.astype(f32), found)
    expected = np.all([kept(shape, world(p)) for shape in shapes], axis=0)
    if crop is not None:
        expected = kept_regions(crop, p)
    # Points within float32 rounding of a border may fall on either side
    assert np.count_nonzero((found == 1) != expected) <= 2
    assert 0.03 < expected.mean() < 0.97


@pytest.mark.parametrize("flags", [SUBVOLUME, SUBVOLUME | 1])
def test_middle_region_alone_shortens_rays_instead_of_being_asked(flags):
    crop = Cropping((2.3, 3, 4), (8, 9.5, 10.2), flags)
    cuts = pack_cuts(VOLUME, (), crop)
    assert (cuts.regions is None) == (flags == SUBVOLUME)
    if flags == SUBVOLUME:
        assert len(cuts.clip.planes) == 6
        p = index_points(2000)
        heights = np.c_[p, np.ones(len(p))] @ cuts.clip.planes.T
        clear = np.abs(heights).min(1) > 1e-4
        assert ((heights > 0).all(1) == kept_regions(crop, p))[clear].all()


@pytest.mark.parametrize("crop", [None, Cropping((3, 3, 3), (8, 9, 12), CROSS)])
@pytest.mark.parametrize("shapes", [(), KEPT[:1], KEPT[2:3], KEPT[3:], HOLES, (*KEPT, *HOLES)])
def test_only_cells_without_a_kept_point_are_emptied(shapes, crop):
    if not shapes and crop is None:
        return
    cuts = pack_cuts(VOLUME, shapes, crop)
    last = np.array(VOLUME.shape) - 1
    majorant = np.ones(tuple(-(-n // 3) for n in last[::-1]), f32)
    cuts.empty_cells(majorant, 3, last)
    p = index_points(200_000)
    alive = np.all([np.full(len(p), True), *(kept(s, world(p)) for s in shapes)], axis=0)
    if crop is not None:
        alive &= kept_regions(crop, p)
    cell = np.minimum((p // 3).astype(int), np.array(majorant.shape[::-1]) - 1)
    has_points = np.zeros(majorant.shape, bool)
    np.logical_or.at(has_points, tuple(cell[:, ::-1].T), alive)
    assert (majorant[has_points] == 1).all()
    # Cells that are cut off are found but for some at the borders
    cut = np.count_nonzero(~has_points)
    assert np.count_nonzero(majorant == 0) >= 0.5 * cut
    assert cut > 0


def test_faces_are_those_of_the_cut_just_before_the_point():
    depth = float(face_depth(VOLUME))
    assert depth == pytest.approx(0.5 * VOLUME.spacing.min())
    rng = np.random.default_rng(8)
    sphere, box, plane, hole = KEPT[2], KEPT[3], KEPT[0], HOLES[0]
    away = rng.normal(size=(200, 3))
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    middle = np.array(box.centre) + box.axes[:, 0] * box.size[0] / 2
    cases = [
        (sphere, sphere.centre + (sphere.radius - 0.4 * depth) * away, away, 0.0),
        (hole, hole.centre + (hole.radius + 0.4 * depth) * away, -away, 0.0),
        (plane, np.array(plane.origin) + 0.4 * depth * np.array(plane.normal),
         -np.array(plane.normal), 0.0),
        (box, middle - 0.4 * depth * box.axes[:, 0], box.axes[:, 0], 0.0),
        (sphere, sphere.centre + (sphere.radius - 1.2 * depth) * away, None, 0.0),
    ]  # fmt: skip
    inverse = np.linalg.inv(VOLUME.index_to_world[:3, :3])
    for shape, x, outward, _ in cases:
        x = np.atleast_2d(x)
        cuts = pack_cuts(VOLUME, (shape,), None)
        p = (x - VOLUME.index_to_world[:3, 3]) @ inverse.T
        wo = rng.normal(size=x.shape)
        wo /= np.linalg.norm(wo, axis=1, keepdims=True)
        on_face, normal = np.empty(len(x), bool), np.empty(x.shape, f32)
        faces(cuts.clip, cuts.holes, cuts.regions, p.astype(f32), wo.astype(f32), on_face, normal)
        if outward is None:
            assert not on_face.any()
            continue
        outward = np.broadcast_to(outward, x.shape)
        toward = np.einsum("ij,ij->i", outward, wo)
        assert (on_face == (toward > 0))[np.abs(toward) > 1e-3].all()
        np.testing.assert_allclose(normal[on_face], outward[on_face], atol=2e-3)


def test_face_between_cropping_regions():
    crop = Cropping((4, -9, -9), (8, 99, 99), 0b101 << 12)
    cuts = pack_cuts(VOLUME, (), crop)
    up = np.linalg.inv(VOLUME.index_to_world[:3, :3])[0]
    pitch = 1 / np.linalg.norm(up)
    step = 0.4 * float(face_depth(VOLUME)) / pitch
    p = np.array([[4 - step, 5, 5], [8 + step, 5, 5], [3, 5, 5]], f32)
    wo = np.array([up * pitch, -up * pitch, up * pitch], f32)
    on_face, normal = np.empty(3, bool), np.empty((3, 3), f32)
    faces(cuts.clip, cuts.holes, cuts.regions, p, wo, on_face, normal)
    assert on_face.tolist() == [True, True, False]
    np.testing.assert_allclose(normal[:2], wo[:2], atol=1e-5)


@entry_point
def extinctions(medium, transfer, p, out):
    for i in range(len(p)):
        _, out[i] = classify(
            transfer.gradient_opacity, transfer.table_2d, medium, transfer,
            (p[i, 0], p[i, 1], p[i, 2]),
        )  # fmt: skip


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_labels_have_their_own_extinction_below_the_majorant(dtype):
    rng = np.random.default_rng(2)
    values = rng.random((15, 14, 13)) * (200 if dtype == np.uint8 else 1)
    values = np.kron(values[::2, ::2, ::2], np.ones((2, 2, 2))).astype(dtype)
    peak = float(values.max())
    labels = np.kron(rng.integers(-2, 4, (4, 4, 4)), np.ones((4, 4, 4), int))
    labels = labels[: values.shape[0], : values.shape[1], : values.shape[2]]
    curves = {
        1: Curve([(0, 0), (peak, 3)]),
        -2: Curve([(0.4 * peak, 0), (0.5 * peak, 5), (0.6 * peak, 0)]),
    }
    line = Curve([(0, 0), (peak, 2)])
    transfers = {k: TransferFunction(None, WHITE, extinction=c) for k, c in curves.items()}
    mask = rng.random(values.shape) > 0.1
    planned = plan(
        scene(
            Volume(values), TransferFunction(None, WHITE, extinction=line), mask=mask,
            labels=Labels(labels, {**transfers, 3: None, 77: transfers[1]}),
        )
    )  # fmt: skip
    medium_, transfer = planned.packed.medium, planned.packed.transfer
    p = rng.uniform(0, np.array(values.shape[::-1]) - 1, (20_000, 3)).astype(f32)
    found = np.empty(len(p), f32)
    extinctions(medium_, transfer, p, found)
    nearest = tuple(np.floor(p + 0.5).astype(int)[:, ::-1].T)
    label, seen = labels[nearest], mask[nearest]
    from scipy.ndimage import map_coordinates

    scalar = map_coordinates(values.astype(float), p[:, ::-1].T.astype(float), order=1)
    expected = 2.0 / peak * scalar
    for value, curve in curves.items():
        expected = np.where(label == value, curve(scalar), expected)
    expected = np.where((label == 3) | ~seen, 0, expected)
    # The peaked curve bends between table entries
    np.testing.assert_allclose(found, expected, atol=5e-3)
    cell = round(float(medium_.cell_size))
    places = np.minimum((p // cell).astype(int), np.array(medium_.majorant.shape[::-1]) - 1)
    assert (found <= np.maximum(medium_.majorant[tuple(places[:, ::-1].T)], 0)).all()
    assert {effect.name for effect in planned.effects if effect.on} >= {"labels", "mask"}


def test_cuts_of_no_consequence_are_absent():
    vol = noise()
    planned = plan(
        scene(vol, mask=np.ones(vol.values.shape, bool), crop=Cropping((-1, -1, -1), (99, 99, 99)),
              labels=Labels(np.zeros(vol.values.shape, int), {5: medium(1.0)}))
    )  # fmt: skip
    medium_ = planned.packed.medium
    assert medium_.labels is medium_.clip is medium_.holes is medium_.regions is None


def test_active_box_shrinks_to_what_is_left():
    vol = noise(31)
    whole = plan(scene(vol)).packed.medium
    half = plan(scene(vol, clip=Plane((0, 0, 0.5), (0, 0, 1)))).packed.medium
    # The plane lies at index 22.5; the box is one of whole cells
    assert half.active_lo[2] == 22.5 // CELL * CELL
    assert half.active_hi == whole.active_hi
    assert plan(scene(vol, clip=Plane((0, 0, 9), (0, 0, 1)))).empty
