"""What a renderer draws behind its props -> colours of a display."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkTexture

# vtkViewport::GradientModes
VERTICAL, HORIZONTAL, FARTHEST_SIDE, FARTHEST_CORNER = range(4)


def background_of(renderer: vtkRenderer, rows: int, columns: int) -> NDArray[np.float64]:
    """Background of a renderer: its colour, gradient or texture.

    The alpha of the background is not used: a picture without background is transparent anyway.

    Parameters
    ----------
    renderer : vtkRenderer
    rows, columns : int
        Of the picture.

    Returns
    -------
    numpy.ndarray
        (3,) or (rows, columns, 3), sRGB from 0 to 1, row 0 on top.
    """
    y, x = np.mgrid[:rows, :columns]
    s, t = (x + 0.5) / columns, 1 - (y + 0.5) / rows
    texture = renderer.GetBackgroundTexture()
    if renderer.GetTexturedBackground() and texture is not None:
        return _looked_up(texture, s, t)
    first = np.array(renderer.GetBackground())
    if not renderer.GetGradientBackground():
        return first
    share = _share(_mode(renderer), s, t)[..., None]
    return first + share * (np.array(renderer.GetBackground2()) - first)


def _mode(renderer: vtkRenderer) -> int:
    # Missing before VTK 9.3
    return int(renderer.GetGradientMode()) if hasattr(renderer, "GetGradientMode") else VERTICAL


def _share(mode: int, s: NDArray[np.float64], t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share of the second colour, 0 to 1."""
    if mode == VERTICAL:
        return t
    if mode == HORIZONTAL:
        return s
    radius = np.hypot(2 * s - 1, 2 * t - 1)
    return np.minimum(radius if mode == FARTHEST_SIDE else radius / np.sqrt(2), 1)


def _looked_up(
    texture: vtkTexture, s: NDArray[np.float64], t: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Colours of a texture that fills the view, bilinear."""
    texture.Update()
    image = texture.GetInput()
    columns, rows, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1)
    scale = 255.0 if pixels.dtype == np.uint8 else 1.0
    pixels = np.clip(pixels / scale, 0.0, 1.0)
    pixels = np.repeat(pixels[..., :1], 3, axis=2) if pixels.shape[2] < 3 else pixels[..., :3]
    u, v = s * columns - 0.5, t * rows - 0.5
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    a, b = (u - i)[..., None], (v - j)[..., None]

    def at(row: NDArray[np.int_], column: NDArray[np.int_]) -> NDArray[np.float64]:
        if texture.GetRepeat():
            return pixels[row % rows, column % columns]
        return pixels[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]

    lower = (1 - a) * at(j, i) + a * at(j, i + 1)
    return (1 - b) * lower + b * ((1 - a) * at(j + 1, i) + a * at(j + 1, i + 1))
