"""vtkMatrix4x4 -> NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from vtkmodules.vtkCommonMath import vtkMatrix4x4


def matrix_of(matrix: vtkMatrix4x4 | ArrayLike) -> NDArray[np.float64]:
    """Return a 4x4 matrix as an array.

    Parameters
    ----------
    matrix : vtkMatrix4x4 or array_like (4, 4)

    Returns
    -------
    numpy.ndarray
        (4, 4) float64, a copy.
    """
    if not isinstance(matrix, vtkMatrix4x4):
        return np.array(matrix, np.float64)
    elements = [[matrix.GetElement(row, column) for column in range(4)] for row in range(4)]
    return np.array(elements, np.float64)
