"""The triangle hierarchy against brute force in float64."""

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkSphereSource

from vtkmcvr.kernels.bvh import nearest_triangle, triangle_normal
from vtkmcvr.kernels.bvh_build import LEAF_SIZE
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.planning.receivers import pack_receivers
from vtkmcvr.receivers import MeshReceiver

f32 = np.float32
ORIGIN = np.zeros(3)


@entry_point
def cast(mesh, o, d, far, any_hit, triangle, t):
    for i in range(len(o)):
        triangle[i], t[i] = nearest_triangle(
            mesh, (o[i, 0], o[i, 1], o[i, 2]), (d[i, 0], d[i, 1], d[i, 2]), f32(0), far, any_hit
        )


@entry_point
def normals_at(mesh, triangle, x, face, shading):
    for i in range(len(triangle)):
        face[i], shading[i] = triangle_normal(mesh, triangle[i], (x[i, 0], x[i, 1], x[i, 2]))


def hierarchy(points, triangles, normals=None, centre=ORIGIN):
    return pack_receivers((MeshReceiver(points, triangles, normals),), centre)[1]


def trace(mesh, o, d, far=1e30, any_hit=False):
    triangle, t = np.empty(len(o), np.int32), np.empty(len(o), f32)
    cast(mesh, o.astype(f32), d.astype(f32), f32(far), any_hit, triangle, t)
    return triangle, t


def brute_force(corners, o, d):
    """Nearest distance to any triangle, inf without: planes and barycentric coordinates."""
    a, e1, e2 = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    n = np.cross(e1, e2)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.einsum("tj,rtj->rt", n, a - o[:, None]) / (d @ n.T)
        x = o[:, None] + t[..., None] * d[:, None] - a
        area = np.einsum("tj,tj->t", n, n)
        u = np.einsum("rtj,tj->rt", np.cross(x, e2), n) / area
        v = np.einsum("rtj,tj->rt", np.cross(e1, x), n) / area
    hit = (t > 0) & (u >= 0) & (v >= 0) & (u + v <= 1)
    return np.where(hit, t, np.inf).min(1), np.minimum.reduce([u, v, 1 - u - v]).T


def soup(n, seed, size=0.3):
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(n, 1, 3)) + size * rng.normal(size=(n, 3, 3))
    return corners.astype(f32).astype(float)


def rays(n, seed, distance=5.0):
    rng = np.random.default_rng(seed)
    o = rng.normal(size=(n, 3))
    o *= distance / np.linalg.norm(o, axis=1, keepdims=True)
    d = rng.normal(size=(n, 3)) - o
    d[: n // 10] = np.eye(3)[rng.integers(0, 3, n // 10)] * rng.choice([-1, 1], (n // 10, 1))
    o[: n // 10] = rng.normal(size=(n // 10, 3)) - 4 * d[: n // 10]
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    return o.astype(f32).astype(float), d.astype(f32).astype(float)


@pytest.mark.parametrize("n", [1, LEAF_SIZE, LEAF_SIZE + 1, 40, 700])
def test_nearest_triangle_is_that_of_brute_force(n):
    corners = soup(n, n, 1.5 if n == 1 else 0.3)
    mesh = hierarchy(corners.reshape(-1, 3), np.arange(3 * n).reshape(n, 3))
    o, d = rays(600, 1)
    triangle, t = trace(mesh, o, d)
    expected, _ = brute_force(corners, o, d)
    hit = np.isfinite(expected)
    # At most a ray or two may pass an edge on the other side by rounding
    assert np.count_nonzero((triangle >= 0) != hit) <= 1
    both = (triangle >= 0) & hit
    assert both.sum() > (2 if n == 1 else 10)
    assert np.count_nonzero(np.abs(t - expected)[both] > 1e-4) <= 1
    # Any hit: the same rays are blocked; none beyond its end
    blocked, _ = trace(mesh, o, d, any_hit=True)
    np.testing.assert_array_equal(blocked >= 0, triangle >= 0)
    short = f32(np.median(expected[both]))
    near, _ = trace(mesh, o, d, far=short)
    assert np.count_nonzero((near >= 0) != (expected < short)) <= 2


def test_equal_and_flat_triangles_end():
    corners = np.repeat(soup(1, 3), 1000, axis=0)
    mesh = hierarchy(corners.reshape(-1, 3), np.arange(3000).reshape(-1, 3))
    assert mesh.count.sum() == 1000
    assert mesh.count.max() <= LEAF_SIZE
    # All in one plane: boxes without thickness
    y, x = np.mgrid[0:30, 0:30]
    points = np.stack([x.ravel(), y.ravel(), np.zeros(900)], 1).astype(float)
    first = (30 * y[:-1, :-1] + x[:-1, :-1]).ravel()
    right, above, across = first + 1, first + 30, first + 31
    triangles = np.concatenate(
        [np.stack([first, right, above], 1), np.stack([right, across, above], 1)]
    )
    flat = hierarchy(points, triangles)
    rng = np.random.default_rng(1)
    o = np.c_[rng.uniform(0, 29, (2000, 2)), np.full(2000, 7.0)]
    o[:200] = np.round(o[:200])
    triangle, t = trace(flat, o, np.broadcast_to((0, 0, -1.0), o.shape))
    assert (triangle >= 0).all()
    assert (t == 7).all()


def test_triangles_without_area_are_left_out():
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0.0]])
    mesh = hierarchy(points, np.array([[0, 1, 2], [0, 1, 3], [3, 3, 3]]))
    assert len(mesh.triangles) == 1
    assert hierarchy(points, np.array([[0, 1, 2]])) is None


