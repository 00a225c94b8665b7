"""Interpolation and world-space gradients."""

import numpy as np
import pytest
from scenes import noise
from scipy.ndimage import map_coordinates

from vtkmcvr.kernels.grid import gradient, trilinear
from vtkmcvr.kernels.jit import entry_point
from vtkmcvr.scene import Volume
from vtkmcvr.voxels import voxels_of

f32 = np.float32


@entry_point
def interpolate(values, points):
    out = np.empty(len(points), np.float32)
    for i in range(len(points)):
        out[i] = trilinear(values, (points[i, 0], points[i, 1], points[i, 2]))
    return out


@entry_point
def gradients(values, to_world, points):
    out = np.empty((len(points), 3), np.float32)
    for i in range(len(points)):
        p = (points[i, 0], points[i, 1], points[i, 2])
        g = gradient(values, to_world, p)
        out[i, 0], out[i, 1], out[i, 2] = g
    return out


def places(shape, n=2000, margin=0.0):
    last = np.array(shape[::-1]) - 1
    p = margin + np.random.default_rng(1).random((n, 3)) * (last - 2 * margin)
    p[:50] = np.round(p[:50])
    if not margin:
        p[50:60], p[60:70] = last, 0
        p[70:80] = last + 3  # clamped
    return p.astype(f32)


def rows(m):
    return tuple(tuple(f32(x) for x in row) for row in m)


def test_interpolation_is_scipys():
    values = noise(9).values
    p = places(values.shape)
    expected = map_coordinates(
        values.astype(float), p.astype(float).T[::-1], order=1, mode="nearest"
    )
    np.testing.assert_allclose(interpolate(values, p), expected, atol=1e-6)


def test_corner_that_is_nan_spoils_its_neighbourhood_only():
    values = np.ones((5, 5, 5), f32)
    values[2, 2, 2] = np.nan
    p = places(values.shape)
    inside = (np.abs(p - 2) < 1).all(axis=1)
    assert np.isnan(interpolate(values, p[inside])).all()
    outside = (np.abs(p - 2) > 1.001).any(axis=1)
    assert (interpolate(values, p[outside]) == 1).all()


MAPS = {
    "spacing": np.diag([0.5, 2.0, 3.0]),
    "rotation": np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1.0]]) * 0.7,
    "left-handed": np.array([[0, 1.0, 0], [1, 0, 0], [0, 0, 1]]) * (0.5, 1, 2),
    "flipped": np.diag([-0.5, 1.0, -2.0]),
    "shear": np.array([[1.0, 0.4, -0.2], [0, 0.8, 0.3], [0.1, 0, 2.5]]),
}


@pytest.mark.parametrize("axes", MAPS.values(), ids=MAPS)
def test_gradient_of_a_linear_field_is_exact_in_the_world(axes):
    # HC-16: scalar = w . x, so the world gradient is w everywhere, also at the borders
    w = np.array((0.3, -1.2, 2.0))
    k, j, i = np.mgrid[:6, :7, :8]
    values = (np.stack([i, j, k], -1) @ axes.T @ w).astype(f32)
    matrix = np.eye(4)
    matrix[:3, :3] = axes
    vol = Volume(values, matrix)
    to_world = np.ascontiguousarray(np.linalg.inv(vol.index_to_world[:3, :3]).T)
    found = gradients(values, rows(to_world), places(values.shape)[80:])
    np.testing.assert_allclose(found, np.broadcast_to(w, found.shape), atol=2e-5)
    # As large as the largest one that the plan divides by
    assert voxels_of(vol).largest_gradient(to_world) == pytest.approx(np.linalg.norm(w), rel=1e-5)


def test_interpolated_gradients_stay_below_the_largest():
    values = noise(9).values
    vol = Volume(values)
    found = gradients(values, rows(np.eye(3)), places(values.shape))
    magnitude = np.linalg.norm(found, axis=1)
    assert magnitude.max() <= voxels_of(vol).largest_gradient(np.eye(3)) * (1 + 1e-5)


def test_linear_ramp_of_bytes_has_one_normal():
    # HC-14: 0..10 over 100 voxels is stored in steps; floats are not
    ramp = np.broadcast_to(np.linspace(0, 10, 101, dtype=f32), (4, 4, 101)).copy()
    x = np.random.default_rng(2).random((500, 3)) * (100, 3, 3)
    found = gradients(ramp, rows(np.eye(3)), x.astype(f32))
    np.testing.assert_allclose(found, np.broadcast_to((0.1, 0, 0), found.shape), atol=2e-6)
    assert len(np.unique(interpolate(ramp, x.astype(f32)))) > 490
