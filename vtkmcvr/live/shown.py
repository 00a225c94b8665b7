"""Film -> bytes that are blended over the window."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..film.moments import alpha
from ..pictures.display import to_rgba8
from ..pictures.noiseless import NoiselessPicture

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
    settled = film.count.min() >= SETTLED
    return with_behind(pixels, coverage, film.behind, edges if settled else None, veiled)


def noiseless_picture_of(
    picture: NoiselessPicture, edges: NDArray[np.bool_] | None = None
) -> NDArray[np.uint8]:
    """`picture_of` for a picture without noise."""
    backdrop = picture.plan.scene.backdrop
    veiled = None if backdrop is None else backdrop.veiled
    return with_behind(picture.rgba, picture.alpha, picture.behind, edges, veiled)


def with_behind(
    pixels: NDArray[np.uint8],
    coverage: NDArray[np.float32],
    behind: NDArray[np.float64] | None,
    edges: NDArray[np.bool_] | None,
    veiled: NDArray[np.bool_] | None,
) -> NDArray[np.uint8]:
    """Picture in which edges and veiled pixels cover the window's own.

    Parameters
    ----------
    pixels : array (H, W, 4)
        Bytes, straight alpha; written to.
    coverage : array (H, W)
        Alpha of the volumes.
    behind : array (H, W, 4), optional
        What is seen beside and through them, premultiplied.
    edges, veiled : array (H, W), optional
        As for `picture_of`.
    """
    if behind is None:
        return pixels
    seen = np.zeros(coverage.shape, bool) if veiled is None else veiled.copy()
    if edges is not None:
        seen |= edges & (coverage > 0)
    cover, behind = coverage[seen][:, None], behind[seen]
    whole = cover[:, 0] + behind[:, 3]
    light = pixels[seen][:, :3] / 255 * cover + behind[:, :3]
    light /= np.where(whole > 0, whole, 1)[:, None]
    pixels[seen, :3] = np.rint(255 * np.clip(light, 0, 1))
    pixels[seen, 3] = np.rint(255 * np.clip(whole, 0, 1))
    return pixels
