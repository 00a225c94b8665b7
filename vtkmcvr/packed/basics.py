"""Words that all packed tuples share."""

from __future__ import annotations

import numpy as np

Vector = tuple[np.float32, np.float32, np.float32]
Vector64 = tuple[np.float64, np.float64, np.float64]
Matrix = tuple[Vector, Vector, Vector]
Matrix64 = tuple[Vector64, Vector64, Vector64]

# Consecutive samples of a pixel that share a set of Sobol points
BATCH = 16
