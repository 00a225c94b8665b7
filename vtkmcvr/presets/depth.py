"""How much medium there is on the way through the middle of a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..scene import Scene
from ..tables import extinction_of

STEPS = 1024


def depth_through_centre(scene: Scene) -> float:
    """Optical depth of a scene's first volume along the camera's axis, cuts and labels left aside.

    Parameters
    ----------
    scene : Scene
        With an opacity or extinction curve.

    Returns
    -------
    float
        By 1024 equal steps, trilinear; a photon passes unscattered with probability exp(-depth).
    """
    volume, camera = scene.volume, scene.camera
    middle, forward = np.array(camera.focal_point), np.array(camera.frame[2])
    reach = volume.radius + float(np.linalg.norm(volume.centre - middle))
    offsets = (np.arange(STEPS) + 0.5) * (2 * reach / STEPS) - reach
    values = _along(middle + offsets[:, None] * forward, volume.values, volume.index_to_world)
    return float(_extinction(scene, values[np.isfinite(values)]).sum() * 2 * reach / STEPS)


def _extinction(scene: Scene, values: NDArray[np.float64]) -> NDArray[np.float64]:
    transfer = scene.transfer
    if transfer.extinction is not None:
        return transfer.extinction(values) * transfer.density_scale
    if transfer.opacity is None:
        return np.zeros_like(values)
    smallest = float(scene.volume.spacing.min())
    sigma_t = extinction_of(transfer.opacity(values), transfer.unit_distance, smallest)
    return np.asarray(sigma_t, np.float64) * transfer.density_scale


def _along(
    points: NDArray[np.float64], values: NDArray, index_to_world: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Trilinear values at world points (n, 3); NaN outside of the grid."""
    inverse = np.linalg.inv(index_to_world)
    index = points @ inverse[:3, :3].T + inverse[:3, 3]
    last = np.array(values.shape[::-1]) - 1
    inside = ((index >= 0) & (index <= last)).all(axis=1)
    index = index[inside]
    low = np.minimum(index.astype(np.int64), last - 1)
    share = index - low
    found = np.zeros(len(index))
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, share, 1 - share), axis=1)
        i, j, k = (low + corner).T
        found += weight * values[k, j, i].astype(np.float64)
    out = np.full(len(points), np.nan)
    out[inside] = found
    return out
