"""Film -> bytes that are blended over the window."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..film.moments import alpha
from ..pictures.display import to_rgba8
from ..pictures.noiseless import NoiselessPicture

# Samples from which on edges take their colours from the film instead of from the window
SETTLED = 4


class Edges(NamedTuple):
    """Pixels in which a mesh of the window ends, and what lies behind all meshes there."""

    where: NDArray[np.bool_]  # (H, W)
    background: NDArray[np.uint8]  # (H, W, 3)


class Shown(NamedTuple):
    """A picture to draw over what the window shows, bytes (H, W, 4), row 0 on top."""

    pixels: NDArray[np.uint8]  # straight alpha, to be blended
    # To be put in the place of the window's own pixels, background and all, where alpha is not 0
    edges: NDArray[np.uint8] | None = None


def picture_of(
    film: packed.Film,
    exposure: float,
    edges: Edges | None = None,
    veiled: NDArray[np.bool_] | None = None,
) -> Shown:
    """Display picture of a film.

    Colours are blended as displayed, which is how VTK blends. Inside a mesh, window and film see
    one colour behind the volume, and the window's own pixel is taken for it. At the edge of a mesh
    what is hidden and what is seen behind are different parts of the pixel, which the window has
    mixed already: there the film, which has kept what its rays saw, takes the window's place.

    Parameters
    ----------
    film : vtkmcvr.packed.Film
    exposure : float
        Stops.
    edges : Edges, optional
        Pixels at an edge of the backdrop.
    veiled : array (H, W), optional
        Pixels with translucent surfaces, which the window does not draw.
    """
    radiance = film.mean.astype(np.float32)
    coverage = alpha(film)
    pixels = to_rgba8(radiance, coverage, exposure=exposure)
    settled = film.count.min() >= SETTLED
    return with_behind(pixels, coverage, film.behind, edges if settled else None, veiled)


def noiseless_picture_of(picture: NoiselessPicture, edges: Edges | None = None) -> Shown:
    """`picture_of` for a picture without noise."""
    backdrop = picture.plan.scene.backdrop
    veiled = None if backdrop is None else backdrop.veiled
    return with_behind(picture.rgba, picture.alpha, picture.behind, edges, veiled)


def with_behind(
    pixels: NDArray[np.uint8],
    coverage: NDArray[np.float32],
    behind: NDArray[np.float64] | None,
    edges: Edges | None,
    veiled: NDArray[np.bool_] | None,
) -> Shown:
    """Picture with what is seen beside and through the volumes, where the window lacks it.

    Parameters
    ----------
    pixels : array (H, W, 4)
        Bytes, straight alpha; written to.
    coverage : array (H, W)
        Alpha of the volumes.
    behind : array (H, W, 4), optional
        What is seen beside and through them, premultiplied.
    edges, veiled
        As for `picture_of`.
    """
    if behind is None:
        return Shown(pixels)
    veils = np.zeros(coverage.shape, bool) if veiled is None else veiled
    replaced = None
    if edges is not None:
        ends = edges.where & (veils | (coverage > 0))
        light, whole = _mixed(pixels, coverage, behind, ends)
        replaced = np.zeros_like(pixels)
        replaced[ends] = _bytes(light + (1 - whole) * edges.background[ends] / 255, whole)
        pixels[ends] = 0
        veils = veils & ~ends
    light, whole = _mixed(pixels, coverage, behind, veils)
    pixels[veils] = _bytes(light / np.where(whole > 0, whole, 1), whole)
    return Shown(pixels, replaced)


def _mixed(
    pixels: NDArray[np.uint8],
    coverage: NDArray[np.float32],
    behind: NDArray[np.float64],
    where: NDArray[np.bool_],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Display light, premultiplied (n, 3), of volumes and what is behind; alpha of both (n, 1)."""
    cover = coverage[where][:, None]
    light = pixels[where][:, :3] / 255 * cover + behind[where][:, :3]
    return light, cover + behind[where][:, 3:]


def _bytes(colour: NDArray[np.float64], opacity: NDArray[np.float64]) -> NDArray[np.uint8]:
    rgba = np.concatenate([colour, opacity], axis=1)
    return np.rint(255 * np.clip(rgba, 0, 1)).astype(np.uint8)
