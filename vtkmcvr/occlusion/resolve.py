"""From the raster's fine pixels to those of the film."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..camera import PixelFilter


def resolve(film: packed.OcclusionFilm, fine: int, pixel_filter: PixelFilter) -> dict[str, NDArray]:
    """Arrays of the picture by public name.

    Parameters
    ----------
    film : packed.OcclusionFilm
        Of `fine` times as many rows and columns.
    fine : int
    pixel_filter : PixelFilter
    """
    weights = _weights(fine, pixel_filter)
    # Light is weighed by the opacity that it meets, and stands for the opacity that there is
    whole = np.where(film.share > 0, film.alpha / np.where(film.share > 0, film.share, 1), 0)
    radiance = _filtered(film.radiance * whole[..., None], fine, weights)
    alpha, depth = (_filtered(a, fine, weights) for a in (film.alpha, film.depth))
    # A view ray's opacity is summed layer by layer, and rounded each time: not above one
    alpha = np.minimum(alpha, np.float32(1))
    seen = alpha > 0
    arrays = {
        "radiance": radiance,
        "alpha": alpha,
        "depth": np.where(seen, depth / np.where(seen, alpha, 1), np.inf).astype(np.float32),
    }
    for name, vectors in (("albedo", film.albedo), ("normal", film.normal)):
        if vectors is not None:
            arrays[name] = _filtered(vectors * whole[..., None], fine, weights)
    return arrays


def _weights(fine: int, pixel_filter: PixelFilter) -> NDArray[np.float64]:
    """The filter at the fine pixels around the middle of a pixel; an odd or even number of them."""
    reach = {"gaussian": 3.0, "tent": 1.0, "box": 1.0}[pixel_filter.kind] * pixel_filter.width
    most = max(0, int(np.ceil(reach * fine - fine / 2)))
    x = (np.arange(fine + 2 * most) + 0.5) / fine - 0.5 - most / fine
    # Share of the filter over each fine pixel, by the midpoints of eight parts
    parts = (x[:, None] + (np.arange(8) + 0.5 - 4) / (8 * fine)) / pixel_filter.width
    density = {
        "gaussian": np.where(np.abs(parts) <= 3, np.exp(-parts * parts / 2), 0),
        "box": (np.abs(parts) <= 1).astype(float),
        "tent": np.maximum(1 - np.abs(parts), 0),
    }[pixel_filter.kind]
    weights = density.sum(axis=1)
    if not weights.any():
        weights[len(weights) // 2] = 1.0
    return weights / weights.sum()


def _filtered(a: NDArray, fine: int, weights: NDArray) -> NDArray[np.float32]:
    """Separable filter; beyond the film's edge it is renormalised."""
    for axis in (0, 1):
        n = a.shape[axis] // fine
        most = (len(weights) - fine) // 2
        ones = np.pad(np.ones(a.shape[axis]), most)
        wide = [(0, 0)] * a.ndim
        wide[axis] = (most, most)
        padded = np.pad(a, wide)
        total: NDArray | float = 0.0
        norm = np.zeros(n)
        for i, w in enumerate(weights):
            if w == 0:
                continue
            index = slice(i, i + (n - 1) * fine + 1, fine)
            cut = tuple(index if k == axis else slice(None) for k in range(a.ndim))
            total = total + np.float32(w) * padded[cut]
            norm += w * ones[index]
        shape = [1] * a.ndim
        shape[axis] = n
        a = total / norm.reshape(shape).astype(np.float32)
    return np.ascontiguousarray(a, np.float32)