def ball(resolution, radius=1.0):
    source = vtkSphereSource()
    source.SetRadius(radius)
    source.SetThetaResolution(resolution)
    source.SetPhiResolution(resolution)
    source.Update()
    mesh = source.GetOutput()
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    normals = vtk_to_numpy(mesh.GetPointData().GetNormals()).astype(float)
    return points, vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3), normals


@pytest.mark.parametrize("resolution", [12, 200])
def test_no_ray_leaves_a_closed_mesh(resolution):
    points, triangles, _ = ball(resolution)
    mesh = hierarchy(points, triangles)
    rng = np.random.default_rng(2)
    o = rng.uniform(-0.4, 0.4, (40_000, 3))
    # Toward vertices and edges on purpose
    target = points[rng.integers(0, len(points), len(o))]
    target[::2] = (
        target[::2] + points[triangles[rng.integers(0, len(triangles), len(o)), 0]][::2]
    ) / 2
    ends = triangles[rng.integers(0, len(triangles), len(o) // 4)]
    target[1::4] = (points[ends[:, 0]] + points[ends[:, 1]]) / 2
    d = target - o
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    triangle, t = trace(mesh, o, d)
    assert (triangle >= 0).all()
    reached = np.linalg.norm(o + t[:, None] * d, axis=1)
    assert reached.max() < 1 + 1e-5


def test_normals_of_faces_and_of_points():
    points, triangles, normals = ball(40)

    o, d = rays(2000, 4)
    for given in (None, 5 * normals):
        mesh = hierarchy(points, triangles, given)
        triangle, t = trace(mesh, o, d)
        hit = triangle >= 0
        x = (o + t[:, None] * d)[hit]
        face, shading = np.empty(x.shape, f32), np.empty(x.shape, f32)
        normals_at(mesh, triangle[hit], x.astype(f32), face, shading)
        outward = x / np.linalg.norm(x, axis=1, keepdims=True)
        np.testing.assert_allclose(np.linalg.norm(face, axis=1), 1, atol=1e-5)
        apart = np.degrees(np.arccos(np.minimum(np.abs((shading * outward).sum(1)), 1)))
        if given is None:
            np.testing.assert_array_equal(face, shading)
            assert apart.max() < 9
        else:
            assert ((shading * outward).sum(1) > 0).all()
            assert apart.max() < 0.6


def test_mesh_far_from_the_origin_keeps_its_shape():
    points, triangles, _ = ball(16)
    centre = np.array((1e7, -3e7, 2e7))
    near, far = hierarchy(points, triangles), hierarchy(points + centre, triangles, centre=centre)
    np.testing.assert_allclose(far.triangles, near.triangles, atol=1e-8)
