"""Answers by brute force in float64: rays of their own, SciPy's interpolation, midpoint rules.

Nothing of the renderer is used but what describes a scene.
"""

import math

import numpy as np
from scipy.ndimage import map_coordinates


def rays(camera, size, finer=2):
    """Origins and unit directions, (n, 3) each, on a grid finer than the pixels by `finer`."""
    width, height = size
    forward = np.subtract(camera.focal_point, camera.position)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.view_up)
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    x = (np.arange(width * finer) + 0.5) / (width * finer) * 2 - 1
    y = 1 - (np.arange(height * finer) + 0.5) / (height * finer) * 2
    extent = camera.parallel_scale or math.tan(math.radians(camera.view_angle) / 2)
    aside = (
        extent * width / height * x[None, :, None] * right + extent * y[:, None, None] * up
    ).reshape(-1, 3)
    here = np.array(camera.position, float)
    if camera.parallel_scale:
        return here + aside, np.broadcast_to(forward, aside.shape)
    d = forward + aside
    return np.broadcast_to(here, d.shape), d / np.linalg.norm(d, axis=1, keepdims=True)


def to_index(volume, points):
    """World points (..., 3) in index coordinates."""
    inverse = np.linalg.inv(volume.index_to_world)
    return points @ inverse[:3, :3].T + inverse[:3, 3]


def scalars(volume, points):
    """Interpolated scalars at world points, and whether these are inside."""
    p = to_index(volume, points)
    last = np.array(volume.shape) - 1
    inside = ((p >= -1e-9) & (p <= last + 1e-9)).all(axis=-1)
    where = np.moveaxis(p[..., ::-1], -1, 0)
    return map_coordinates(volume.values.astype(float), where, order=1, mode="nearest"), inside


def extinction(volume, curve, points):
    """sigma_t at world points; 0 outside."""
    found, inside = scalars(volume, points)
    return np.where(inside, curve(found), 0.0)


def span(volume, o, d):
    """Where rays enter and leave the volume, (n,), from their origins on."""
    inverse = np.linalg.inv(volume.index_to_world)[:3, :3]
    p, v = to_index(volume, o), d @ inverse.T
    last = np.array(volume.shape) - 1
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (0 - p) / v, (last - p) / v
    still = v == 0
    out = still & ((p < 0) | (p > last))
    near = np.where(still, np.where(out, np.inf, -np.inf), np.minimum(a, b)).max(axis=-1)
    far = np.where(still, np.where(out, -np.inf, np.inf), np.maximum(a, b)).min(axis=-1)
    return np.maximum(near, 0.0), far


def optical_depth(volume, curve, o, d, limit=np.inf, steps=2000):
    """Optical depth along rays, (n,), by the midpoint rule between entry and exit."""
    near, far = span(volume, o, d)
    far = np.minimum(far, limit)
    length = np.maximum(far - near, 0.0)
    depth = np.zeros(len(length))
    for first in range(0, steps, 100):
        t = near[:, None] + length[:, None] * (np.arange(first, first + 100) + 0.5) / steps
        points = (
            o[:, None, :]
            + d[:, None, :]
            * np.where(length > 0, 1.0, 0.0)[:, None, None]
            * (np.where(length[:, None] > 0, t, 0.0)[..., None])
        )
        depth += extinction(volume, curve, points).sum(axis=1)
    return depth * length / steps


def alpha(scene, finer=2, steps=2000):
    """Mean alpha of a film."""
    o, d = rays(scene.camera, scene.size, finer)
    return float(
        np.mean(-np.expm1(-optical_depth(scene.volume, curve_of(scene), o, d, steps=steps)))
    )


def curve_of(scene):
    """Extinction by the scalar."""
    transfer = scene.transfer
    if transfer.extinction is not None:
        return lambda x: transfer.extinction(x) * transfer.density_scale
    return lambda x: (
        -np.log1p(-np.minimum(transfer.opacity(x), 1 - 2.0**-24))
        * transfer.density_scale
        / transfer.unit_distance
    )
