"""Environment textures and panoramas -> environment maps."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkRenderer

from ..lights import EnvironmentMap
from ..pictures.display import srgb_decode

# Rows of the map that the faces of a cube are looked up for, over those of a face
ROWS_PER_FACE = 2
# Face k of VTK's cube maps: its axis, and where columns and rows run (OpenGL, "Cube maps")
FACES = (
    ((1, 0, 0), (0, 0, -1), (0, -1, 0)), ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ((0, 1, 0), (1, 0, 0), (0, 0, 1)), ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
    ((0, 0, 1), (1, 0, 0), (0, -1, 0)), ((0, 0, -1), (-1, 0, 0), (0, -1, 0)),
)  # fmt: skip
# Their +x is in the middle and +z at three quarters; +x of an EnvironmentMap is at one quarter
FROM_PANORAMA = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])


def environment_key(renderer: vtkRenderer) -> tuple[Any, ...] | None:
    """What decides the environment map of a renderer, as values to compare; None: it has none."""
    texture: Any = renderer.GetEnvironmentTexture()
    if texture is None or not renderer.GetUseImageBasedLighting():
        return None
    return texture.__this__, texture.GetMTime(), _rotation(renderer).tobytes()


class Environment:
    """The environment map of a renderer, the same object while its texture is unchanged."""

    def __init__(self) -> None:
        self._key: Any = None
        self._map: EnvironmentMap | None = None

    def of(self, renderer: vtkRenderer) -> EnvironmentMap | None:
        """Environment map of a renderer, None where its lighting is not image-based."""
        key = environment_key(renderer)
        if key != self._key:
            self._map = None if key is None else environment_of(renderer)
            self._key = key
        return self._map


def _rotation(renderer: vtkRenderer) -> NDArray[np.float64]:
    """World from the directions of the environment texture."""
    if not hasattr(renderer, "GetEnvironmentRotationMatrix"):
        # Before VTK 9.3
        right: NDArray[np.float64] = np.array(renderer.GetEnvironmentRight())
        up: NDArray[np.float64] = np.array(renderer.GetEnvironmentUp())
        return np.column_stack([right, up, np.cross(right, up)])
    m = renderer.GetEnvironmentRotationMatrix()
    return np.array([[m.GetElement(i, j) for j in range(3)] for i in range(3)])


def environment_of(renderer: vtkRenderer) -> EnvironmentMap:
    """Environment map of a renderer's texture, a panorama or the six faces of a cube."""
    texture = renderer.GetEnvironmentTexture()
    texture.Update()
    if texture.GetCubeMap():
        faces = [_pixels(texture.GetInputDataObject(i, 0)) for i in range(6)]
        return EnvironmentMap(panorama_of(faces), rotation=_rotation(renderer))
    return environment_of_image(texture.GetInput(), _rotation(renderer))


def environment_of_image(
    image: vtkImageData, rotation: NDArray[np.float64] | None = None
) -> EnvironmentMap:
    """Environment map of a panorama as `vtkHDRReader` gives it, placed as VTK places textures.

    Parameters
    ----------
    image : vtkImageData
        Flat; grey, RGB or RGBA. Bytes are sRGB, floats linear; negative values count as 0.
    rotation : array (3, 3), optional
        World from the directions of the panorama, as vtkRenderer::GetEnvironmentRotationMatrix.
    """
    if image.GetPointData().GetScalars() is None or image.GetDimensions()[2] != 1:
        raise ValueError(
            "an environment is a flat image with scalars, of a panorama of all directions; got "
            f"{' x '.join(map(str, image.GetDimensions()))} points"
        )
    turn = np.eye(3) if rotation is None else rotation
    return EnvironmentMap(_pixels(image)[::-1], rotation=turn @ FROM_PANORAMA)


def _pixels(image: vtkImageData) -> NDArray[np.float32]:
    """Linear colours of a texture, row 0 at its lower edge."""
    columns, rows, _ = image.GetDimensions()
    values = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1)
    if values.dtype == np.uint8:
        values = srgb_decode(values.astype(np.float32) / 255)
    values = np.maximum(values.astype(np.float32), 0)
    return np.repeat(values, 3, axis=2) if values.shape[2] < 3 else values[..., :3]


def panorama_of(faces: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Panorama in the form of `EnvironmentMap` of the six faces of a cube, row 0 first in memory.

    Parameters
    ----------
    faces : six arrays (n, n, 3)
        In the order +x, -x, +y, -y, +z, -z, rows and columns as OpenGL has them.
    """
    rows = ROWS_PER_FACE * len(faces[0])
    polar = np.pi * (np.arange(rows) + 0.5) / rows
    phi = 2 * np.pi * (np.arange(2 * rows) + 0.5) / (2 * rows)
    level = np.sin(polar)[:, None]
    d = np.stack(
        [level * np.sin(phi), np.repeat(np.cos(polar)[:, None], 2 * rows, 1), -level * np.cos(phi)],
        axis=-1,
    )
    result = np.zeros((rows, 2 * rows, 3), np.float32)
    nearest = np.argmax([d @ np.array(axis) for axis, _, _ in FACES], axis=0)
    for k, (axis, across, along) in enumerate(FACES):
        mask = nearest == k
        toward = d[mask]
        depth = toward @ np.array(axis)
        n = len(faces[k])
        column = np.clip(((toward @ np.array(across)) / depth + 1) / 2 * n, 0, n - 1).astype(int)
        row = np.clip(((toward @ np.array(along)) / depth + 1) / 2 * n, 0, n - 1).astype(int)
        result[mask] = faces[k][row, column]
    return result
