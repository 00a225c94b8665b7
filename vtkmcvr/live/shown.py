"""Film -> bytes that are blended over the window."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..display import to_rgba8
from ..film import alpha

# Samples from which on edges take their colours from the film instead of from the window
SETTLED = 4


def picture_of(
    film: packed.Film,
    exposure: float,
    edges: NDArray[np.bool_] | None = None,
    veiled: NDArray[np.bool_] | None = None,
) -> NDArray[np.uint8]:
    """Display picture of a film, straight alpha.

    Colours are blended as displayed, which is how VTK blends. Inside a mesh, window and film see
    one colour behind the volume, and the window's own pixel is taken for it. At the edge of a mesh
    what is hidden and what is seen behind are different parts of the pixel: there the film has kept
    what its rays saw, and covers the window's pixel.

    Parameters
    ----------
    film : vtkmcvr.packed.Film
    exposure : float
        Stops.
    edges : array (H, W), optional
        Pixels at an edge of the backdrop.
    veiled : array (H, W), optional
        Pixels with translucent surfaces, which the window does not draw.

    Returns
    -------
    numpy.ndarray
        uint8 (H, W, 4).
    """
    radiance = film.mean.astype(np.float32)
    coverage = alpha(film)
    pixels = to_rgba8(radiance, coverage, exposure=exposure)
    if film.behind is None:
        return pixels
    seen = np.zeros(coverage.shape, bool) if veiled is None else veiled.copy()
    if edges is not None and film.count.min() >= SETTLED:
        seen |= edges & (coverage > 0)
    behind = film.behind[seen]
    cover = coverage[seen][:, None]
    whole = cover[:, 0] + behind[:, 3]
    light = pixels[seen][:, :3] / 255 * cover + behind[:, :3]
    light /= np.where(whole > 0, whole, 1)[:, None]
    pixels[seen, :3] = np.rint(255 * np.clip(light, 0, 1))
    pixels[seen, 3] = np.rint(255 * np.clip(whole, 0, 1))
    return pixels
