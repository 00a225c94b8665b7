"""Noise reduction on a CUDA device."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from .device import Device
from .errors import translated

Plane = NDArray[np.float32]


class SmoothingDevice(Device):
    """A device that reduces noise."""

    def knn(self, guide: Plane, values: Plane, share: Plane, tolerance: Plane) -> Plane:
        """Filtered values; see `kernels.knn.knn_pixel`."""
        with translated("the device was opened"):
            from ..kernels.cuda import BLOCK
            from ..kernels.knn_cuda import knn_pixels
        self.room_for(guide, values, share, tolerance, values.copy())
        planes = self.upload((guide, values, share, tolerance, np.zeros_like(values)))
        blocks = -(-values.shape[1] // BLOCK[0]), -(-values.shape[0] // BLOCK[1])
        with translated("noise was reduced"), warnings.catch_warnings():
            # That a small picture does not fill the device
            warnings.filterwarnings("ignore", "Grid size")
            knn_pixels[blocks, BLOCK, self.queue](*planes)
        filtered: Plane = self.download(planes[-1])
        return filtered
