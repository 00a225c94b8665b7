"""What a film on a device is asked for without copying it: its display picture, and its error."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import packed
from ..kernels.film_totals import FIELDS, LEAST
from .errors import translated


def shown(device: Any, film: Any, screen: packed.Screen) -> NDArray[np.uint8]:
    """Display picture of a film on a device.

    Parameters
    ----------
    device : Device
    film : packed.Film
        With its arrays on the device.
    screen : packed.Screen
        Of the host.

    Returns
    -------
    array (H, W, 4)
        Bytes with straight alpha, of `vtkmcvr.pictures.display.to_rgba8` to one level.
    """
    with translated("the device was opened"):
        from ..kernels.cuda import BLOCK
        from ..kernels.film_cuda import show_pixels
    rows, columns = film.count.shape
    there, pixels = device.upload((screen, np.zeros((rows, columns, 4), np.uint8)))
    blocks = -(-columns // BLOCK[0]), -(-rows // BLOCK[1])
    with translated("the picture was made for display"), warnings.catch_warnings():
        # That a small picture does not fill the device
        warnings.filterwarnings("ignore", "Grid size")
        show_pixels[blocks, BLOCK, device.queue](film, there, pixels)
    picture: NDArray[np.uint8] = device.download(pixels)
    return picture


def totals(device: Any, film: Any) -> packed.FilmTotals:
    """Sums over a device's pixels of a film there.

    Parameters
    ----------
    device : CudaDevice
    film : packed.Film
        With its arrays on the device.
    """
    with translated("the device was opened"):
        from ..kernels.film_cuda import BLOCKS, THREADS, total_pixels
    sums = device.upload(np.zeros((BLOCKS, FIELDS)))
    with translated("the error was summed"), warnings.catch_warnings():
        # So few blocks do not fill the device
        warnings.filterwarnings("ignore", "Grid size")
        total_pixels[BLOCKS, THREADS, device.queue](
            film, sums, np.int64(device.every), np.int64(device.which)
        )
    return joined(device.download(sums))


def joined(parts: Sequence[Sequence[float]] | NDArray[np.float64]) -> packed.FilmTotals:
    """Totals of all parts of a film."""
    table = np.asarray(parts, np.float64)
    sums = table.sum(axis=0)
    sums[LEAST] = table[:, LEAST].min()
    return packed.FilmTotals(*sums.tolist())
